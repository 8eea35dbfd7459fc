#pragma once

// A view as a pixel buffer uses it: camera space, and where points of camera space lie in the buffer.
//
// Camera space: x to the right, y upwards, z the depth along the viewing direction; metres, relative to the
// eye. Buffer space: pixels from the buffer's lower left corner, x to the right, y upwards; pixel (i, j) is
// the square from (i, j) to (i + 1, j + 1). A depth buffer stores reciprocal depth: 1 / depth in perspective
// and -depth in orthographic views. The greater value is the nearer one, and reciprocal depth is linear over
// the image of a plane.

#include <algorithm>
#include <cstdint>

#include "sightline/math/mat4.h"
#include "src/scene/usable_view.h"

namespace sightline {

struct PixelView {
  Vec3d eye;
  Vec3d right, up, forward;
  // The unit vectors of camera space in scene space: the view's axes, corrected for not being exactly
  // orthonormal. A caller's single-precision axes are off by enough to matter in a large buffer.
  Vec3d unit_x, unit_y, unit_z;
  bool orthographic = false;
  double frustum_near = 0.0, far = 0.0;
  // The near plane, or a depth beyond it that single precision can divide by. Geometry in front of it neither
  // hides nor has a rectangle in the buffer.
  double near = 0.0;
  double scale_x = 0.0,
         scale_y = 0.0;  // pixels per unit of x / z (perspective), per metre (orthographic)
  // Where the forward axis meets the buffer: in its middle, unless the view is off-centre; pixels.
  double middle_x = 0.0, middle_y = 0.0;
  double width = 0.0, height = 0.0;  // of the buffer, pixels

  PixelView() = default;
  PixelView(const View& given, std::uint32_t buffer_width, std::uint32_t buffer_height)
      : width(buffer_width), height(buffer_height) {
    View view = given;
    valid_ = makeUsable(view) == nullptr;
    eye = view.eye;
    right = view.right;
    up = view.up;
    forward = view.forward;
    orthographic = view.orthographic;
    frustum_near = view.near;
    far = view.far;
    near = std::max(view.near, 2.0 / kLargestScale);
    middle_x = 0.5 * width * (1.0 - view.shift_x);
    middle_y = 0.5 * height * (1.0 - view.shift_y);
    const double half_height = view.orthographic ? 0.5 * view.ortho_height : view.tan_half_fovy;
    scale_x = 0.5 * width / (half_height * view.aspect);
    scale_y = 0.5 * height / half_height;
    const Vec3d across = cross(up, forward);
    const double volume = dot(right, across);
    unit_x = across / volume;
    unit_y = cross(forward, right) / volume;
    unit_z = cross(right, up) / volume;
  }

  // True if all values are finite, and of magnitudes that neither overflow nor underflow in single precision.
  // With other views nothing can be decided: buffers stay empty, and boxes have no position in them.
  bool sane() const {
    constexpr double kLargestCoordinate = 0x1p60;
    const auto axis = [](const Vec3d& v) { return isFinite(v) && maxComponent(abs(v)) < 2.0; };
    const auto scale = [](double s) { return s < kLargestScale && s > 1.0 / kLargestScale; };
    return valid_ && axis(right) && axis(up) && axis(forward) && axis(unit_x) && axis(unit_y) &&
           axis(unit_z) && scale(scale_x) && scale(scale_y) && isFinite(eye) &&
           maxComponent(abs(eye)) < kLargestCoordinate && near < kLargestCoordinate && far > near;
  }
  // The view of geometry that is given in another space: a point p there has the image of scene_from_space p
  // here. Not sane() unless the matrix is a rotation and a translation, exact up to single precision, and the
  // places are near enough to the origin that double precision moves nothing by more than 2^-16 pixels.
  PixelView inSpace(const Mat4& scene_from_space) const {
    const auto column = [&](int i) {
      return Vec3d(scene_from_space(0, i), scene_from_space(1, i), scene_from_space(2, i));
    };
    const Vec3d x = column(0), y = column(1), z = column(2), origin = column(3);
    const auto unit = [](const Vec3d& v) { return std::abs(dot(v, v) - 1.0) < kRigid; };
    const double volume = dot(x, cross(y, z));
    PixelView moved = *this;
    const bool affine = scene_from_space(3, 0) == 0.0 && scene_from_space(3, 1) == 0.0 &&
                        scene_from_space(3, 2) == 0.0 && scene_from_space(3, 3) == 1.0;
    moved.valid_ = sane() && affine && isFinite(origin) && unit(x) && unit(y) && unit(z) &&
                   std::abs(dot(x, y)) < kRigid && std::abs(dot(y, z)) < kRigid &&
                   std::abs(dot(z, x)) < kRigid && volume > 0.0;
    if (!moved.valid_) {
      return moved;
    }
    const auto turned = [&](const Vec3d& axis) { return Vec3d(dot(x, axis), dot(y, axis), dot(z, axis)); };
    const auto back = [&](const Vec3d& v) {
      return Vec3d(dot(cross(y, z), v), dot(cross(z, x), v), dot(cross(x, y), v)) / volume;
    };
    moved.eye = back(eye - origin);
    moved.right = turned(right);
    moved.up = turned(up);
    moved.forward = turned(forward);
    moved.unit_x = back(unit_x);
    moved.unit_y = back(unit_y);
    moved.unit_z = back(unit_z);
    const auto size = [](const Vec3d& v) { return maxComponent(abs(v)); };
    const double rounding = 0x1p-46 * (size(eye) + size(origin) + size(moved.eye));
    moved.valid_ = rounding * std::max(scale_x, scale_y) < 0x1p-16 * (orthographic ? 1.0 : near);
    return moved;
  }
  // Transforms the normal of a plane.
  Vec3d normalToCamera(const Vec3d& n) const { return {dot(unit_x, n), dot(unit_y, n), dot(unit_z, n)}; }
  // Transforms a direction, or a point relative to the eye.
  Vec3d toCamera(const Vec3d& r) const { return {dot(right, r), dot(up, r), dot(forward, r)}; }
  // Factor from x and y in camera space to buffer space: 1 / z in perspective, 1 in orthographic views.
  double inverseDepth(const Vec3d& c) const { return orthographic ? 1.0 : 1.0 / c.z; }
  double pixelX(const Vec3d& c, double inverse_depth) const {
    return middle_x + scale_x * c.x * inverse_depth;
  }
  double pixelY(const Vec3d& c, double inverse_depth) const {
    return middle_y + scale_y * c.y * inverse_depth;
  }
  // Position in the buffer, pixels, of a point in camera space; in perspective views, z must be > 0.
  double pixelX(const Vec3d& c) const { return middle_x + scale_x * (orthographic ? c.x : c.x / c.z); }
  double pixelY(const Vec3d& c) const { return middle_y + scale_y * (orthographic ? c.y : c.y / c.z); }
  // Greatest distances in the buffer from where the forward axis meets it, pixels.
  double reachX() const { return std::max(middle_x, width - middle_x); }
  double reachY() const { return std::max(middle_y, height - middle_y); }
  double reciprocalDepth(double depth) const { return orthographic ? -depth : 1.0 / depth; }

 private:
  static constexpr double kLargestScale = 0x1p40;
  static constexpr double kRigid = 0x1p-20;  // of the products of the columns of a rotation
  bool valid_ = false;                       // makeUsable() found no fault in the view
};

}  // namespace sightline
