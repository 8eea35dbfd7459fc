#pragma once

// The farthest vertex of a hull along a direction.

#include <cstddef>
#include <cstdint>

#include "sightline/layers/hull.h"

namespace sightline::layers {

struct Support {
  std::uint32_t vertex = 0;
  double height = 0.0;  // dot(direction, vertex)
};

// Finds the farthest vertex by going uphill from vertex `start`, or by comparing all vertices if that is not
// safe or not worth it.
// direction: finite, in the hull's space. start: any number; the last answer is best.
Support farthest(const ConvexHull& hull, const Vec3d& direction, std::uint32_t start);

// Returns a bound by which the exact height of an input point of the hull may exceed the height from
// farthest().
// length: the direction's length, rounded up.
double supportError(const ConvexHull& hull, double length);

// Whether farthest() goes uphill for this hull.
inline bool climbs(const ConvexHull& hull) {
  constexpr std::size_t kScanUpTo = 24;  // vertices
  return hull.descent_factor > 0.0 && hull.vertices.size() > kScanUpTo;
}
// farthest() by comparing all vertices.
Support farthestOfAll(const ConvexHull& hull, const Vec3d& direction);

}  // namespace sightline::layers
