#pragma once

#include <compare>
#include <cstdint>

namespace sightline::occluders {

// An edge of a mesh, in either direction.
struct MeshEdge {
  std::uint32_t low = 0, high = 0;  // vertices
  friend auto operator<=>(const MeshEdge&, const MeshEdge&) = default;
};
inline MeshEdge meshEdge(std::uint32_t a, std::uint32_t b) {
  return a < b ? MeshEdge{a, b} : MeshEdge{b, a};
}

// An edge is led through so many vertices at most, and left as it is where there are more: many long edges
// beside many vertices would take their product of memory.
inline constexpr std::size_t kMostBends = 4096;

}  // namespace sightline::occluders
