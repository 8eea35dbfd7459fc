#pragma once

#include "sightline/base/inline.h"
#include "sightline/math/vec3.h"

namespace sightline {

// The plane dot(normal, p) + offset = 0. The normal need not have unit length unless a user of the plane says
// so.
struct Plane {
  Vec3d normal{};
  double offset = 0.0;

  // Signed distance times the normal's length; positive on the side to which the normal points.
  SIGHTLINE_INLINE constexpr double evaluate(const Vec3d& point) const { return dot(normal, point) + offset; }
  constexpr Plane flipped() const { return {-normal, -offset}; }
  SIGHTLINE_INLINE friend constexpr bool operator==(const Plane&, const Plane&) = default;
};

}  // namespace sightline
