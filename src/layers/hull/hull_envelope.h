#pragma once

// An ellipsoid and a box around a hull, which bound its heights along a direction without comparing vertices.

#include <cmath>
#include <vector>

#include "sightline/layers/hull.h"

namespace sightline::layers {

// In the hull's space. The ellipsoid is all points centre + x a + y b + z c with x^2 + y^2 + z^2 <= 1; the
// box is all points within box_half of box_centre along each axis.
struct HullEnvelope {
  Vec3d centre;
  Vec3d a, b, c;
  Vec3d box_centre, box_half;
  double reach = 0.0;  // bound of the points' components and of the sum of the magnitudes that height() adds

  // Returns an upper bound of dot(direction, p) over the points p of the hull, up to rounding, and up to
  // 1e-160 where squares underflow.
  double height(const Vec3d& direction) const {
    const double x = dot(a, direction), y = dot(b, direction), z = dot(c, direction);
    const double round = dot(centre, direction) + std::sqrt(x * x + y * y + z * z);
    const double square = dot(box_centre, direction) + dot(box_half, abs(direction));
    return round < square ? round : square;
  }
};

// Returns an envelope that contains all input points of the hull. The ellipsoid has the shape of the
// vertices' covariance. For a single point, and for a hull that is not finite, all numbers and heights are
// NaN.
HullEnvelope envelopeOf(const ConvexHull& hull);

}  // namespace sightline::layers
