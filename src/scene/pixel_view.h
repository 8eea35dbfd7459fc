#pragma once

// A view as a pixel buffer uses it: camera space, and where points of camera space lie in the buffer.
//
// Camera space: x to the right, y upwards, z the depth along the viewing direction; relative to the eye, in
// metres unless PixelView::metres says otherwise. Buffer space: pixels from the buffer's lower left corner, x
// to the right, y upwards; pixel (i, j) is the square from (i, j) to (i + 1, j + 1). A depth buffer stores
// reciprocal depth: 1 / depth in perspective and -depth in orthographic views. The greater value is the
// nearer one, and reciprocal depth is linear over the image of a plane.

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "sightline/math/mat4.h"
#include "sightline/scene/viewer_region.h"
#include "src/scene/usable_view.h"

namespace sightline::scene {

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
  // Viewers for whom the buffer is drawn; offsets in camera space.
  ViewerRegion viewers{};
  // Other than 1 only for geometry in a space of its own, see inSpace().
  double metres = 1.0;    // the length of camera space's unit, a power of two
  double stretch = 1.0;   // unit_x, unit_y and unit_z are at most so long
  bool mirrored = false;  // triangles that are counter-clockwise in that space appear clockwise
  // How far rounding may have moved that space along the view, in camera space; in perspective less than
  // 2^-22 times the near distance.
  double depth_rounding = 0.0;

  PixelView() = default;
  // region: of the same viewers in scene space.
  PixelView(const View& given, std::uint32_t buffer_width, std::uint32_t buffer_height,
            const ViewerRegion& region = {})
      : width(buffer_width), height(buffer_height) {
    View view = given;
    valid_ = makeUsable(view) == nullptr;
    eye = view.eye;
    right = view.right;
    up = view.up;
    forward = view.forward;
    orthographic = view.orthographic;
    frustum_near = view.z_near;
    far = view.z_far;
    near = std::max(view.z_near, 2.0 / kLargestScale);
    middle_x = 0.5 * width * (1.0 - view.shift_x);
    middle_y = 0.5 * height * (1.0 - view.shift_y);
    const double half_height = view.orthographic ? 0.5 * view.ortho_height : view.tan_half_fovy;
    scale_x = 0.5 * width / (half_height * view.aspect);
    scale_y = 0.5 * height / half_height;
    const Vec3d across = cross(up, forward);
    const double volume = dot(right, across);
    unit_x = across / volume;
    unit_y = cross(forward, right) / volume;
    unit_z = cross(right, up) / volume;  // sightDirection(), but for 2^-48
    viewers = region;
    for (Vec3d& offset : viewers.offsets) {
      offset = toCamera(offset);
    }
  }

  // True if all values are finite, and of magnitudes that neither overflow nor underflow in single precision.
  // With other views nothing can be decided: buffers stay empty, and boxes have no position in them.
  bool sane() const {
    constexpr double kLargestCoordinate = 0x1p60;
    const auto axis = [](const Vec3d& v, double size) {
      return isFinite(v) && maxComponent(abs(v)) < 2.0 * size;
    };
    const auto scale = [](double s) { return s < kLargestScale && s > 1.0 / kLargestScale; };
    return valid_ && sane(viewers) && axis(right, 1.0) && axis(up, 1.0) && axis(forward, 1.0) &&
           axis(unit_x, stretch) && axis(unit_y, stretch) && axis(unit_z, stretch) && scale(scale_x) &&
           scale(scale_y) && isFinite(eye) && maxComponent(abs(eye)) < kLargestCoordinate &&
           near < kLargestCoordinate && far > near;
  }
  // The view of geometry that is given in another space: a point p there has the image of scene_from_space p
  // here. Camera space is then so scaled that no vector of that space becomes longer in it. Not sane() unless
  // the matrix is affine and stretches no direction more than kLargestStretch times as much as another, and
  // the places are near enough to the origin that double precision moves nothing by more than 2^-16 pixels,
  // and in perspective no depth by more than 2^-22 times the near distance.
  PixelView inSpace(const Mat4& scene_from_space) const {
    const auto column = [&](int i) {
      return Vec3d(scene_from_space(0, i), scene_from_space(1, i), scene_from_space(2, i));
    };
    const bool affine = scene_from_space(3, 0) == 0.0 && scene_from_space(3, 1) == 0.0 &&
                        scene_from_space(3, 2) == 0.0 && scene_from_space(3, 3) == 1.0;
    PixelView moved = *this;
    moved.metres = unitFor(column(0), column(1), column(2));
    const Vec3d x = column(0) / moved.metres, y = column(1) / moved.metres, z = column(2) / moved.metres,
                origin = column(3);
    const double volume = dot(x, cross(y, z));
    const Vec3d back_x = cross(y, z) / volume, back_y = cross(z, x) / volume, back_z = cross(x, y) / volume;
    moved.stretch = std::sqrt(dot(back_x, back_x) + dot(back_y, back_y) + dot(back_z, back_z));
    moved.mirrored = volume < 0.0;
    moved.valid_ =
        sane() && affine && isFinite(origin) && moved.metres > 0.0 && moved.stretch < kLargestStretch;
    if (!moved.valid_) {
      return moved;
    }
    const auto turned = [&](const Vec3d& axis) { return Vec3d(dot(x, axis), dot(y, axis), dot(z, axis)); };
    const auto back = [&](const Vec3d& v) { return Vec3d(dot(back_x, v), dot(back_y, v), dot(back_z, v)); };
    moved.eye = back((eye - origin) / moved.metres);
    moved.right = turned(right);
    moved.up = turned(up);
    moved.forward = turned(forward);
    moved.unit_x = back(unit_x);
    moved.unit_y = back(unit_y);
    moved.unit_z = back(unit_z);
    moved.frustum_near = frustum_near / moved.metres;
    moved.near = near / moved.metres;
    moved.far = far / moved.metres;
    for (Vec3d& offset : moved.viewers.offsets) {
      offset = offset / moved.metres;
    }
    moved.viewers.radius = viewers.radius / moved.metres;
    moved.viewers.near_distance = viewers.near_distance / moved.metres;
    if (orthographic) {
      moved.scale_x = scale_x * moved.metres;
      moved.scale_y = scale_y * moved.metres;
    }
    const auto size = [](const Vec3d& v) { return maxComponent(abs(v)); };
    const double rounding =
        0x1p-46 * (size(eye) + size(origin) + moved.metres * moved.stretch * size(moved.eye));
    moved.depth_rounding = rounding / moved.metres;
    // In a buffer of few pixels the depth is what moves most.
    moved.valid_ = rounding * std::max(scale_x, scale_y) < 0x1p-16 * (orthographic ? 1.0 : near) &&
                   (orthographic || rounding < 0x1p-22 * near);
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
  // depth: in camera space.
  double reciprocalDepth(double depth) const {
    return orthographic ? -(depth * metres) : 1.0 / (depth * metres);
  }

 private:
  static constexpr double kLargestScale = 0x1p40;
  static constexpr double kLargestStretch = 0x1p12;

  // A region of several viewers needs a perspective view: lines of sight then begin at them.
  bool sane(const ViewerRegion& region) const {
    const double size = maxComponent(max(abs(region.offsets[0]), abs(region.offsets[1])));
    return !region.several() ||
           (!orthographic && size < kLargestScale && region.radius >= 0.0 && region.radius < kLargestScale &&
            region.near_distance >= 0.0 && region.near_distance < kLargestScale);
  }

  // 1 for the columns of a rotation, exact up to single precision; otherwise a power of two that no unit
  // vector is stretched beyond. Not positive if there is none.
  static double unitFor(const Vec3d& x, const Vec3d& y, const Vec3d& z) {
    constexpr double kRigid = 0x1p-20, kLargest = 0x1p100;
    const double squares = dot(x, x) + dot(y, y) + dot(z, z);
    const auto unit = [](const Vec3d& v) { return std::abs(dot(v, v) - 1.0) < kRigid; };
    if (unit(x) && unit(y) && unit(z) && std::abs(dot(x, y)) < kRigid && std::abs(dot(y, z)) < kRigid &&
        std::abs(dot(z, x)) < kRigid) {
      return 1.0;
    }
    return squares < kLargest && squares > 1.0 / kLargest
               ? std::ldexp(1.0, std::ilogb(std::sqrt(squares)) + 1)
               : 0.0;
  }

  bool valid_ = false;  // makeUsable() found no fault in the view
};

}  // namespace sightline::scene
