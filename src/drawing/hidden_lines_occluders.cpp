#include "src/drawing/hidden_lines_occluders.h"

#include <algorithm>

#include "sightline/geometry/tolerance.h"

namespace sightline::drawing {
namespace {

// The box of the triangle's part beyond the near plane; HidingBox::none() if there is none.
HidingBox boxOnScreen(const HidingTriangle& triangle, const LineView& view) {
  HidingBox box = HidingBox::none();
  const double near = view.view().z_near;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3d& a = triangle.corners[i];
    const Vec3d& b = triangle.corners[(i + 1) % 3];
    if (a.z >= near) {
      box.extend(view.onScreen(a));
    }
    if ((a.z < near) != (b.z < near)) {
      Vec3d between = a + (b - a) * ((near - a.z) / (b.z - a.z));
      between.z = near;
      box.extend(view.onScreen(between));
    }
  }
  box.widen(view.view().orthographic ? triangle.reach : 1.0);
  return box;
}

bool onScreen(const HidingBox& box, const LineView& view) {
  const bool beside = box.min_x > view.right() || box.max_x < view.left() || box.min_y > view.top() ||
                      box.max_y < view.bottom();
  return !beside && box.reciprocal_depth >= view.onScreen({0.0, 0.0, view.view().z_far}).reciprocal_depth;
}

}  // namespace

void HidingTriangles::set(const SceneView& scene, const LineView& view) {
  triangles_.clear();
  trees_.clear();
  roots_.clear();
  const TriangleSides sides(view.view());
  for (const Object& object : scene.objects) {
    items_.clear();
    if (view.drawable() && scene.materialOf(object).opaque()) {
      addObject(scene, object, sides, view);
    }
    roots_.push_back(trees_.add(items_));
  }
}

void HidingTriangles::addObject(const SceneView& scene, const Object& object, const TriangleSides& sides,
                                const LineView& view) {
  const bool double_sided = scene.materialOf(object).double_sided;
  const std::span<const std::uint32_t> indices = scene.indicesOf(object);
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
    const int side = sides.seen(scene.positions[indices[i]], scene.positions[indices[i + 1]],
                                scene.positions[indices[i + 2]]);
    if (side > 0 || (side < 0 && double_sided)) {
      addTriangle(scene, indices.subspan(i, 3), view);
    }
  }
}

void HidingTriangles::addTriangle(const SceneView& scene, std::span<const std::uint32_t> corners,
                                  const LineView& view) {
  HidingTriangle triangle;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3f& position = scene.positions[corners[k]];
    triangle.corners[k] = view.cameraPoint(position);
    triangle.reach = std::max(triangle.reach, l1Norm(triangle.corners[k]));
    triangle.size = std::max(triangle.size, maxComponent(abs(Vec3d(position))));
  }
  if (!turnToEye(triangle, view.view().orthographic)) {
    return;
  }
  const HidingBox box = boxOnScreen(triangle, view);
  if (onScreen(box, view)) {
    items_.push_back({box, static_cast<std::uint32_t>(triangles_.size())});
    triangles_.push_back(triangle);
  }
}

}  // namespace sightline::drawing
