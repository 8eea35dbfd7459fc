// The bytes: magic, length of the key, the key, four lists of objects as in ExactObjects, each the number of
// ids and the ids, checksum of all before it. Little-endian.

#include "tools/sightline/exact/exact_bytes.h"

#include <algorithm>
#include <functional>
#include <iterator>
#include <span>

#include "src/base/byte_stream.h"

#define XXH_INLINE_ALL
#include "src/pvs/format/checksum.h"

namespace sightline::tool {
namespace {

constexpr std::uint64_t kExactMagic = 0x3274636178654c53;  // "SLexact2"

std::vector<std::uint32_t> numbersOf(const std::vector<ObjectId>& ids) {
  std::vector<std::uint32_t> numbers;
  for (const ObjectId id : ids) {
    numbers.push_back(id.value);
  }
  return numbers;
}

std::vector<ObjectId> idsOf(const std::vector<std::uint32_t>& numbers) {
  std::vector<ObjectId> ids;
  for (const std::uint32_t number : numbers) {
    ids.push_back(ObjectId(number));
  }
  return ids;
}

// True if the numbers ascend, each once, and are less than `count`.
bool ascendBelow(const std::vector<std::uint32_t>& numbers, std::uint64_t count) {
  return std::adjacent_find(numbers.begin(), numbers.end(), std::greater_equal<>()) == numbers.end() &&
         (numbers.empty() || numbers.back() < count);
}

bool haveNoneInCommon(const std::vector<std::uint32_t>& a, const std::vector<std::uint32_t>& b) {
  std::vector<std::uint32_t> common;
  std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(common));
  return common.empty();
}

}  // namespace

std::vector<std::byte> viewBytes(const View& view) {
  base::ByteWriter writer;
  for (const Vec3d& vector : {view.eye, view.right, view.up, view.forward}) {
    for (int axis = 0; axis < 3; ++axis) {
      writer.add(vector[axis]);
    }
  }
  writer.add(static_cast<std::uint8_t>(view.orthographic ? 1 : 0));
  for (const double number : {view.tan_half_fovy, view.ortho_height, view.aspect, view.z_near, view.z_far}) {
    writer.add(number);
  }
  // Symmetric views keep the bytes, and so the answers, that they had before there were others.
  if (view.shift_x != 0.0 || view.shift_y != 0.0) {
    writer.add(view.shift_x);
    writer.add(view.shift_y);
  }
  return writer.take();
}

ExactKey::ExactKey(const SceneId& scene, const View& view, const ExactSettings& settings)
    : object_count(scene.objects) {
  base::ByteWriter writer;
  for (const std::uint64_t number : {scene.hash, scene.objects, scene.triangles}) {
    writer.add(number);
  }
  for (const std::uint32_t number : {kExactFrameVersion, settings.width, settings.height, settings.aimed_rays,
                                     settings.edge_rays, settings.steps}) {
    writer.add(number);
  }
  writer.addBytes(viewBytes(view));
  bytes = writer.take();
}

std::string exactBytes(const ExactKey& key, const ExactObjects& frame) {
  base::ByteWriter writer;
  writer.add(kExactMagic);
  writer.add(static_cast<std::uint64_t>(key.bytes.size()));
  writer.addBytes(key.bytes);
  for (const std::vector<ObjectId>* ids :
       {&frame.witnessed, &frame.undecided, &frame.boxes, &frame.undecided_boxes}) {
    writer.add(static_cast<std::uint64_t>(ids->size()));
    writer.addAll(std::span<const std::uint32_t>(numbersOf(*ids)));
  }
  std::vector<std::byte> bytes = writer.take();
  base::ByteWriter sum;
  sum.add(pvs::checksumOf(bytes));
  const std::vector<std::byte> end = sum.take();
  bytes.insert(bytes.end(), end.begin(), end.end());
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::optional<ExactObjects> exactFromBytes(const ExactKey& key, std::string_view text) {
  const std::span<const std::byte> bytes = std::as_bytes(std::span(text));
  constexpr std::size_t kSum = sizeof(std::uint64_t);
  if (bytes.size() < kSum) {
    return {};
  }
  base::ByteReader reader(bytes);
  const bool same_magic = reader.read<std::uint64_t>() == kExactMagic;
  const std::span<const std::byte> kept_key = reader.readBytes(reader.readCount<std::uint64_t>(1));
  if (!same_magic || !std::equal(kept_key.begin(), kept_key.end(), key.bytes.begin(), key.bytes.end())) {
    return {};
  }
  const auto read_ids = [&reader] {
    const auto count = reader.readCount<std::uint64_t>(sizeof(std::uint32_t));
    return reader.readAll<std::uint32_t>(count);
  };
  const std::vector<std::uint32_t> witnessed = read_ids(), undecided = read_ids(), boxes = read_ids(),
                                   undecided_boxes = read_ids();
  const auto sum = reader.read<std::uint64_t>();
  if (!reader.atEnd() || sum != pvs::checksumOf(bytes.first(bytes.size() - kSum)) ||
      !ascendBelow(witnessed, key.object_count) || !ascendBelow(undecided, key.object_count) ||
      !ascendBelow(boxes, key.object_count) || !ascendBelow(undecided_boxes, key.object_count) ||
      !haveNoneInCommon(witnessed, undecided) || !haveNoneInCommon(witnessed, boxes) ||
      !haveNoneInCommon(witnessed, undecided_boxes) || !haveNoneInCommon(boxes, undecided_boxes)) {
    return {};
  }
  return ExactObjects{idsOf(witnessed), idsOf(undecided), idsOf(boxes), idsOf(undecided_boxes)};
}

}  // namespace sightline::tool
