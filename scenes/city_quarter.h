#pragma once

// One quarter of the city: ground, blocks with buildings, and furniture up to the quarter's number of
// triangles.

#include <array>

#include "scenes/city_parts.h"

namespace sightline::scenes {

struct QuarterPlan {
  Placement corner;                      // south-west corner, on the road
  std::array<BlockKind, 4> blocks;       // south-west, south-east, north-west, north-east
  std::array<std::uint32_t, 4> turns{};  // quarter turns of each block
  Random random{0};
  std::string name;
};

QuarterPlan planQuarter(std::uint32_t seed, std::uint32_t number, std::uint32_t columns);
Point2 blockCorner(std::uint32_t block);  // within the quarter
// A placement on the pavement, at the corner of the block that is south-west after its turn.
Placement blockPlacement(const QuarterPlan& plan, std::uint32_t block);
void addQuarter(MeshBuilder& mesh, QuarterPlan plan);

}  // namespace sightline::scenes
