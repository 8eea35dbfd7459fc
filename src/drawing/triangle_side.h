#pragma once

#include "sightline/math/vec3.h"
#include "sightline/scene/camera.h"

namespace sightline::drawing {

// Which side of a triangle a view sees: 1 its front (counter-clockwise), -1 its back, 0 neither: the eye lies
// in its plane within the rounding of double precision, or the triangle has no area or is not finite.
int sideSeen(const Vec3f& a, const Vec3f& b, const Vec3f& c, const View& view);

}  // namespace sightline::drawing
