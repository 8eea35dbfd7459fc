#pragma once

#include "sightline/math/vec3.h"
#include "sightline/scene/camera.h"

namespace sightline::drawing {

// The side of a triangle that a view sees: 1 its front (counter-clockwise), -1 its back, 0 neither. It sees
// neither if the eye lies in the triangle's plane within the rounding of double precision, or if the triangle
// has no area or is not finite.
int sideSeen(const Vec3f& a, const Vec3f& b, const Vec3f& c, const View& view);

}  // namespace sightline::drawing
