#pragma once

// How far a convex set reaches along a direction, with a bound on all rounding.

#include <cstdint>

#include "src/layers/pairs/convex_pair.h"

namespace sightline::layers {

// A set relative to a local origin, near which all numbers are small, with bounds on the rounding of heights.
// The bounds are derived in convex_set.cpp.
struct LocalSet {
  const ConvexHull* hull = nullptr;
  Placement placement;  // its origin relative to the local one
  ConvexSet::Kind kind = ConvexSet::Kind::kHull;
  Vec3d eye_or_sweep;       // the eye relative to the local origin, or the sweep
  double hull_error = 0.0;  // of the height of the hull's points
  double far_error = 0.0;   // of the height of the eye, or of the sweep
  double size = 0.0;        // no point of the set is farther from the local origin along an axis
};

// The hull has at least one vertex. hull_error, far_error or size is not finite if anything in the set is
// not.
LocalSet localSet(const ConvexSet& set, const Vec3d& local_origin);

// The farthest point of a set along a direction.
struct Reach {
  std::uint32_t vertex = 0;       // numbered as in PairWitness
  std::uint32_t hull_vertex = 0;  // the farthest of the hull alone
  double upper = 0.0;             // no point of the set, computed exactly, is higher; above the local origin
};

// direction: no component exceeds 1 by more than rounding. start: any number, best the last answer's.
Reach reach(const LocalSet& set, const Vec3d& direction, std::uint32_t start);

// The nearest number that the set has: what is beyond its vertices, or names an eye or an end that it has
// not, becomes one of its vertices.
std::uint32_t knownVertex(const LocalSet& set, std::uint32_t vertex);
// The point of a number that the set has, relative to the local origin.
Vec3d pointOf(const LocalSet& set, std::uint32_t vertex);
// The point nearest to a target on the line from the hull's centre to the eye, or along the sweep: inside the
// set.
Vec3d innerPoint(const LocalSet& set, const Vec3d& target);

}  // namespace sightline::layers
