#pragma once

// An ellipsoid and a box around a hull, which bound its heights along a direction without comparing vertices.

#include <array>

#include "sightline/layers/hull.h"
#include "src/layers/hull/hull_box.h"

namespace sightline::layers {

// In the hull's space. The ellipsoid is all points centre + x a + y b + z c with x^2 + y^2 + z^2 <= 1, with
// the half axes a, b and c; the box is those with |x|, |y|, |z| <= 1 for its own centre and half axes.
struct HullEnvelope {
  Vec3d round_centre, box_centre;
  std::array<Vec3d, 3> round_axes, box_axes;
  double reach = 0.0;  // bound of the points' components and of the sum of the magnitudes that height() adds
};

// Returns an envelope that contains all input points of the hull. The ellipsoid has the shape of the
// vertices' covariance. For a single point, and for a hull that is not finite, all numbers are NaN.
// box: boxOf(hull).
HullEnvelope envelopeOf(const ConvexHull& hull, const HullBox& box);
inline HullEnvelope envelopeOf(const ConvexHull& hull) {
  return envelopeOf(hull, boxOf(hull));
}

}  // namespace sightline::layers
