#pragma once

// Pieces of furniture. Each stands with its back to a wall: the placement's origin is on the floor at the
// wall, in the middle of the piece, with x along the wall and y into the room. Most are at most 1.25 m wide
// and 0.75 m deep.

#include <string>

#include "scenes/mesh_builder.h"
#include "scenes/random.h"

namespace sightline::scenes {

enum class Piece : std::uint8_t {
  kDesk,   // with a screen and drawers
  kChair,  // stands 0.35 to 0.95 m from the wall, at a desk
  kShelf,  // with books
  kCupboard,
  kBed,  // 2 m wide, 0.9 m deep
  kBedside,
  kSofa,   // 2 m wide, 0.85 m deep
  kBasin,  // with a mirror
  kToilet,
  kRadiator,
  kRack,   // a storage rack with boxes
  kTable,  // 1.8 m by 1 m around the origin, with six chairs
  kFloorLamp,
  kCeilingLight,  // hangs from z = 0
};
void addPiece(MeshBuilder& mesh, Piece piece, const Placement& placement, Random& random,
              const std::string& name);

}  // namespace sightline::scenes
