#include "sightline/scene/camera.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "src/scene/usable_view.h"

namespace sightline {

void setOrientation(View& view, const Vec3d& forward, const Vec3d& up_hint) {
  view.forward = normalized(forward);
  Vec3d right = cross(view.forward, normalized(up_hint));
  if (length(right) < 1e-9) {
    // The view direction is parallel to the hint, so any perpendicular direction is used.
    const Vec3d other = std::abs(view.forward.x) < 0.9 ? Vec3d(1, 0, 0) : Vec3d(0, 0, 1);
    right = cross(view.forward, other);
  }
  view.right = normalized(right);
  view.up = cross(view.right, view.forward);
}

Mat4 clipFromScene(const View& view) {
  Mat4 camera_from_scene;
  Vec3d axes[3] = {view.right, view.up, -view.forward};
  for (Vec3d& axis : axes) {
    makeUnit(axis);  // not makeUsable(): the picture of a left-handed view is mirrored
  }
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      camera_from_scene(row, column) = axes[row][column];
    }
    camera_from_scene(row, 3) = -dot(axes[row], view.eye);
  }
  Mat4 clip_from_camera;
  // Limits for far -> infinity: (far + near) / (far - near) -> 1, far / (far - near) -> 1.
  const bool endless = std::isinf(view.far);
  const double depth = view.far - view.near;
  const double middle = endless ? 1.0 : (view.far + view.near) / depth;
  if (view.orthographic) {
    const double half = view.ortho_height * 0.5;
    clip_from_camera(0, 0) = 1.0 / (half * view.aspect);
    clip_from_camera(1, 1) = 1.0 / half;
    clip_from_camera(2, 2) = -2.0 / depth;
    clip_from_camera(2, 3) = -middle;
  } else {
    clip_from_camera(0, 0) = 1.0 / (view.tan_half_fovy * view.aspect);
    clip_from_camera(1, 1) = 1.0 / view.tan_half_fovy;
    clip_from_camera(2, 2) = -middle;
    clip_from_camera(2, 3) = endless ? -2.0 * view.near : -2.0 * view.far * view.near / depth;
    clip_from_camera(3, 2) = -1.0;
    clip_from_camera(3, 3) = 0.0;
  }
  return clip_from_camera * camera_from_scene;
}

Frustum frustumOf(const View& given) {
  View view = given;
  Frustum frustum;
  if (makeUsable(view) != nullptr) {
    frustum.planes.fill({Vec3d(), 1.0});
    return frustum;
  }
  const auto through = [](const Vec3d& normal, const Vec3d& point) {
    const Vec3d unit = normalized(normal);
    return Plane{unit, -dot(unit, point)};
  };
  if (view.orthographic) {
    const Vec3d x = view.right * (view.ortho_height * 0.5 * view.aspect);
    const Vec3d y = view.up * (view.ortho_height * 0.5);
    frustum.planes[0] = through(view.right, view.eye - x);
    frustum.planes[1] = through(-view.right, view.eye + x);
    frustum.planes[2] = through(view.up, view.eye - y);
    frustum.planes[3] = through(-view.up, view.eye + y);
  } else {
    const Vec3d x = view.forward * (view.tan_half_fovy * view.aspect);
    const Vec3d y = view.forward * view.tan_half_fovy;
    frustum.planes[0] = through(view.right + x, view.eye);
    frustum.planes[1] = through(x - view.right, view.eye);
    frustum.planes[2] = through(view.up + y, view.eye);
    frustum.planes[3] = through(y - view.up, view.eye);
  }
  frustum.planes[4] = through(view.forward, view.eye + view.forward * view.near);
  // An infinite offset would make the plane NaN; this one is beyond all boxes.
  constexpr double kFarthest = 0x1p500;
  frustum.planes[5] = through(-view.forward, view.eye + view.forward * std::min(view.far, kFarthest));
  return frustum;
}

double nearDistance(const View& given) {
  View view = given;
  makeUsable(view);
  if (view.orthographic) {
    // The rays of an orthographic view start at any distance.
    return std::numeric_limits<double>::infinity();
  }
  // The corners of the near plane are at near * (forward +- x right +- y up). All four are measured, because
  // axes that are not quite perpendicular make their distances differ. The result is rounded up.
  const double y = view.tan_half_fovy;
  const double x = view.tan_half_fovy * view.aspect;
  double farthest = std::sqrt(1.0 + x * x + y * y);
  for (const double side : {-x, x}) {
    for (const double height : {-y, y}) {
      farthest = std::max(farthest, length(view.forward + view.right * side + view.up * height));
    }
  }
  return view.near * farthest * (1.0 + 0x1p-48);
}

View CameraPath::view(std::size_t frame, const Vec3d& scene_origin) const {
  View view;
  const CameraFrame& at = frames[frame];
  view.eye = at.eye - scene_origin;
  setOrientation(view, at.forward, at.up);
  view.orthographic = ortho_height > 0.0;
  view.ortho_height = ortho_height > 0.0 ? ortho_height : view.ortho_height;
  view.tan_half_fovy = std::tan(fovy_deg * std::numbers::pi / 360.0);
  view.aspect = static_cast<double>(width) / static_cast<double>(height);
  view.near = near;
  view.far = far;
  return view;
}

}  // namespace sightline
