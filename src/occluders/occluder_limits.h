#pragma once

// How much one occluder can have: what uses occluders has room for so much, and bits.

#include <cstddef>
#include <cstdint>

namespace sightline::occluders {

inline constexpr std::size_t kMaxBodyVertices = 32, kMaxBodyEdges = 64, kMaxBodyFaces = 32;
// An OccluderEdge of more mesh edges is never watertight.
inline constexpr std::uint32_t kMaxMeshEdges = 64;
// A mesh edge in the outlines of more polygons is open in all of them.
inline constexpr std::size_t kMaxPolygonsAtEdge = 64;

}  // namespace sightline::occluders
