#pragma once

// The convex hull of points of a plane.
//
// Based on: Andrew. Another efficient algorithm for convex hulls in two dimensions. Information Processing
// Letters 1979.

#include <algorithm>
#include <cstddef>
#include <vector>

namespace sightline::geometry {

// The corners in order around the hull, counter-clockwise from the first point; none for a single point.
// points: at least one, and not several equal ones alone; ascending by x, then y. turns_left(a, b, c):
// whether c lies to the left of the line from a to b; corners where it does not are left out.
template <typename Point, typename TurnsLeft>
std::vector<Point> convexHull(std::vector<Point> points, TurnsLeft&& turns_left) {
  std::vector<Point> hull;
  for (int side = 0; side < 2; ++side) {
    const std::size_t first = hull.size();
    for (const Point& p : points) {
      while (hull.size() >= first + 2 && !turns_left(hull[hull.size() - 2], hull.back(), p)) {
        hull.pop_back();
      }
      hull.push_back(p);
    }
    hull.pop_back();  // it begins the other side
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

}  // namespace sightline::geometry
