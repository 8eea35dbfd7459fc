#pragma once

// The angles under which the eye sees a hull in a plane.
//
// Based on: Snyder, Lengyel. MSR-TR-97-11, section 5.1 and appendix A.
// Differs from the paper in: the frame of reference is never turned. Which of two directions has the greater
// angle is told by their cross product, wherever angle 0 is; a branch cut exists only in the final number.

#include <cstdint>

#include "sightline/layers/hull.h"
#include "src/layers/extents/plane_angle.h"

namespace sightline::layers {

// From a hull's space to the plane; the eye is its origin.
struct PlaneMap {
  Vec3d x, z;          // rows: directions in the hull's space
  PlanePoint origin;   // where the hull's origin comes to lie
  double stretch = 1;  // no two points come to lie farther apart than this times their distance
  // In the plane: no computed point of the hull is farther than `rounding` from the exact one, nor a point
  // that the hull was made of than `slack` from the hull.
  double rounding = 0.0, slack = 0.0;

  PlanePoint at(const Vec3d& p) const {
    return {sightline::dot(x, p) + origin.x, sightline::dot(z, p) + origin.z};
  }
};

// Where the search begins: any numbers, best the last answer's.
struct AngularVertices {
  std::uint32_t low = 0, high = 0;  // with the least and the greatest angle
  std::uint32_t nearest = 0;        // least far along a direction of reference
};

// A range that holds the exact angles of all points that the hull was made of; the full circle if the eye
// lies in the hull's image or so near that rounding does not tell.
AngleRange angularExtent(const ConvexHull& hull, const PlaneMap& map, AngularVertices& start);
// The same by looking at all vertices. error: see errorOf(). ends: the answer's.
AngleRange anglesOfAll(const ConvexHull& hull, const PlaneMap& map, double error, AngularVertices& ends);

// What the ends found may be off by, in the plane; angular_extent-inl.h derives it.
inline double errorOf(const ConvexHull& hull, const PlaneMap& map) {
  return map.slack + map.rounding * (4.0 + 4.0 * hull.descent_factor);
}
// From low to high with the hull at least `distance` from the eye.
inline AngleRange widened(const PlanePoint& low, const PlanePoint& high, double distance, double error) {
  if (!(distance > 4.0 * error)) {
    return {};
  }
  const double room = 2.0 * error / distance;
  const AngleRange range = rangeBetween(low, high);
  return {range.low - room, range.high + room};
}

}  // namespace sightline::layers
