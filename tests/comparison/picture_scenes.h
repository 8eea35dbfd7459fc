#pragma once

// Scenes of a few polygons and boxes for tests of pictures of occluders.

#include <deque>
#include <vector>

#include "sightline/hierarchy/hierarchy.h"
#include "tests/occluders/flat_mesh.h"

namespace sightline::picture_scenes {

using flat_mesh::Random;

// Occluders do not belong to the boxes. Call finish() when all are added.
struct Model {
  std::deque<std::vector<Vec3f>> corners;
  std::vector<OccluderPolygon> polygons;
  std::vector<Box> boxes;
  std::vector<std::uint32_t> triangles;  // by box
  OccluderSet set;
  Hierarchy hierarchy;

  void addPolygon(std::vector<Vec3f> vertices, bool double_sided = false) {
    corners.push_back(std::move(vertices));
    polygons.push_back({corners.back(), double_sided});
  }
  // Faces +z.
  void addRectangle(double left, double right, double low, double high, double z) {
    std::vector<Vec3f> vertices;
    for (const auto& [x, y] : {std::pair(left, low), {right, low}, {right, high}, {left, high}}) {
      vertices.emplace_back(Vec3d(x, y, z));
    }
    addPolygon(vertices);
  }
  void addBox(const Vec3f& low, const Vec3f& high, std::uint32_t count = 100) {
    boxes.push_back({low, high});
    triangles.push_back(count);
  }
  void finish() {
    set = makeOccluders(polygons);
    hierarchy = buildHierarchy(boxes, triangles, {.max_leaf_objects = 1});
  }
};

// Triangles and quadrilaterals around the origin, of half edges up to `largest`, and boxes farther out.
inline Model randomModel(Random& random, std::uint32_t polygons, std::uint32_t boxes, double largest = 9.0) {
  Model model;
  for (std::uint32_t i = 0; i < polygons; ++i) {
    const Vec3d middle = normalized(random.point(1.0)) * random.in(2.0, 8.0);
    const Vec3d normal = normalized(random.point(1.0) - middle * 0.3);
    const Vec3d x = normalized(cross(normal, random.point(1.0))), y = cross(normal, x);
    const double w = random.in(1.0, largest), h = random.in(1.0, largest);
    std::vector<Vec3f> vertices = {Vec3f(middle - x * w - y * h), Vec3f(middle + x * w - y * h),
                                   Vec3f(middle + x * w + y * h)};
    if (random.below(2) == 0) {
      vertices.emplace_back(middle - x * w + y * h);
    }
    model.addPolygon(std::move(vertices), random.below(2) == 0);
  }
  for (std::uint32_t i = 0; i < boxes; ++i) {
    const Vec3d at = normalized(random.point(1.0)) * random.in(4.0, 25.0);
    const Vec3d size = {random.in(0.0, 3.0), random.in(0.0, 3.0), random.in(0.0, 3.0)};
    model.addBox(Vec3f(at), Vec3f(at + size));
  }
  model.finish();
  return model;
}

}  // namespace sightline::picture_scenes
