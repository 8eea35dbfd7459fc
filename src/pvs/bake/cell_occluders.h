#pragma once

// The convex occluders that count for a cell.

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "src/pvs/bake/bake_scene.h"
#include "src/pvs/bake/convex/convex_search.h"

namespace sightline::pvs {

// The cell grown by search_distance metres on all sides.
CellBox searchBox(const BakeScene& scene, const OctreeCell& cell, double search_distance);

// Use by one thread at a time.
class CellOccluders {
 public:
  // scene must outlive this.
  explicit CellOccluders(const BakeScene& scene) : scene_(scene) {}

  struct Choice : OccluderChoice {
    CellBox cell{};
    double distance = 0.0, distance_before = 0.0;  // of the search boxes, metres
  };

  // Those that intersect the cell's search box and are useful to cells of this level.
  void choose(const OctreeCell& cell, double search_distance, std::uint32_t level);
  // Without those that intersect the smaller search box, of this distance.
  void leaveOutWithin(double distance);

  const Choice& choice() const { return choice_; }
  // Finds them, those that look largest from the cell first.
  std::span<const std::uint32_t> ranked();

 private:
  const BakeScene& scene_;
  Choice choice_;
  std::vector<std::uint32_t> chosen_;  // empty until they have been found
  std::vector<std::pair<double, std::uint32_t>> ranks_;
};

}  // namespace sightline::pvs
