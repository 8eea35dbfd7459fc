#pragma once

// On which side of a plane or line a point lies, without rounding.

#include "sightline/math/vec3.h"

namespace sightline::layers {

// ((b - a) x (c - a)) . (p - a): six times a volume, positive where p sees a, b, c counter-clockwise. The
// sign is exact and the value within 2 % for coordinates of at most 1 (what underflows is below 1e-300).
// Source: Shewchuk. Adaptive precision floating-point arithmetic and fast robust geometric predicates.
// Discrete & Computational Geometry 1997.
double exactVolume(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& p);

// (b - a) x (p - a) in the plane of two coordinates: positive where a, b, p turn left. As exact.
double exactArea(double ax, double ay, double bx, double by, double px, double py);

}  // namespace sightline::layers
