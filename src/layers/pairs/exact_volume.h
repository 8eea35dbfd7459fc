#pragma once

// The side of a plane or line on which a point lies, with an exact sign.

#include "sightline/math/vec3.h"

namespace sightline::layers {

// Returns ((b - a) x (c - a)) . (p - a), six times the volume of a tetrahedron, which is positive where p
// sees a, b, c counter-clockwise. For coordinates of at most 1 the sign is exact and the value is within 2 %
// (what underflows is below 1e-300).
// Source: Shewchuk. Adaptive precision floating-point arithmetic and fast robust geometric predicates.
// Discrete & Computational Geometry 1997.
double exactVolume(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& p);

// Returns (b - a) x (p - a) in a plane, which is positive where a, b, p turn left. As exact as exactVolume().
double exactArea(double ax, double ay, double bx, double by, double px, double py);

}  // namespace sightline::layers
