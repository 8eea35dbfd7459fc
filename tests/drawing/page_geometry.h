#pragma once

// For tests: a view to draw; rings and polylines on a page, by plain loops over all edges.

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "sightline/drawing/drawing.h"

namespace sightline::test {

// A view from z = 10 along -z at the origin, for square pages, which show 10 m there.
inline View viewFromFront(bool orthographic = false) {
  View view;
  view.eye = {0, 0, 10};
  setOrientation(view, {0, 0, -1}, {0, 1, 0});
  view.orthographic = orthographic;
  view.tan_half_fovy = 0.5;
  view.ortho_height = 10.0;
  view.aspect = 1.0;
  view.z_near = 0.1;
  view.z_far = 100.0;
  return view;
}

inline double areaOf(const PagePath& ring) {
  double area = 0.0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const PagePoint &a = ring[i], &b = ring[(i + 1) % ring.size()];
    area += 0.5 * (a.x * b.y - a.y * b.x);
  }
  return area;
}

// Whether the point is inside the rings by the even-odd rule.
inline bool isInside(const std::vector<PagePath>& rings, const PagePoint& p) {
  bool inside = false;
  for (const PagePath& ring : rings) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const PagePoint &a = ring[i], &b = ring[(i + 1) % ring.size()];
      if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y)) {
        inside = !inside;
      }
    }
  }
  return inside;
}

inline double distanceToEdge(const PagePoint& a, const PagePoint& b, const PagePoint& p) {
  const double dx = b.x - a.x, dy = b.y - a.y, squared = dx * dx + dy * dy;
  const double along = (p.x - a.x) * dx + (p.y - a.y) * dy;
  const double t = squared > 0.0 ? std::clamp(along / squared, 0.0, 1.0) : 0.0;
  return std::hypot(p.x - a.x - t * dx, p.y - a.y - t * dy);
}

// The distance of a point from paths, which are rings (closed, without a repeated point) or polylines.
inline double distanceTo(const std::vector<PagePath>& paths, const PagePoint& p, bool rings) {
  double least = std::numeric_limits<double>::infinity();
  for (const PagePath& path : paths) {
    for (std::size_t i = 1; i < path.size(); ++i) {
      least = std::min(least, distanceToEdge(path[i - 1], path[i], p));
    }
    if (rings && !path.empty()) {
      least = std::min(least, distanceToEdge(path.back(), path.front(), p));
    }
  }
  return least;
}

inline double lengthOf(const PagePath& path) {
  double sum = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i) {
    sum += std::hypot(path[i].x - path[i - 1].x, path[i].y - path[i - 1].y);
  }
  return sum;
}

}  // namespace sightline::test
