#pragma once

// Rays of a view in double precision. Written independently of the library's projection code, so that the two
// check each other.

#include <cstdint>

#include "sightline/scene/camera.h"
#include "src/scene/usable_view.h"

namespace sightline {

// A ray that starts on the near plane. dot(direction, view.forward) is 1, so the ray's parameter is the depth
// in metres beyond that plane.
struct ViewRay {
  Vec3d origin, direction;
};

// Depth along forward, metres.
inline double depthOf(const View& view, const Vec3d& point) {
  return dot(point - view.eye, view.forward);
}

// The ray through a point of the picture. x, y are in [-1, 1], from the left to the right and from the lower
// to the upper border.
inline ViewRay rayThrough(const View& view, double x, double y) {
  x += view.shift_x;
  y += view.shift_y;
  if (view.orthographic) {
    const double half = 0.5 * view.ortho_height;
    const Vec3d start = view.eye + view.right * (x * half * view.aspect) + view.up * (y * half);
    const Vec3d sight = scene::sightDirection(view);
    return {start + sight * (view.z_near - depthOf(view, start)), sight};
  }
  const Vec3d direction =
      view.forward + view.right * (x * view.tan_half_fovy * view.aspect) + view.up * (y * view.tan_half_fovy);
  return {view.eye + direction * view.z_near, direction};
}

// The ray through the centre of a pixel; rows count from the top.
inline ViewRay rayOfPixel(const View& view, std::uint32_t column, std::uint32_t row, std::uint32_t width,
                          std::uint32_t height) {
  const double x = (2.0 * column + 1.0) / width - 1.0;
  const double y = 1.0 - (2.0 * row + 1.0) / height;
  return rayThrough(view, x, y);
}

// The ray through a point in front of the eye.
inline ViewRay rayTo(const View& view, const Vec3d& point) {
  const double depth = depthOf(view, point);
  if (view.orthographic) {
    const Vec3d sight = scene::sightDirection(view);
    return {point - sight * (depth - view.z_near), sight};
  }
  const Vec3d direction = (point - view.eye) / depth;
  return {view.eye + direction * view.z_near, direction};
}

// True if the point is inside the view volume, enlarged by the relative slack; a negative slack shrinks the
// volume.
inline bool inVolume(const View& view, const Vec3d& point, double slack) {
  const Vec3d from_eye = point - view.eye;
  const double depth = dot(from_eye, view.forward);
  const double half_height = view.orthographic ? 0.5 * view.ortho_height : depth * view.tan_half_fovy;
  const double x = dot(from_eye, view.right) - view.shift_x * half_height * view.aspect;
  const double y = dot(from_eye, view.up) - view.shift_y * half_height;
  // Rounding grows with the distance from the forward axis.
  const double x_limit = half_height * (1.0 + slack * (1.0 + std::abs(view.shift_x))) * view.aspect;
  const double y_limit = half_height * (1.0 + slack * (1.0 + std::abs(view.shift_y)));
  return depth >= view.z_near * (1.0 - slack) && depth <= view.z_far * (1.0 + slack) &&
         std::abs(x) <= x_limit && std::abs(y) <= y_limit;
}

}  // namespace sightline
