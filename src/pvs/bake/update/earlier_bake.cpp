// The file: magic, version, the scene, its marks, the answers of each part, and a checksum of all before it.
// Little-endian.

#include "src/pvs/bake/update/earlier_bake.h"

#include <algorithm>
#include <array>
#include <string>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "src/base/byte_stream.h"
#include "src/base/hash_slots.h"
#include "src/pvs/bake/update/number_hash.h"
#include "src/pvs/format/checksum.h"

namespace sightline::pvs {
namespace {

constexpr std::uint64_t kAnswerMagic = 0x72736e417374694cu;
constexpr std::size_t kChecksumBytes = 8;
// Bytes that a box, an object, a node, a panel and a part take in the file.
constexpr std::size_t kBoxBytes = 24, kObjectBytes = 8 + kBoxBytes + 4 + 1, kNodeBytes = kBoxBytes + 16,
                      kPanelBytes = 8 + kBoxBytes, kPartBytes = 16;

std::uint64_t contentOf(const ConvexOccluders& all, const ConvexOccluder& occluder) {
  NumberHash hash;
  hash.add(std::uint64_t{occluder.body} << 1 | std::uint64_t{occluder.double_sided});
  hash.add(occluder.bounds);
  for (const double number : {occluder.margin, occluder.area, occluder.volume, occluder.size}) {
    hash.add(number);
  }
  for (const DrawnEdge& edge : all.edgesOf(occluder)) {
    hash.add(edge.from);
    hash.add(edge.along);
    hash.add(std::uint64_t{edge.left} << 8 | std::uint64_t{edge.right});
  }
  for (const DrawnFace& face : all.facesOf(occluder)) {
    hash.add(face.plane.normal);
    hash.add(face.base);
    for (const double number : {face.plane.offset, face.min_height, face.max_height}) {
      hash.add(number);
    }
  }
  return hash.value();
}

std::uint64_t hashOf(const BakeSettings& settings) {
  NumberHash hash;
  for (const std::uint64_t number : {static_cast<std::uint64_t>(settings.occlusion),
                                     std::uint64_t{settings.divisions}, std::uint64_t{settings.narrowings}}) {
    hash.add(number);
  }
  hash.add(settings.near_distance);
  hash.add(settings.occluder_size);
  return hash.value();
}

std::uint64_t spaceOf(const BakeScene& scene) {
  Vec3d farthest;  // of the panels
  for (const Vec3d& vertex : scene.panels.vertices) {
    farthest = max(farthest, abs(vertex));
  }
  NumberHash hash;
  for (const double number : {scene.reach, scene.magnitude, scene.panels.slack, maxComponent(farthest)}) {
    hash.add(number);
  }
  hash.add(scene.root.min);
  hash.add(scene.root.max);
  return hash.value();
}

// By ObjectId.
std::vector<ObjectMark> objectMarks(const BakeScene& scene) {
  std::vector<ObjectMark> marks(scene.boxes.objects.size());
  std::vector<std::uint64_t> occluders(marks.size(), 0);
  for (std::uint32_t i = 0; i < scene.occluders.size(); ++i) {
    const std::uint32_t object = scene.occluders[i].object.value;
    if (scene.doors.isDoor(ObjectId(object))) {
      continue;  // no answer depends on it
    }
    // A sum, because their order depends on the other objects.
    occluders[object] += base::mixBits(contentOf(scene.occluders, scene.occluders[i]));
    marks[object].occludes = true;
  }
  std::unordered_map<std::uint64_t, std::uint64_t> equal;  // by content: objects so far
  for (std::uint32_t object = 0; object < marks.size(); ++object) {
    const BoxNode& leaf = scene.leafOf(scene.position_of[object]);
    marks[object].bounds = leaf.bounds;
    marks[object].triangles = leaf.triangles;
    NumberHash hash;
    hash.add(leaf.bounds);
    hash.add(std::uint64_t{leaf.triangles});
    hash.add(occluders[object]);
    if (scene.settings.occlusion == BakeOcclusion::kFused) {
      for (const Box& box : scene.object_boxes.of(ObjectId(object))) {
        hash.add(box);
      }
    }
    hash.add(equal[hash.value()]++);
    marks[object].content = hash.value();
  }
  return marks;
}

// objects: by ObjectId.
std::vector<PanelMark> panelMarks(const BakeScene& scene, std::span<const ObjectMark> objects) {
  const Panels& panels = scene.panels;
  // What a panel is by itself; then, what it is joined with.
  std::vector<std::uint64_t> own;
  own.reserve(panels.panels.size());
  for (std::size_t i = 0; i < panels.panels.size(); ++i) {
    NumberHash hash;
    hash.add(objects[panels.panels[i].object].content);
    const PanelRank& rank = panels.ranks[i];
    hash.add(rank.content);
    // The order in which panels are followed decides which objects are left out of a question.
    hash.add(isThorough(scene.settings) ? std::uint64_t{rank.steps} : 0);
    own.push_back(hash.value());
  }
  std::vector<PanelMark> marks;
  marks.reserve(own.size());
  for (std::size_t i = 0; i < own.size(); ++i) {
    NumberHash hash;
    hash.add(own[i]);
    for (const PanelEdge& edge : panels.edgesOf(panels.panels[i])) {
      hash.add(panels.vertices[edge.from]);
      hash.add(panels.vertices[edge.to]);
      hash.add(edge.beyond == kNoPanel ? 0 : own[edge.beyond]);
      // From itself on, because where the others begin depends on the numbers of panels.
      const EdgeRing ring = edge.ring == kNoRing ? EdgeRing{} : panels.rings[edge.ring];
      for (std::uint32_t k = 0; k < ring.count; ++k) {
        const SheetAround& sheet = panels.around[ring.first + (ring.self + k) % ring.count];
        hash.add(own[sheet.panel]);
        hash.add(sheet.beyond == kNoPanel ? 0 : own[sheet.beyond]);
        hash.add(std::uint64_t{sheet.rises});
      }
    }
    marks.push_back({hash.value(), panels.bounds[i]});
  }
  std::sort(marks.begin(), marks.end(), before);
  return marks;
}

void write(const Box& box, base::ByteWriter& bytes) {
  for (const float number : {box.min.x, box.min.y, box.min.z, box.max.x, box.max.y, box.max.z}) {
    bytes.add(number);
  }
}

Box readBox(base::ByteReader& bytes) {
  Box box;
  for (float* number : {&box.min.x, &box.min.y, &box.min.z, &box.max.x, &box.max.y, &box.max.z}) {
    *number = bytes.read<float>();
  }
  return box;
}

void write(const SceneMarks& marks, base::ByteWriter& bytes) {
  bytes.add(marks.settings);
  bytes.add(marks.space);
  write(marks.frame, bytes);
  bytes.add(static_cast<std::uint32_t>(marks.objects.size()));
  for (const ObjectMark& object : marks.objects) {
    bytes.add(object.content);
    write(object.bounds, bytes);
    bytes.add(object.triangles);
    bytes.add(static_cast<std::uint8_t>(object.occludes ? 1 : 0));
  }
  bytes.add(static_cast<std::uint32_t>(marks.nodes.size()));
  for (const BoxNode& node : marks.nodes) {
    write(node.bounds, bytes);
    for (const std::uint32_t number : {node.end, node.first_object, node.object_count, node.triangles}) {
      bytes.add(number);
    }
  }
  bytes.add(static_cast<std::uint32_t>(marks.panels.size()));
  for (const PanelMark& panel : marks.panels) {
    bytes.add(panel.content);
    write(panel.bounds, bytes);
  }
}

SceneMarks readMarks(base::ByteReader& bytes) {
  SceneMarks marks;
  marks.settings = bytes.read<std::uint64_t>();
  marks.space = bytes.read<std::uint64_t>();
  marks.frame = readBox(bytes);
  marks.objects.resize(bytes.readCount<std::uint32_t>(kObjectBytes));
  for (ObjectMark& object : marks.objects) {
    object.content = bytes.read<std::uint64_t>();
    object.bounds = readBox(bytes);
    object.triangles = bytes.read<std::uint32_t>();
    object.occludes = bytes.read<std::uint8_t>() != 0;
  }
  marks.nodes.resize(bytes.readCount<std::uint32_t>(kNodeBytes));
  for (BoxNode& node : marks.nodes) {
    node.bounds = readBox(bytes);
    for (std::uint32_t* number : {&node.end, &node.first_object, &node.object_count, &node.triangles}) {
      *number = bytes.read<std::uint32_t>();
    }
  }
  marks.panels.resize(bytes.readCount<std::uint32_t>(kPanelBytes));
  for (PanelMark& panel : marks.panels) {
    panel.content = bytes.read<std::uint64_t>();
    panel.bounds = readBox(bytes);
  }
  return marks;
}

// Whether the nodes name nodes and objects that there are, and the panels are in order.
bool sound(const SceneMarks& marks) {
  for (std::size_t i = 0; i < marks.nodes.size(); ++i) {
    const BoxNode& node = marks.nodes[i];
    const std::uint64_t end = std::uint64_t{node.first_object} + node.object_count;
    if (node.end <= i || node.end > marks.nodes.size() || node.object_count == 0 ||
        end > marks.objects.size()) {
      return false;
    }
  }
  return std::is_sorted(marks.panels.begin(), marks.panels.end(), before);
}

}  // namespace

bool beginsAsAnswers(std::span<const std::byte> bytes) {
  base::ByteReader reader(bytes);
  return reader.read<std::uint64_t>() == kAnswerMagic && reader.ok();
}

bool before(const PanelMark& a, const PanelMark& b) {
  const auto key = [](const PanelMark& mark) {
    const Box& box = mark.bounds;
    return std::tuple(mark.content, box.min.x, box.min.y, box.min.z, box.max.x, box.max.y, box.max.z);
  };
  return key(a) < key(b);
}

SceneMarks marksOf(const BakeScene& scene) {
  SceneMarks marks;
  marks.settings = hashOf(scene.settings);
  marks.space = spaceOf(scene);
  marks.frame = scene.frame;
  const std::vector<ObjectMark> by_id = objectMarks(scene);
  for (const ObjectId object : scene.boxes.objects) {
    marks.objects.push_back(by_id[object.value]);
  }
  marks.nodes = scene.boxes.nodes;
  marks.panels = panelMarks(scene, by_id);
  return marks;
}

std::vector<std::byte> earlierBakeBytes(const SceneId& scene, const SceneMarks& marks,
                                        const std::map<std::uint64_t, std::span<const std::byte>>& parts) {
  base::ByteWriter bytes;
  bytes.add(kAnswerMagic);
  bytes.add(kBakeVersion);
  for (const std::uint64_t number : {scene.hash, scene.objects, scene.triangles}) {
    bytes.add(number);
  }
  write(marks, bytes);
  bytes.add(static_cast<std::uint64_t>(parts.size()));
  for (const auto& [part, answers] : parts) {
    bytes.add(part);
    bytes.add(static_cast<std::uint64_t>(answers.size()));
    bytes.addBytes(answers);
  }
  std::vector<std::byte> all = bytes.take();
  bytes.add(checksumOf(all));
  const std::vector<std::byte> checksum = bytes.take();
  all.insert(all.end(), checksum.begin(), checksum.end());
  return all;
}

Result<EarlierBake> readEarlierBake(std::vector<std::byte> given) {
  EarlierBake earlier;
  earlier.bytes = std::move(given);
  base::ByteReader bytes(earlier.bytes);
  const auto magic = bytes.read<std::uint64_t>();
  const auto version = bytes.read<std::uint32_t>();
  if (!bytes.ok() || magic != kAnswerMagic) {
    return Error{"is not the answers of a bake"};
  }
  if (version != kBakeVersion) {
    return Error{"is of another version of Sightline; bake in full"};
  }
  const std::size_t checked = earlier.bytes.size() - std::min(earlier.bytes.size(), kChecksumBytes);
  base::ByteReader end(std::span<const std::byte>(earlier.bytes).subspan(checked));
  if (end.read<std::uint64_t>() != checksumOf(std::span<const std::byte>(earlier.bytes).first(checked)) ||
      !end.ok()) {
    return Error{"is cut off or altered; bake in full"};
  }
  for (std::uint64_t* number : {&earlier.scene.hash, &earlier.scene.objects, &earlier.scene.triangles}) {
    *number = bytes.read<std::uint64_t>();
  }
  earlier.marks = readMarks(bytes);
  const auto parts = bytes.readCount<std::uint64_t>(kPartBytes);
  for (std::uint64_t i = 0; i < parts; ++i) {
    const auto part = bytes.read<std::uint64_t>();
    const auto length = bytes.read<std::uint64_t>();
    earlier.parts[part] = bytes.readBytes(length);
  }
  if (!bytes.ok() || bytes.remaining() != kChecksumBytes || !sound(earlier.marks)) {
    return Error{"is not sound; bake in full"};
  }
  return earlier;
}

}  // namespace sightline::pvs
