#pragma once

// Which occluders are large enough from a point to be drawn.

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
  // Leaves out what has coordinates that are not finite.
  explicit OccluderFilter(const OccluderSet& set);

  // Those that turn a side that hides to the eye, and that may have at least this solid angle (steradians),
  // ascending: A h / r^3 bounds the solid angle, A being the area, h the eye's height over the plane, and r
  // the distance of the nearest point.
  void find(const Vec3d& eye, double min_solid_angle, std::vector<NearOccluder>& found) const;

 private:
  const OccluderSet& set_;
  std::vector<NearOccluder> all_;
};

}  // namespace sightline::comparison
