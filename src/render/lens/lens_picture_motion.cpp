#include "src/render/lens/lens_picture_motion.h"

#include <cmath>
#include <cstddef>
#include <optional>

#include "src/scene/usable_view.h"

namespace sightline::render {
namespace {

Mat4 placeOf(std::span<const Mat4> transforms, std::size_t object) {
  return transforms.empty() ? Mat4{} : transforms[object];
}

// The point that an affine matrix maps to `to`; none if the matrix is singular.
std::optional<Vec3d> pointBefore(const Mat4& m, const Vec3d& to) {
  const double determinant = determinant3(m);
  const Vec3d x(m(0, 0), m(1, 0), m(2, 0)), y(m(0, 1), m(1, 1), m(2, 1)), z(m(0, 2), m(1, 2), m(2, 2));
  const Vec3d moved = to - Vec3d(m(0, 3), m(1, 3), m(2, 3));
  const Vec3d point =
      Vec3d(dot(moved, cross(y, z)), dot(x, cross(moved, z)), dot(x, cross(y, moved))) / determinant;
  return isFinite(point) ? std::optional(point) : std::nullopt;
}

Vec3d pointAt(const View& view, const SeenLayer& seen, const LayerImage& image) {
  const double right = 2.0 * seen.x / image.width - 1.0 + view.shift_x;
  const double up = 1.0 - 2.0 * seen.y / image.height + view.shift_y;
  const double half = view.orthographic ? 0.5 * view.ortho_height : seen.depth * view.tan_half_fovy;
  return view.eye + view.forward * seen.depth + view.right * (right * half * view.aspect) +
         view.up * (up * half);
}

// Where a point, or a direction taken as a point at infinity, is seen, in pixels.
std::optional<PixelStep> pixelOf(const View& view, const Vec3d& from_eye, const LayerImage& image) {
  const double depth = dot(from_eye, view.forward);
  if (!view.orthographic && !(depth > 0.0)) {
    return std::nullopt;
  }
  const double half = view.orthographic ? 0.5 * view.ortho_height : depth * view.tan_half_fovy;
  const double right = dot(from_eye, view.right) / (half * view.aspect) - view.shift_x;
  const double up = dot(from_eye, view.up) / half - view.shift_y;
  const PixelStep pixel{0.5 * image.width * (1.0 + right), 0.5 * image.height * (1.0 - up)};
  return std::isfinite(pixel.x) && std::isfinite(pixel.y) ? std::optional(pixel) : std::nullopt;
}

// The direction that the middle of the picture shows, in a perspective view.
Vec3d pictureMiddle(const View& view) {
  return view.forward + view.right * (view.shift_x * view.tan_half_fovy * view.aspect) +
         view.up * (view.shift_y * view.tan_half_fovy);
}

}  // namespace

View viewAt(const View& view, const View& later, double time) {
  const auto between = [time](const Vec3d& a, const Vec3d& b) { return a + (b - a) * time; };
  View result = view;
  result.eye = between(view.eye, later.eye);
  const Vec3d forward = between(view.forward, later.forward);
  if (dot(forward, view.forward) > 0.0) {
    setOrientation(result, forward, between(view.up, later.up));
    result.right = scene::isLeftHanded(view) ? -result.right : result.right;
  }
  return result;
}

void transformsAt(const Motion& motion, std::size_t objects, double time, std::vector<Mat4>& transforms) {
  transforms.resize(objects);
  for (std::size_t i = 0; i < objects; ++i) {
    const Mat4 now = placeOf(motion.stored, i), later = placeOf(motion.later_stored, i);
    for (std::size_t k = 0; k < now.m.size(); ++k) {
      transforms[i].m[k] = now.m[k] + (later.m[k] - now.m[k]) * time;
    }
  }
}

PixelStep layerStep(const View& view, const Motion& motion, std::span<const ObjectId> objects,
                    const SeenLayer& seen, const LayerImage& image) {
  const Vec3d here = pointAt(view, seen, image);
  Vec3d sum;
  double count = 0.0;
  for (const ObjectId object : objects) {
    if (const std::optional<Vec3d> stored = pointBefore(placeOf(motion.stored, object.value), here)) {
      sum += transformPoint(placeOf(motion.later_stored, object.value), *stored);
      count += 1.0;
    }
  }
  if (count == 0.0) {
    return {};
  }
  const std::optional<PixelStep> there = pixelOf(motion.later, sum / count - motion.later.eye, image);
  return there ? PixelStep{motion.shutter * (there->x - seen.x), motion.shutter * (there->y - seen.y)}
               : PixelStep{};
}

PixelStep skyStep(const View& view, const Motion& motion, const LayerImage& image) {
  if (view.orthographic) {
    return {};
  }
  const Vec3d middle = pictureMiddle(view);
  const std::optional<PixelStep> there = pixelOf(motion.later, middle, image);
  return there ? PixelStep{motion.shutter * (there->x - 0.5 * image.width),
                           motion.shutter * (there->y - 0.5 * image.height)}
               : PixelStep{};
}

}  // namespace sightline::render
