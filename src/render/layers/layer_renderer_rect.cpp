#include "src/render/layers/layer_renderer_rect.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "src/render/scene/scene_programs.h"

namespace sightline::render {
namespace {

// One pixel is added on each side of the exact borders, for the rounding of what OpenGL draws.
std::uint32_t borderBefore(double ndc, std::uint32_t pixels) {
  const double at = std::floor((ndc + 1.0) * 0.5 * pixels) - 1.0;
  return static_cast<std::uint32_t>(std::clamp(at, 0.0, 1.0 * pixels));
}
std::uint32_t borderAfter(double ndc, std::uint32_t pixels) {
  const double at = std::ceil((ndc + 1.0) * 0.5 * pixels) + 1.0;
  return static_cast<std::uint32_t>(std::clamp(at, 0.0, 1.0 * pixels));
}

}  // namespace

// The extent of projected points in normalised device coordinates. It becomes everything if one is NaN.
struct RectCollector::Extent {
  double left = std::numeric_limits<double>::infinity(), bottom = left, right = -left, top = -left;

  void add(const Mat4& clip, const Vec3d& relative) {
    const Vec3d projected = transformPoint(clip, relative);
    const double w = clip(3, 0) * relative.x + clip(3, 1) * relative.y + clip(3, 2) * relative.z + clip(3, 3);
    const double x = projected.x / w, y = projected.y / w;
    const bool number = !std::isnan(x) && !std::isnan(y);
    constexpr double kAll = 2.0;
    left = std::min(left, number ? x : -kAll);
    right = std::max(right, number ? x : kAll);
    bottom = std::min(bottom, number ? y : -kAll);
    top = std::max(top, number ? y : kAll);
  }
};

RectCollector::RectCollector(const View& view, const LensPoint& lens, std::uint32_t width,
                             std::uint32_t height)
    : clip_from_relative_(reversedClipFromRelative(view, lens)),
      eye_(view.eye + lensOffset(view, lens)),
      forward_(view.forward),
      near_(view.z_near),
      width_(width),
      height_(height) {}

// Adds the corners of the part of the box beyond the near plane: the box's own corners and the points where
// the plane cuts its edges.
void RectCollector::add(const Box& box, const Mat4& scene_from_box) {
  if (box.empty()) {
    return;
  }
  std::array<Vec3d, 8> corners;
  std::array<double, 8>
      beyond{};  // each corner's distance beyond the near plane in metres; NaN: not a valid box
  for (std::size_t i = 0; i < 8; ++i) {
    const Vec3d corner((i & 1) != 0 ? box.max.x : box.min.x, (i & 2) != 0 ? box.max.y : box.min.y,
                       (i & 4) != 0 ? box.max.z : box.min.z);
    corners[i] = transformPoint(scene_from_box, corner) - eye_;
    beyond[i] = dot(corners[i], forward_) - near_;
  }
  if (!std::all_of(beyond.begin(), beyond.end(), [](double b) { return std::isfinite(b); })) {
    rect_ = {0, 0, width_, height_};
    return;
  }
  Extent extent;
  for (std::size_t i = 0; i < 8; ++i) {
    if (beyond[i] >= 0.0) {
      extent.add(clip_from_relative_, corners[i]);
    }
    for (const std::size_t bit : {1u, 2u, 4u}) {
      const std::size_t j = i | bit;
      if (j != i && (beyond[i] < 0.0) != (beyond[j] < 0.0)) {
        const double t = beyond[i] / (beyond[i] - beyond[j]);
        extent.add(clip_from_relative_, corners[i] + (corners[j] - corners[i]) * t);
      }
    }
  }
  grow(extent);
}

void RectCollector::grow(const Extent& extent) {
  if (!(extent.left <= 1.0 && extent.right >= -1.0 && extent.bottom <= 1.0 && extent.top >= -1.0)) {
    return;
  }
  const PixelRect more{borderBefore(extent.left, width_), borderBefore(extent.bottom, height_),
                       borderAfter(extent.right, width_), borderAfter(extent.top, height_)};
  if (rect_.width() == 0 || rect_.height() == 0) {
    rect_ = more;
    return;
  }
  rect_ = {std::min(rect_.left, more.left), std::min(rect_.bottom, more.bottom),
           std::max(rect_.right, more.right), std::max(rect_.top, more.top)};
}

}  // namespace sightline::render
