#pragma once

// Parts, views and the exact truth about their extents, for tests.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "sightline/scene/camera.h"
#include "src/layers/extents/extent_table.h"
#include "src/layers/pairs/part_store.h"
#include "tests/support/layer_shapes.h"

namespace sightline::layers::extent_tests {

struct ExtentScene {
  PartStore store;
  std::vector<shapes::Points> points;  // input points of each hull
  std::vector<std::uint8_t> moved, used;

  std::uint32_t addHull(const shapes::Points& of) {
    Result<ConvexHull> hull = buildHull(of);
    store.hulls.push_back(std::move(hull.value()));
    points.push_back(of);
    return static_cast<std::uint32_t>(points.size() - 1);
  }
  std::uint32_t addPart(std::span<const std::uint32_t> hulls, const Placement& placement) {
    store.part_hulls.insert(store.part_hulls.end(), hulls.begin(), hulls.end());
    store.first_hull.push_back(static_cast<std::uint32_t>(store.part_hulls.size()));
    store.placements.push_back(placement);
    store.finite.push_back(isFinite(placement) ? 1 : 0);
    moved.push_back(1);
    used.push_back(1);
    return static_cast<std::uint32_t>(moved.size() - 1);
  }
  std::uint32_t addPart(const shapes::Points& of, const Placement& placement = {}) {
    const std::uint32_t hull = addHull(of);
    return addPart(std::span(&hull, 1), placement);
  }
  void place(std::uint32_t part, const Placement& placement) {
    store.placements[part] = placement;
    store.finite[part] = isFinite(placement) ? 1 : 0;
    moved[part] = 1;
  }
  void rest() { std::fill(moved.begin(), moved.end(), std::uint8_t{0}); }
};

using Exact = Vec3<long double>;

inline Exact exactPoint(const Placement& p, const Vec3d& v) {
  return Exact(p.x) * static_cast<long double>(v.x) + Exact(p.y) * static_cast<long double>(v.y) +
         Exact(p.z) * static_cast<long double>(v.z) + Exact(p.origin);
}

// Returns all input points of a part in the world, relative to `from`, and random points between those of a
// hull.
inline std::vector<Exact> exactPoints(const ExtentScene& scene, std::uint32_t part, const Vec3d& from,
                                      shapes::Random* between = nullptr) {
  std::vector<Exact> all;
  for (const std::uint32_t hull : scene.store.hullsOf(part)) {
    const std::size_t first = all.size();
    for (const Vec3d& v : scene.points[hull]) {
      all.push_back(exactPoint(scene.store.placements[part], v) - Exact(from));
    }
    const auto count = static_cast<std::uint32_t>(all.size() - first);
    for (int i = 0; between != nullptr && i < 40; ++i) {
      const Exact a = all[first + between->below(count)], b = all[first + between->below(count)];
      const Exact c = all[first + between->below(count)];
      const long double s = between->number(0, 1), t = between->number(0, 1);
      all.push_back((a * s + b * (1 - s)) * t + c * (1 - t));
    }
  }
  return all;
}

inline Placement randomPlacement(shapes::Random& random, const Vec3d& origin, double size) {
  const shapes::Axes axes = shapes::randomAxes(random);
  return {axes.x * (size * random.number(0.5, 1.5)), axes.y * (size * random.number(0.5, 1.5)),
          axes.z * (size * random.number(0.5, 1.5)), origin};
}

inline View randomView(shapes::Random& random, const Vec3d& eye, bool orthographic) {
  View view;
  view.eye = eye;
  setOrientation(view, random.direction(), random.direction());
  view.orthographic = orthographic;
  return view;
}

inline View straightView(const Vec3d& eye, bool orthographic = false) {
  View view;
  view.eye = eye;
  view.right = {1, 0, 0};
  view.up = {0, 1, 0};
  view.forward = {0, 0, -1};
  view.orthographic = orthographic;
  return view;
}

}  // namespace sightline::layers::extent_tests
