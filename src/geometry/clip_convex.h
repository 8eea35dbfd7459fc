#pragma once

// Clipping of convex polygons, one half-space at a time (Sutherland, Hodgman 1974).

#include <vector>

#include "sightline/math/vec3.h"

namespace sightline {

// Keeps the part where distance(position) >= 0; distance is an affine function. Corner has `Vec3d position`,
// and whatever else it has is taken to be of the edge that starts at it: the edge along the cut gets that of
// `cut`. scratch: any vector. False: nothing is left, and the polygon is empty.
template <typename Corner, typename Distance>
bool clipConvex(std::vector<Corner>& polygon, std::vector<Corner>& scratch, const Corner& cut,
                Distance&& distance) {
  scratch.clear();
  const std::size_t count = polygon.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Corner& a = polygon[i];
    const Corner& b = polygon[i + 1 < count ? i + 1 : 0];
    const double da = distance(a.position), db = distance(b.position);
    const bool a_in = da >= 0.0, b_in = db >= 0.0;
    if (a_in) {
      scratch.push_back(a);
    }
    if (a_in != b_in) {
      Corner crossing = a_in ? cut : a;
      crossing.position = a.position + (b.position - a.position) * (da / (da - db));
      scratch.push_back(crossing);
    }
  }
  if (scratch.size() < 3) {
    scratch.clear();
  }
  polygon.swap(scratch);
  return !polygon.empty();
}

}  // namespace sightline
