#pragma once

// The region that one convex occluder hides from one point, as planes.

#include <cstdint>

#include "src/pvs/bake/convex/convex_occluder.h"

namespace sightline::pvs {

inline constexpr std::uint32_t kMaxShadowPlanes = 96;

// Hides every point that is behind all planes by their tolerance.
struct Shadow {
  Vec3d eye;  // scene space
  std::uint32_t count = 0;
  // x is behind this plane if dot(normal, x - eye) >= offset, for all x within makeShadow's `reach`.
  // Tolerances are included in the offset. Normals have any length.
  double nx[kMaxShadowPlanes], ny[kMaxShadowPlanes], nz[kMaxShadowPlanes], offset[kMaxShadowPlanes];
};

// Returns false if nothing is hidden from there or the occluder cannot be decided. reach: upper bound in
// metres of the distance from the eye to any point of any box that will be tested, including boxes of nodes.
// The occluder and the eye must be `separated`.
bool makeShadow(const ConvexOccluders& all, const ConvexOccluder& occluder, const Vec3d& eye, double reach,
                Shadow& shadow);

}  // namespace sightline::pvs
