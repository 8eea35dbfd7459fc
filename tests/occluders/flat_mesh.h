#pragma once

// Scenes for tests of occluder extraction: triangulations of a plane, turned and moved into space.

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "sightline/occluders/occluder_set.h"
#include "tests/support/random_numbers.h"

namespace sightline::flat_mesh {

using test::Random;

struct Point2 {
  double x = 0.0, y = 0.0;
};

inline double crossAt(const Point2& a, const Point2& b, const Point2& p) {
  return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
}

// Distance of p from the inside of the line a -> b: positive to its left.
inline double leftOf(const Point2& a, const Point2& b, const Point2& p) {
  return crossAt(a, b, p) / std::hypot(b.x - a.x, b.y - a.y);
}

// Returns the distance from p to the nearest side of a convex, counter-clockwise polygon; negative outside.
inline double depthIn(std::span<const Point2> polygon, const Point2& p) {
  double depth = 1e300;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    depth = std::min(depth, leftOf(polygon[i], polygon[(i + 1) % polygon.size()], p));
  }
  return depth;
}

// Triangles of a plane, counter-clockwise, over shared points.
struct FlatMesh {
  std::vector<Point2> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;

  std::uint32_t add(const Point2& p) {
    points.push_back(p);
    return static_cast<std::uint32_t>(points.size() - 1);
  }
  // Corners counter-clockwise; cut along one diagonal or the other.
  void addQuad(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d, bool other_diagonal) {
    if (other_diagonal) {
      triangles.push_back({a, b, d});
      triangles.push_back({b, c, d});
    } else {
      triangles.push_back({a, b, c});
      triangles.push_back({a, c, d});
    }
  }
};

// The placement of a plane in space. x and y are orthonormal; the front faces cross(x, y).
struct Placement {
  Vec3d origin;
  Vec3d x{1, 0, 0}, y{0, 1, 0};

  Vec3f operator()(const Point2& p) const { return Vec3f(origin + x * p.x + y * p.y); }
  Point2 inverse(const Vec3f& p) const {
    const Vec3d d = Vec3d(p) - origin;
    return {dot(d, x), dot(d, y)};
  }
};

inline Placement anyPlacement(Random& random, double distance) {
  const Vec3d normal = normalized(random.point(1.0));
  const Vec3d x = normalized(cross(normal, random.point(1.0)));
  return {random.point(distance), x, cross(normal, x)};
}

inline MaterialId addMaterial(Scene& scene, Opacity opacity = Opacity::kOpaque, bool double_sided = false) {
  scene.materials.push_back({"", opacity, double_sided, {}});
  return MaterialId(scene.materials.size() - 1);
}

inline ObjectId addObject(Scene& scene, const FlatMesh& mesh, const Placement& place, MaterialId material,
                          OccluderMark mark = OccluderMark::kAutomatic) {
  const auto first = static_cast<std::uint32_t>(scene.positions.size());
  for (const Point2& p : mesh.points) {
    scene.positions.push_back(place(p));
  }
  Object object;
  object.first_index = static_cast<std::uint32_t>(scene.indices.size());
  object.index_count = static_cast<std::uint32_t>(3 * mesh.triangles.size());
  object.material = material;
  object.mark = mark;
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) {
      scene.indices.push_back(first + corner);
    }
  }
  scene.objects.push_back(object);
  scene.object_names.push_back("object " + std::to_string(scene.objects.size() - 1));
  updateBounds(scene);
  return ObjectId(scene.objects.size() - 1);
}

// One opaque object in a scene of its own.
inline Scene sceneOf(const FlatMesh& mesh, const Placement& place = {}, bool double_sided = false) {
  Scene scene;
  addObject(scene, mesh, place, addMaterial(scene, Opacity::kOpaque, double_sided));
  return scene;
}

inline FlatMesh rectangle(double x0, double y0, double x1, double y1) {
  FlatMesh mesh;
  const auto a = mesh.add({x0, y0}), b = mesh.add({x1, y0}), c = mesh.add({x1, y1}), d = mesh.add({x0, y1});
  mesh.addQuad(a, b, c, d, false);
  return mesh;
}

// A regular or irregular grid of quads; keep(column, row) says which of them are there.
template <typename Keep>
FlatMesh grid(const std::vector<double>& xs, const std::vector<double>& ys, Random& random, Keep keep) {
  FlatMesh mesh;
  const auto columns = static_cast<std::uint32_t>(xs.size());
  for (const double y : ys) {
    for (const double x : xs) {
      mesh.add({x, y});
    }
  }
  for (std::uint32_t row = 0; row + 1 < ys.size(); ++row) {
    for (std::uint32_t column = 0; column + 1 < columns; ++column) {
      const std::uint32_t a = row * columns + column;
      if (keep(column, row)) {
        mesh.addQuad(a, a + 1, a + 1 + columns, a + columns, random.below(2) == 0);
      }
    }
  }
  return mesh;
}

// Returns ascending numbers from 0 on, with random differences of at least 0.2.
inline std::vector<double> steps(Random& random, std::size_t count) {
  std::vector<double> at{0.0};
  while (at.size() <= count) {
    at.push_back(at.back() + random.in(0.2, 2.0));
  }
  return at;
}

inline std::vector<Point2> flattened(const OccluderSet& set, const Occluder& occluder,
                                     const Placement& place) {
  std::vector<Point2> polygon;
  for (const Vec3f& vertex : set.verticesOf(occluder)) {
    polygon.push_back(place.inverse(vertex));
  }
  return polygon;
}

inline double areaOf(std::span<const Point2> polygon) {
  double area = 0.0;
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    area += 0.5 * crossAt(polygon[0], polygon[i], polygon[i + 1]);
  }
  return area;
}

inline std::uint64_t reported(const OccluderReport& report) {
  return report.used + report.see_through + report.marked_never + report.degenerate + report.too_small;
}

inline constexpr OccluderSettings kKeepAll{.area_fraction = 1.0};

}  // namespace sightline::flat_mesh
