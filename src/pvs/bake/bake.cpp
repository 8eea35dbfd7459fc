#include "sightline/pvs/bake/bake.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "base/byte_stream.h"
#include "pvs/bake/bake_scene.h"
#include "pvs/bake/cell_tree.h"
#include "pvs/bake/flatten.h"
#include "pvs/format/checksum.h"

namespace sightline {

using namespace bake_detail;

struct Bake::Data {
  Data(const SceneView& view, const OccluderSet& occluders, const BakeSettings& settings,
       const CellBox& region)
      : scene(view, occluders, settings, region), scene_id(sceneId(view)) {}

  BakeScene scene;
  SceneId scene_id;
  std::uint64_t hash = 0;
  BakedCell top;                // down to the parts, which are leaves here
  std::vector<CellTask> parts;  // in the order of a walk through the top
};

namespace {

constexpr std::uint32_t kVersion = 1;  // of the method: other cells for the same input need another number
constexpr std::uint64_t kPartMagic = 0x5452415054484753u;

// Parts are the cells of this level: few enough to share most samples within, many enough to hand out.
std::uint32_t partLevel(const BakeSettings& settings) {
  return std::min(settings.max_depth, settings.max_depth > 6 ? 3u : 2u);
}

std::string problemWith(const BakeSettings& s) {
  const auto usable = [](double value, double least, double most) { return value >= least && value <= most; };
  if (s.max_depth > kMaxOctreeDepth) {
    return "max_depth is " + std::to_string(s.max_depth) + "; at most " + std::to_string(kMaxOctreeDepth);
  }
  if (!usable(s.near_distance, 0.0, 1e12) || !usable(s.search_distance, 0.0, 1e12)) {
    return "near_distance and search_distance are metres from 0 to 1e12";
  }
  if (!usable(s.occluder_size, 0.0, 1e6)) {
    return "occluder_size is a factor from 0 to 1,000,000";
  }
  if (!usable(s.similarity, 0.0, 1.0) || !usable(s.least_gain, 0.0, 1.0) ||
      !usable(s.merge_tolerance, 0.0, 1e6)) {
    return "similarity and least_gain are from 0 to 1, merge_tolerance is 0 or greater";
  }
  if (!s.region.empty() && !s.region.wellFormed()) {
    return "the region is not finite";
  }
  return {};
}

// Where viewers are. Nothing: nowhere.
std::optional<CellBox> regionOf(const SceneView& scene, const BakeSettings& settings) {
  Box bounds = settings.region;
  if (bounds.empty()) {
    for (const Object& object : scene.objects) {
      if (object.bounds.wellFormed()) {
        bounds.extend(object.bounds);
      }
    }
  }
  if (!bounds.wellFormed()) {
    return std::nullopt;
  }
  return CellBox{Vec3d(bounds.min), Vec3d(bounds.max)};
}

// An eighth of all there is: a few rooms, a few streets.
double firstSearchDistance(const BakeScene& scene) {
  return scene.settings.search_distance > 0.0 ? scene.settings.search_distance : 0.125 * scene.diagonal;
}

std::uint64_t hashOf(const SceneId& scene, const OccluderSet& occluders, const BakeSettings& s,
                     const CellBox& region) {
  ByteWriter bytes;
  for (const std::uint64_t number :
       {std::uint64_t{kVersion}, scene.hash, scene.objects, scene.triangles, occluderSetHash(occluders),
        s.triangle_budget, std::uint64_t{s.max_depth}}) {
    bytes.add(number);
  }
  for (const double number :
       {s.near_distance, s.search_distance, s.occluder_size, s.similarity, s.least_gain, s.merge_tolerance,
        region.min.x, region.min.y, region.min.z, region.max.x, region.max.y, region.max.z}) {
    bytes.add(number);
  }
  return sight_format::checksumOf(bytes.take());
}

// The cells above the parts. The parts are named in order.
BakedCell bakeTop(CellBaker& baker, const BakeScene& scene, const CellTask& task,
                  std::vector<CellTask>& parts) {
  BakedCell cell;
  cell.level = static_cast<std::uint8_t>(task.cell.level);
  if (task.cell.level == partLevel(scene.settings)) {
    parts.push_back(task);
    return cell;
  }
  CellOutcome outcome = decide(baker, scene, task);
  baker.forgetOldest();
  if (!outcome.divide) {
    return std::move(outcome.leaf);
  }
  for (std::uint32_t i = 0; i < 8; ++i) {
    cell.children.push_back(bakeTop(baker, scene, {task.cell.child(i), outcome.search_distance}, parts));
  }
  return cell;
}

}  // namespace

Result<Bake> Bake::plan(const SceneView& scene, const OccluderSet& occluders, const BakeSettings& settings) {
  if (const std::string problem = problemWith(settings); !problem.empty()) {
    return Error{"bake: " + problem};
  }
  const std::optional<CellBox> region = regionOf(scene, settings);
  if (!region) {
    return Error{"bake: the scene has no object with a finite box, so there is nothing to see"};
  }
  for (const Occluder& occluder : occluders.occluders) {
    if (occluder.object.value >= scene.objects.size()) {
      const std::string owner =
          occluder.object.valid() ? "object " + std::to_string(occluder.object.value) : "no object";
      return Error{"bake: an occluder belongs to " + owner + ", but the scene has " +
                   std::to_string(scene.objects.size()) +
                   " objects; give the occluders that findOccluders finds in it"};
    }
  }
  const auto data = std::make_shared<Data>(scene, occluders, settings, *region);
  data->hash = hashOf(data->scene_id, occluders, settings, *region);
  CellBaker baker(data->scene);
  data->top = bakeTop(baker, data->scene, {{}, firstSearchDistance(data->scene)}, data->parts);
  Bake bake;
  bake.data_ = data;
  return bake;
}

std::uint32_t Bake::partCount() const {
  return static_cast<std::uint32_t>(data_->parts.size());
}
std::uint32_t Bake::occluderCount() const {
  return data_->scene.occluders.size();
}
std::uint64_t Bake::hash() const {
  return data_->hash;
}

struct Bake::Worker::Impl {
  explicit Impl(std::shared_ptr<const Data> d) : data(std::move(d)), baker(data->scene) {}

  std::shared_ptr<const Data> data;
  CellBaker baker;
};

Bake::Worker::Worker(const Bake& bake) : impl_(std::make_unique<Impl>(bake.data_)) {}
Bake::Worker::~Worker() = default;
Bake::Worker::Worker(Worker&&) noexcept = default;

namespace {

// Of all leaves of a part.
void summarize(const BakeScene& scene, const BakedCell& cell, std::uint32_t& leaves, double& triangles) {
  for (const BakedCell& child : cell.children) {
    summarize(scene, child, leaves, triangles);
  }
  if (cell.leaf()) {
    leaves += 1;
    triangles += static_cast<double>(scene.triangles.of(cell.sets.whole));
  }
}

}  // namespace

// A part: magic, hash of the plan, number, leaves, mean triangles, the cell.
BakedPart Bake::Worker::bake(std::uint32_t part) {
  const BakeScene& scene = impl_->data->scene;
  const BakedCell cell = bakeCell(impl_->baker, scene, impl_->data->parts[part]);
  std::uint32_t leaves = 0;
  double triangles = 0.0;
  summarize(scene, cell, leaves, triangles);
  ByteWriter bytes;
  bytes.add(kPartMagic);
  bytes.add(impl_->data->hash);
  bytes.add(part);
  bytes.add(leaves);
  bytes.add(triangles / leaves);
  write(cell, bytes);
  return bytes.take();
}

const BakeStats& Bake::Worker::stats() const {
  return impl_->baker.stats();
}

PartSummary Bake::summaryOf(std::span<const std::byte> part) {
  ByteReader bytes(part);
  bytes.readBytes(2 * sizeof(std::uint64_t) + sizeof(std::uint32_t));
  PartSummary summary;
  summary.leaves = bytes.read<std::uint32_t>();
  summary.mean_triangles = bytes.read<double>();
  return summary;
}

namespace {

// Puts the parts where they belong in the top, in the order in which they were named, and merges what can be.
void fillIn(const BakeScene& scene, BakedCell& cell, std::uint32_t part_level, std::vector<BakedCell>& parts,
            std::size_t& next) {
  if (cell.leaf()) {
    if (cell.level == part_level) {
      cell = std::move(parts[next++]);
    }
    return;
  }
  for (BakedCell& child : cell.children) {
    fillIn(scene, child, part_level, parts, next);
  }
  mergeChildren(scene, cell);
}

}  // namespace

Result<BakedVisibility> Bake::assemble(std::span<const BakedPart> parts) const {
  const BakeScene& scene = data_->scene;
  if (parts.size() != data_->parts.size()) {
    return Error{"bake: " + std::to_string(parts.size()) + " parts of " +
                 std::to_string(data_->parts.size())};
  }
  std::vector<BakedCell> cells;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    ByteReader bytes(parts[i]);
    const bool ours = bytes.read<std::uint64_t>() == kPartMagic &&
                      bytes.read<std::uint64_t>() == data_->hash && bytes.read<std::uint32_t>() == i;
    bytes.readBytes(sizeof(std::uint32_t) + sizeof(double));
    std::optional<BakedCell> cell;
    if (ours) {
      cell =
          readCell(bytes, data_->parts[i].cell.level, static_cast<std::uint32_t>(scene.boxes.objects.size()));
    }
    if (!cell || !bytes.atEnd()) {
      return Error{"bake: part " + std::to_string(i) + " is broken or of another plan"};
    }
    cells.push_back(std::move(*cell));
  }
  BakedCell top = data_->top;
  std::size_t next = 0;
  fillIn(scene, top, partLevel(scene.settings), cells, next);

  BakedVisibility baked;
  baked.scene = data_->scene_id;
  baked.record = {scene.settings.near_distance, scene.settings.triangle_budget, scene.settings.max_depth, {}};
  baked.boxes = scene.boxes;
  baked.octree.min = scene.root.min;
  baked.octree.max = scene.root.max;
  flatten(top, baked.boxes.view(), baked.octree, baked.sets);
  return baked;
}

Result<BakedVisibility> bakeVisibility(const SceneView& scene, const OccluderSet& occluders,
                                       const BakeSettings& settings, const ParallelFor& parallel_for) {
  const Result<Bake> bake = Bake::plan(scene, occluders, settings);
  if (!bake) {
    return bake.error();
  }
  std::vector<BakedPart> parts(bake->partCount());
  parallel_for(bake->partCount(), [&](std::uint32_t begin, std::uint32_t end) {
    Bake::Worker worker(*bake);
    for (std::uint32_t i = begin; i < end; ++i) {
      parts[i] = worker.bake(i);
    }
  });
  return bake->assemble(parts);
}

}  // namespace sightline
