#pragma once

#include <algorithm>
#include <cmath>

#include "sightline/occluders/occluder_set.h"

namespace sightline::occluders {

// The radius, in metres, of a sphere around the centroid that holds the polygon. Vertices with NaN are passed
// over; infinite ones make it infinite.
inline double radiusOf(const OccluderSet& set, const Occluder& occluder) {
  double squared = 0.0;
  for (const Vec3f& vertex : set.verticesOf(occluder)) {
    const Vec3d from_center = Vec3d(vertex) - Vec3d(occluder.centroid);
    squared = std::max(squared, dot(from_center, from_center));
  }
  return std::sqrt(squared);
}

}  // namespace sightline::occluders
