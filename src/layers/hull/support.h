#pragma once

// The vertex of a hull that is farthest along a direction.

#include <cstddef>
#include <cstdint>

#include "sightline/layers/hull.h"

namespace sightline::layers {

struct Support {
  std::uint32_t vertex = 0;
  double height = 0.0;  // dot(direction, vertex)
};

// By going uphill from vertex `start` (any, as the last answer), or by looking at all where that is not safe
// or not worth it. direction: in the hull's space, any finite one.
Support farthest(const ConvexHull& hull, const Vec3d& direction, std::uint32_t start);

// By how much the height of any point that the hull was made of, computed exactly, may exceed what farthest()
// returns. length: of the direction, rounded up.
double supportError(const ConvexHull& hull, double length);

// Whether farthest() goes uphill.
inline bool climbs(const ConvexHull& hull) {
  constexpr std::size_t kScanUpTo = 24;  // vertices
  return hull.descent_factor > 0.0 && hull.vertices.size() > kScanUpTo;
}
// farthest() by looking at all.
Support farthestOfAll(const ConvexHull& hull, const Vec3d& direction);

}  // namespace sightline::layers
