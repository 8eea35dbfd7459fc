#pragma once

// Rays of a view, double precision. Written apart from the library's projection code, so that the two check
// each other.

#include <cstdint>

#include "sightline/scene/camera.h"

namespace sightline {

// Starts on the near plane; dot(direction, view.forward) is 1, so that the ray's parameter is metres beyond
// that plane.
struct ViewRay {
  Vec3d origin, direction;
};

// Metres along forward.
inline double depthOf(const View& view, const Vec3d& point) {
  return dot(point - view.eye, view.forward);
}

// x, y in [-1, 1]: from the left to the right, from the lower to the upper border.
inline ViewRay rayThrough(const View& view, double x, double y) {
  if (view.orthographic) {
    const double half = 0.5 * view.ortho_height;
    const Vec3d start = view.eye + view.right * (x * half * view.aspect) + view.up * (y * half);
    return {start + view.forward * view.near, view.forward};
  }
  const Vec3d direction =
      view.forward + view.right * (x * view.tan_half_fovy * view.aspect) + view.up * (y * view.tan_half_fovy);
  return {view.eye + direction * view.near, direction};
}

// Through the centre of a pixel; rows count from the top.
inline ViewRay rayOfPixel(const View& view, std::uint32_t column, std::uint32_t row, std::uint32_t width,
                          std::uint32_t height) {
  const double x = (2.0 * column + 1.0) / width - 1.0;
  const double y = 1.0 - (2.0 * row + 1.0) / height;
  return rayThrough(view, x, y);
}

// Through a point in front of the eye.
inline ViewRay rayTo(const View& view, const Vec3d& point) {
  const double depth = depthOf(view, point);
  if (view.orthographic) {
    return {point - view.forward * (depth - view.near), view.forward};
  }
  const Vec3d direction = (point - view.eye) / depth;
  return {view.eye + direction * view.near, direction};
}

// Inside the visible volume. slack: relative; negative: a little way inside.
inline bool inVolume(const View& view, const Vec3d& point, double slack) {
  const Vec3d from_eye = point - view.eye;
  const double depth = dot(from_eye, view.forward);
  const double half_height = view.orthographic ? 0.5 * view.ortho_height : depth * view.tan_half_fovy;
  const double limit = half_height * (1.0 + slack);
  return depth >= view.near * (1.0 - slack) && depth <= view.far * (1.0 + slack) &&
         std::abs(dot(from_eye, view.right)) <= limit * view.aspect &&
         std::abs(dot(from_eye, view.up)) <= limit;
}

}  // namespace sightline
