#pragma once

// The range of angles under which the eye sees a hull in a plane.
//
// Based on: Snyder, Lengyel. MSR-TR-97-11, section 5.1 and appendix A.
// Differs from the paper in: the frame of reference is never turned. The cross product of two directions
// tells which has the greater angle, wherever angle 0 is; only the final number has a branch cut.

#include <cstdint>

#include "sightline/layers/hull.h"
#include "src/layers/extents/plane_angle.h"

namespace sightline::layers {

// The map from a hull's space to the plane, whose origin is the eye.
struct PlaneMap {
  Vec3d x, z;          // rows: directions in the hull's space
  PlanePoint origin;   // image of the hull's origin
  double stretch = 1;  // upper bound of the factor by which the map lengthens distances
  // Bounds in the plane: of the distance of a computed point from the exact one, and of the distance of an
  // input point of the hull from the hull.
  double rounding = 0.0, slack = 0.0;

  PlanePoint at(const Vec3d& p) const {
    return {sightline::dot(x, p) + origin.x, sightline::dot(z, p) + origin.z};
  }
};

// The vertices at which the search starts; any numbers are valid, those of the last answer are best.
struct AngularVertices {
  std::uint32_t low = 0, high = 0;  // the vertices with the smallest and the greatest angle
  std::uint32_t nearest = 0;        // the nearest vertex along a reference direction
};

// Returns a range that contains the exact angles of all input points of the hull, by comparing all vertices.
// It is the full circle if the eye lies in the hull's image or too near to it for rounding to tell. error: as
// errorOf() returns it. ends: receives the vertices found.
AngleRange anglesOfAll(const ConvexHull& hull, const PlaneMap& map, double error, AngularVertices& ends);

// Returns a bound of the error of the ends, as a length in the plane; angular_extent-inl.h derives it.
inline double errorOf(const ConvexHull& hull, const PlaneMap& map) {
  return map.slack + map.rounding * (4.0 + 4.0 * hull.descent_factor);
}
// Returns the range from low to high widened by the error, for a hull at least `distance` from the eye.
inline AngleRange widened(const PlanePoint& low, const PlanePoint& high, double distance, double error) {
  if (!(distance > 4.0 * error)) {
    return {};
  }
  const double room = 2.0 * error / distance;
  const AngleRange range = rangeBetween(low, high);
  return {range.low - room, range.high + room};
}

}  // namespace sightline::layers
