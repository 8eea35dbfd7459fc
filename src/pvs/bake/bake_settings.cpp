#include "src/pvs/bake/bake_settings.h"

#include <algorithm>
#include <vector>

#include "src/base/byte_stream.h"
#include "src/pvs/bake/bake_scene.h"
#include "src/pvs/bake/doors/door_groups.h"
#include "src/pvs/format/checksum.h"

namespace sightline::pvs {
namespace {

constexpr std::uint32_t kMaxDivisions = 16, kMaxNarrowings = 8;

// Each group of doors has surfaces of its own in memory.
constexpr std::size_t kMostFusedGroups = 256;

}  // namespace

std::string problemWith(const BakeSettings& s) {
  const auto usable = [](double value, double min, double max) { return value >= min && value <= max; };
  if (s.max_depth > kMaxOctreeDepth && s.max_depth != BakeSettings::kChooseDepth) {
    return "max_depth is " + std::to_string(s.max_depth) + "; at most " + std::to_string(kMaxOctreeDepth);
  }
  if (!usable(s.near_distance, 0.0, 1e12) || !usable(s.search_distance, 0.0, 1e12)) {
    return "near_distance and search_distance are metres from 0 to 1e12";
  }
  if (s.occlusion == BakeOcclusion::kFused && doorGroupsOf(s.doors).groups.size() > kMostFusedGroups) {
    return "there are more than " + std::to_string(kMostFusedGroups) +
           " groups of doors (each door is one, and so are all together); name fewer, or use convex "
           "occlusion";
  }
  if (!usable(s.occluder_size, 0.0, 1e6)) {
    return "occluder_size is a factor from 0 to 1,000,000";
  }
  if (!usable(s.similarity, 0.0, 1.0) || !usable(s.min_gain, 0.0, 1.0) ||
      !usable(s.merge_tolerance, 0.0, 1e6)) {
    return "similarity and min_gain are from 0 to 1, merge_tolerance is 0 or greater";
  }
  if (s.divisions > kMaxDivisions) {
    return "divisions is " + std::to_string(s.divisions) + "; at most " + std::to_string(kMaxDivisions);
  }
  if (s.narrowings > kMaxNarrowings) {
    return "narrowings is " + std::to_string(s.narrowings) + "; at most " + std::to_string(kMaxNarrowings);
  }
  if (s.object_boxes == 0 || s.object_boxes > kMaxObjectBoxes) {
    return "object_boxes is " + std::to_string(s.object_boxes) + "; from 1 to " +
           std::to_string(kMaxObjectBoxes);
  }
  if (!usable(s.box_margin, 0.0, 1e12)) {
    return "box_margin is metres from 0 to 1e12";
  }
  if (!std::all_of(s.viewers.begin(), s.viewers.end(), [](const Box& box) { return box.wellFormed(); })) {
    return "a box of viewers is empty or not finite";
  }
  return {};
}

std::uint64_t planHash(const SceneId& scene, const OccluderSet& occluders, const BakeSettings& s,
                       std::uint32_t base_depth) {
  base::ByteWriter bytes;
  for (const std::uint64_t number :
       {std::uint64_t{kBakeVersion}, scene.hash, scene.objects, scene.triangles, occluderSetHash(occluders),
        static_cast<std::uint64_t>(s.occlusion), s.triangle_budget, std::uint64_t{s.max_depth},
        std::uint64_t{base_depth}, std::uint64_t{s.divisions}, std::uint64_t{s.narrowings},
        std::uint64_t{s.object_boxes}}) {
    bytes.add(number);
  }
  for (const double number : {s.near_distance, s.search_distance, s.occluder_size, s.similarity, s.min_gain,
                              s.merge_tolerance, s.box_margin}) {
    bytes.add(number);
  }
  bytes.add(std::uint64_t{s.viewers.size()});
  for (const Box& box : s.viewers) {
    for (const float number : {box.min.x, box.min.y, box.min.z, box.max.x, box.max.y, box.max.z}) {
      bytes.add(number);
    }
  }
  bytes.add(std::uint8_t{s.whole_cells});
  const std::vector<std::vector<ObjectId>> groups = doorGroupsOf(s.doors).groups;
  bytes.add(std::uint64_t{groups.size()});
  for (const std::vector<ObjectId>& group : groups) {
    bytes.add(std::uint64_t{group.size()});
    for (const ObjectId door : group) {
      bytes.add(door.value);
    }
  }
  if (s.witnesses) {
    bytes.add(std::uint8_t{1});  // parts without witnesses are those of another plan
  }
  if (s.answers) {
    bytes.add(std::uint8_t{2});
  }
  return checksumOf(bytes.take());
}

}  // namespace sightline::pvs
