#include "sightline/scene/camera.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "src/scene/usable_view.h"

namespace sightline {
namespace {

// Above this cosine between right and forward, a few roundings, right is made perpendicular once more. Where
// the hint is more than 7 degrees off the direction, or along an axis of space, the cross product is that
// good by itself.
constexpr double kPerpendicular = 0x1p-50;

// Unit vector of any but the zero vector, which stays zero. Squares of the longest and of the shortest
// vectors are beyond double precision, so these are scaled before.
Vec3d unitOf(const Vec3d& direction) {
  const double largest = maxComponent(abs(direction));
  const bool ordinary = largest > 0x1p-400 && largest < 0x1p400;
  return normalized(ordinary || !(largest > 0.0) ? direction : direction / largest);
}

}  // namespace

void setOrientation(View& view, const Vec3d& forward, const Vec3d& up_hint) {
  view.forward = unitOf(forward);
  Vec3d right = cross(view.forward, unitOf(up_hint));
  if (length(right) < 1e-9) {
    // The view direction is parallel to the hint, so any perpendicular direction is used.
    const Vec3d other = std::abs(view.forward.x) < 0.9 ? Vec3d(1, 0, 0) : Vec3d(0, 0, 1);
    right = cross(view.forward, other);
  }
  view.right = normalized(right);
  // The nearer the direction is to the hint, the more digits of the cross product have cancelled out.
  if (const double cosine = dot(view.right, view.forward); std::abs(cosine) > kPerpendicular) {
    view.right = normalized(view.right - view.forward * cosine);
  }
  view.up = cross(view.right, view.forward);
}

Mat4 clipFromScene(const View& view) {
  Mat4 view_from_scene;
  const View unit = scene::withUnitAxes(view);  // not makeUsable(): a left-handed view's picture is mirrored
  const Vec3d axes[3] = {unit.right, unit.up, -unit.forward};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      view_from_scene(row, column) = axes[row][column];
    }
    view_from_scene(row, 3) = -dot(axes[row], view.eye);
  }
  Mat4 clip_from_view;
  // Limits for far -> infinity: (far + near) / (far - near) -> 1, far / (far - near) -> 1. In doubles, they
  // are reached at this ratio.
  const bool endless = view.z_near <= 0x1p-60 * view.z_far;
  const double depth = view.z_far - view.z_near;
  const double middle = endless ? 1.0 : (view.z_far + view.z_near) / depth;
  if (view.orthographic) {
    const double half = view.ortho_height * 0.5;
    clip_from_view(0, 0) = 1.0 / (half * view.aspect);
    clip_from_view(1, 1) = 1.0 / half;
    clip_from_view(0, 3) = -view.shift_x;
    clip_from_view(1, 3) = -view.shift_y;
    clip_from_view(2, 2) = -2.0 / depth;
    clip_from_view(2, 3) = -middle;
  } else {
    clip_from_view(0, 0) = 1.0 / (view.tan_half_fovy * view.aspect);
    clip_from_view(1, 1) = 1.0 / view.tan_half_fovy;
    clip_from_view(0, 2) = view.shift_x;
    clip_from_view(1, 2) = view.shift_y;
    clip_from_view(2, 2) = -middle;
    clip_from_view(2, 3) = -2.0 * view.z_near * (endless ? 1.0 : view.z_far / depth);
    clip_from_view(3, 2) = -1.0;
    clip_from_view(3, 3) = 0.0;
  }
  return clip_from_view * view_from_scene;
}

Frustum frustumOf(const View& given) {
  View view = given;
  Frustum frustum;
  if (scene::makeUsable(view) != nullptr) {
    frustum.planes.fill({Vec3d(), 1.0});
    return frustum;
  }
  // Bounds the points p with dot(normal, p - eye) >= distance. The axes are unit vectors to single precision
  // only, so the plane's own distance from the eye is another one. Moved outwards by more than the offset is
  // rounded, and the normal as far as the eye's coordinates reach.
  const auto beyond = [&view](const Vec3d& normal, double distance) {
    const double scale = 1.0 / length(normal);
    const Vec3d unit = normal * scale, size = abs(view.eye);
    const double from_eye = distance * scale;
    return Plane{unit,
                 -dot(unit, view.eye) - from_eye + 0x1p-48 * (size.x + size.y + size.z + std::abs(from_eye))};
  };
  // From the forward axis to the borders: tangents of angles, or metres in an orthographic view.
  const double half_height = view.orthographic ? view.ortho_height * 0.5 : view.tan_half_fovy;
  const double half_width = half_height * view.aspect;
  const double left = half_width * (1.0 - view.shift_x), right = half_width * (1.0 + view.shift_x);
  const double down = half_height * (1.0 - view.shift_y), up = half_height * (1.0 + view.shift_y);
  if (view.orthographic) {
    frustum.planes[0] = beyond(view.right, -left);
    frustum.planes[1] = beyond(-view.right, -right);
    frustum.planes[2] = beyond(view.up, -down);
    frustum.planes[3] = beyond(-view.up, -up);
  } else {
    frustum.planes[0] = beyond(view.right + view.forward * left, 0.0);
    frustum.planes[1] = beyond(view.forward * right - view.right, 0.0);
    frustum.planes[2] = beyond(view.up + view.forward * down, 0.0);
    frustum.planes[3] = beyond(view.forward * up - view.up, 0.0);
  }
  frustum.planes[4] = beyond(view.forward, view.z_near);
  // An infinite offset would make the plane NaN. This one is beyond all boxes, wherever the eye is.
  constexpr double kBeyondBoxes = 0x1p500;
  frustum.planes[5] = view.z_far < kBeyondBoxes ? beyond(-view.forward, -view.z_far)
                                                : Plane{-normalized(view.forward), kBeyondBoxes};
  return frustum;
}

double nearDistance(const View& given) {
  View view = given;
  // The rays of an orthographic view start at any distance, and nothing is known of those of an invalid one.
  if (scene::makeUsable(view) != nullptr || view.orthographic) {
    return std::numeric_limits<double>::infinity();
  }
  // The corners of the near plane are the points q from the eye with dot(forward, q) = near, dot(right, q) =
  // near * x and dot(up, q) = near * y. Where axes are not quite unit vectors, or not quite perpendicular,
  // that is not near * (forward + x right + y up), and the four distances differ. The result is rounded up.
  const Vec3d along_x = cross(view.up, view.forward), along_y = cross(view.forward, view.right);
  const Vec3d ahead = cross(view.right, view.up);
  const double volume = dot(view.right, along_x);
  const double half_width = view.tan_half_fovy * view.aspect, half_height = view.tan_half_fovy;
  double farthest = 0.0;
  for (const double side : {half_width * (view.shift_x - 1.0), half_width * (view.shift_x + 1.0)}) {
    for (const double height : {half_height * (view.shift_y - 1.0), half_height * (view.shift_y + 1.0)}) {
      farthest = std::max(farthest, length(ahead + along_x * side + along_y * height) / std::abs(volume));
    }
  }
  return view.z_near * farthest * (1.0 + 0x1p-48);
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
  view.shift_x = shift_x;
  view.shift_y = shift_y;
  view.z_near = z_near;
  view.z_far = z_far;
  return view;
}

}  // namespace sightline
