#include "src/pvs/bake/cell_occluders.h"

#include <algorithm>

namespace sightline::pvs {

CellBox searchBox(const BakeScene& scene, const OctreeCell& cell, double search_distance) {
  return grown(scene.boxOf(cell), search_distance);
}

void CellOccluders::choose(const OctreeCell& cell, double search_distance, std::uint32_t level) {
  choice_ = Choice();
  choice_.cell = scene_.boxOf(cell);
  choice_.search = searchBox(scene_, cell, search_distance);
  choice_.distance = search_distance;
  choice_.level = level;
  chosen_.clear();
}

void CellOccluders::leaveOutWithin(double distance) {
  choice_.known = grown(choice_.cell, distance);
  choice_.distance_before = distance;
  chosen_.clear();
}

std::span<const std::uint32_t> CellOccluders::ranked() {
  if (!chosen_.empty()) {
    return chosen_;
  }
  scene_.findOccluders(choice_.search, choice_.level, chosen_);
  if (choice_.known) {
    std::erase_if(chosen_,
                  [&](std::uint32_t i) { return intersects(*choice_.known, scene_.occluders[i].bounds); });
  }
  const Vec3d extent = choice_.cell.extent();
  ranks_.clear();
  for (const std::uint32_t i : chosen_) {
    const ConvexOccluder& occluder = scene_.occluders[i];
    const Vec3d gap = gapBetween(choice_.cell, occluder.bounds);
    ranks_.emplace_back(-occluder.area / (dot(gap, gap) + dot(extent, extent)), i);
  }
  std::sort(ranks_.begin(), ranks_.end());
  std::transform(ranks_.begin(), ranks_.end(), chosen_.begin(), [](const auto& r) { return r.second; });
  return chosen_;
}

}  // namespace sightline::pvs
