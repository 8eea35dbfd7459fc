#pragma once

// The farthest point of a convex set along a direction, with a bound on the rounding error.

#include <cstdint>

#include "src/layers/pairs/convex_pair.h"

namespace sightline::layers {

// A set relative to a local origin, near which all coordinates are small, with bounds on the rounding error
// of heights, which are derived in convex_set.cpp.
struct LocalSet {
  const ConvexHull* hull = nullptr;
  Placement placement;  // with an origin relative to the local one
  ConvexSet::Kind kind = ConvexSet::Kind::kHull;
  Vec3d eye_or_sweep;                  // the eye relative to the local origin, or the sweep
  std::span<const Vec3d> more_eyes{};  // relative to the world's origin
  Vec3d local_origin;
  double hull_error = 0.0;  // bound of the error of the heights of the hull's points
  double far_error = 0.0;   // bound of the error of the height of the eye or the sweep
  double size = 0.0;        // bound of the distance from the local origin along an axis
};

// Makes a set local. The hull must have a vertex. hull_error, far_error or size is not finite if any number
// of the set is not.
LocalSet localSet(const ConvexSet& set, const Vec3d& local_origin);

// The farthest point of a set along a direction.
struct Reach {
  std::uint32_t vertex = 0;       // numbered as in PairWitness
  std::uint32_t hull_vertex = 0;  // the farthest vertex of the hull alone
  double upper = 0.0;             // upper bound of the exact heights above the local origin
};

// Finds the farthest point.
// direction: components exceed 1 by no more than rounding.
// start: the vertex at which the search starts; any number is valid, the last answer is best.
Reach reach(const LocalSet& set, const Vec3d& direction, std::uint32_t start);

// Returns a vertex number that the set has: a number beyond its vertices, or of an eye or swept end that it
// does not have, becomes one of its vertices.
std::uint32_t knownVertex(const LocalSet& set, std::uint32_t vertex);
// Returns the point of a vertex number that the set has, relative to the local origin.
Vec3d pointOf(const LocalSet& set, std::uint32_t vertex);
// Returns the point nearest to a target on the segment from the hull's centre to the eye or along the sweep,
// which lies inside the set.
Vec3d innerPoint(const LocalSet& set, const Vec3d& target);

}  // namespace sightline::layers
