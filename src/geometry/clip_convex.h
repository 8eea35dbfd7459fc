#pragma once

// Clipping of convex polygons, one half-space at a time (Sutherland, Hodgman 1974), and dividing them.

#include <cstddef>
#include <vector>

#include "sightline/math/vec3.h"

namespace sightline::geometry {

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

// What lies on each side of a plane that divides a convex polygon.
struct DividedPolygon {
  std::vector<Vec3d> front, behind;                    // corners in the plane are in both
  bool reaches_front = false, reaches_behind = false;  // whether any corner lies strictly there
};

// height(corner): affine, positive in front of the plane. crossing(p, q, height_p, height_q): the point of
// the plane between two corners on different sides.
template <typename Height, typename Crossing>
DividedPolygon divideConvex(const std::vector<Vec3d>& polygon, Height&& height, Crossing&& crossing) {
  DividedPolygon divided;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3d &p = polygon[i], &q = polygon[i + 1 < polygon.size() ? i + 1 : 0];
    const double height_p = height(p), height_q = height(q);
    divided.reaches_front = divided.reaches_front || height_p > 0.0;
    divided.reaches_behind = divided.reaches_behind || height_p < 0.0;
    if (height_p >= 0.0) {
      divided.front.push_back(p);
    }
    if (height_p <= 0.0) {
      divided.behind.push_back(p);
    }
    if ((height_p < 0.0 && height_q > 0.0) || (height_p > 0.0 && height_q < 0.0)) {
      divided.front.push_back(crossing(p, q, height_p, height_q));
      divided.behind.push_back(divided.front.back());
    }
  }
  return divided;
}

}  // namespace sightline::geometry
