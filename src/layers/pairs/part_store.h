#pragma once

// The parts of a sorter as columns of data, and the hulls that they share.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sightline/layers/hull.h"
#include "src/layers/hull/hull_box.h"
#include "src/layers/hull/hull_envelope.h"
#include "src/layers/pairs/placement.h"

namespace sightline::layers {

struct PartStore {
  std::vector<ConvexHull> hulls;
  std::vector<HullEnvelope> envelopes;       // one per hull, or empty
  std::vector<HullBox> boxes;                // one per hull, needed with a contact tolerance
  std::vector<std::uint32_t> first_hull{0};  // parts + 1 elements: where each part begins in part_hulls
  std::vector<std::uint32_t> part_hulls;     // indices of hulls; an index of this column is an "instance"
  std::vector<Placement> placements;         // one per part
  std::vector<std::uint8_t> finite;  // one per part: its placement is finite and its hulls have vertices

  std::size_t parts() const { return placements.size(); }
  std::size_t instances() const { return part_hulls.size(); }
  // Returns the hulls of part p, those of instances [first_hull[p], first_hull[p + 1]).
  std::span<const std::uint32_t> hullsOf(std::uint32_t part) const {
    return std::span(part_hulls).subspan(first_hull[part], first_hull[part + 1] - first_hull[part]);
  }
};

}  // namespace sightline::layers
