#pragma once

// An ellipsoid and a box around a hull: they bound how far it reaches along a direction without looking at
// vertices.

#include <cmath>
#include <vector>

#include "sightline/layers/hull.h"

namespace sightline::layers {

// In the hull's space: all points centre + x a + y b + z c with x^2 + y^2 + z^2 <= 1; all points from
// box_centre up to box_half away along each axis.
struct HullEnvelope {
  Vec3d centre;
  Vec3d a, b, c;
  Vec3d box_centre, box_half;
  double reach = 0.0;  // no component of a point of it is greater, nor the sum of what height() adds up

  // dot(direction, p) of no point p of the hull is greater, up to rounding, and up to 1e-160 where squares
  // underflow.
  double height(const Vec3d& direction) const {
    const double x = dot(a, direction), y = dot(b, direction), z = dot(c, direction);
    const double round = dot(centre, direction) + std::sqrt(x * x + y * y + z * z);
    const double square = dot(box_centre, direction) + dot(box_half, abs(direction));
    return round < square ? round : square;
  }
};

// Of the shape of the vertices' scatter. Holds all points that the hull was made of. Where that cannot be
// said (a single point, or what is not finite), all its numbers and heights are not numbers.
HullEnvelope envelopeOf(const ConvexHull& hull);

}  // namespace sightline::layers
