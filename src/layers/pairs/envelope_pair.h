#pragma once

// Whether the envelopes of two convex sets are disjoint. Most pairs of disjoint sets are told apart by them,
// without a look at a vertex.

#include <cmath>
#include <cstdint>

#include "sightline/geometry/tolerance.h"
#include "src/layers/pairs/convex_pair.h"

namespace sightline::layers {

// An upper bound of the heights of a hull's points along a direction, whose length exceeds 1 by no more than
// rounding, by the hull's envelope. NaN or infinite if any input is not finite.
// offset: from the point above which heights are measured to the origin of the hull's placement.
inline double outerHeight(const HullEnvelope& around, const Placement& placement, const Vec3d& offset,
                          const Vec3d& direction) {
  // For sums of numbers whose magnitudes add up to m, 2^-45 m is far above the rounding error, and the last
  // number above what underflows.
  const double stretch = l1Norm(placement.x) + l1Norm(placement.y) + l1Norm(placement.z);
  return around.height(placement.toHull(direction)) + dot(direction, offset) +
         0x1p-45 * (stretch * around.reach() + l1Norm(offset)) + 1e-150;
}
// The outer height of a single point.
inline double outerHeight(const Vec3d& point, const Vec3d& direction) {
  return dot(direction, point) + 0x1p-45 * l1Norm(point);
}

// The outer height above a point of a set with an envelope.
double outerHeight(const ConvexSet& set, const Vec3d& direction, const Vec3d& above);

inline bool isUnit(const Vec3d& direction) {
  return std::abs(dot(direction, direction) - 1.0) <= 1e-9;
}

// A unit vector from about the middle of the first set towards the second, to begin a search with.
// Both sets must have envelopes; the first one is a placed hull.
Vec3d directionBetween(const ConvexSet& first, const ConvexSet& second);

// Whether all of the first set lies below all of the second along a direction, by the bounds of
// outerHeight().
bool separates(const ConvexSet& first, const ConvexSet& second, const Vec3d& direction);

// Looks for a unit vector along which all of the first set lies below all of the second, by the bounds of
// outerHeight(). Returns false if a few directions show none; the sets may be disjoint all the same.
// Both sets must have envelopes.
// direction: where the search begins, of unit length, which does not separate them; receives a vector along
// which the gap is as wide as the search found, so that it lasts for some frames. Unchanged without a gap.
// steps: increased by the number of directions tried.
bool separateEnvelopes(const ConvexSet& first, const ConvexSet& second, Vec3d& direction,
                       std::uint64_t& steps);

}  // namespace sightline::layers
