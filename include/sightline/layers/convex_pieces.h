#pragma once

// Divides a mesh into pieces whose convex hulls together stand for it more closely than one hull does: the
// hulls of a part that is not convex (LayerSorter::addPart).

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sightline/base/result.h"
#include "sightline/layers/hull.h"
#include "sightline/math/vec3.h"

namespace sightline {

struct ConvexPieceSettings {
  std::uint32_t max_pieces = 16;  // 1 to kMaxConvexPieces; others count as the nearest of these
};
inline constexpr std::uint32_t kMaxConvexPieces = 1024;

// Returns the hulls of the pieces, at least one. Conservative: every point of every triangle is in one of
// them (within ConvexHull::slack), so an order of the union is right for the mesh. Fewer pieces than
// max_pieces mean that more would not make the hulls' surfaces smaller; a convex mesh has one. The same input
// gives the same bits. triangles: indices of positions. The time is about that of 20 hulls of the mesh for
// each doubling of the pieces; of meshes of more than 20,000 triangles that of three. Errors: no triangles,
// an index that positions does not have, and those of buildHull().
Result<std::vector<ConvexHull>> convexPieces(std::span<const Vec3d> positions,
                                             std::span<const std::array<std::uint32_t, 3>> triangles,
                                             const ConvexPieceSettings& settings = {});

}  // namespace sightline
