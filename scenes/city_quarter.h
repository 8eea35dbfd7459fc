#pragma once

// One quarter of the city: ground, blocks with buildings, furniture up to the quarter's number of triangles.

#include <array>

#include "scenes/city_parts.h"

namespace sightline::scenes {

struct QuarterPlan {
  Placement corner;                      // south-west, on the road
  std::array<BlockKind, 4> blocks;       // south-west, south-east, north-west, north-east
  std::array<std::uint32_t, 4> turns{};  // quarters by which each block is turned
  Random random{0};
  std::string name;
};

QuarterPlan planQuarter(std::uint32_t seed, std::uint32_t number, std::uint32_t columns);
Point2 blockCorner(std::uint32_t block);  // within the quarter
// On the pavement, at that corner of the block which is south-west after its turn.
Placement blockPlacement(const QuarterPlan& plan, std::uint32_t block);
void addQuarter(MeshBuilder& mesh, QuarterPlan plan);

}  // namespace sightline::scenes
