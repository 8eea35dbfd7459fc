#pragma once

// Finds the occluders that are large enough, seen from a point, to be drawn.

#include <vector>

#include "sightline/occluders/occluder_set.h"

namespace sightline::comparison {

// An occluder that may be in a picture.
struct NearOccluder {
  OccluderId id;
  double radius = 0.0;  // of a sphere around the centroid that holds the polygon, metres
};

// The occluders of a set that are large from a point.
class OccluderFilter {
 public:
  // Leaves out occluders with coordinates that are not finite.
  explicit OccluderFilter(const OccluderSet& set);

  // Finds the occluders of which the eye sees a side that hides, and that may have at least this solid angle
  // (steradians), ascending by id. A h / r^3 bounds the solid angle, where A is the area, h the eye's height
  // over the plane, and r the distance of the nearest point.
  void find(const Vec3d& eye, double min_solid_angle, std::vector<NearOccluder>& found) const;

 private:
  const OccluderSet& set_;
  std::vector<NearOccluder> all_;
};

}  // namespace sightline::comparison
