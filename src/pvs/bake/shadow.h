#pragma once

// What one convex occluder hides from one point, as planes.

#include <cstdint>

#include "src/pvs/bake/convex_occluder.h"

namespace sightline::pvs {

inline constexpr std::uint32_t kMaxShadowPlanes = 96;

// What an occluder hides from one point: all that lies behind every plane by its tolerance.
struct Shadow {
  Vec3d eye;  // scene space
  std::uint32_t count = 0;
  // dot(normal, x - eye) >= offset: x is behind this plane, for all x that `reach` admits; tolerances are in
  // the offset. Normals have any length.
  double nx[kMaxShadowPlanes], ny[kMaxShadowPlanes], nz[kMaxShadowPlanes], offset[kMaxShadowPlanes];
};

// false: nothing is hidden from there, or it cannot be told. reach: no box that will be asked about, nodes'
// boxes included, has a point farther from the eye, metres. The occluder and the eye must be `separated`.
bool makeShadow(const ConvexOccluders& all, const ConvexOccluder& occluder, const Vec3d& eye, double reach,
                Shadow& shadow);

}  // namespace sightline::pvs
