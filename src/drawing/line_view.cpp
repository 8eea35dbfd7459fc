#include "src/drawing/line_view.h"

#include <algorithm>
#include <cmath>

#include "src/scene/usable_view.h"

namespace sightline::drawing {
namespace {

// Sizes are in page units. On larger pages doubles do not hold thousandths of a unit.
constexpr double kLargestPage = 1e15;
constexpr double kSmallestPage = 1e-15;
// Metres: in perspective, nothing nearer is drawn, for pictures and reciprocal depths grow without bounds
// towards the eye. A metre from the origin, coordinates of single precision are 2^-24 m apart.
constexpr double kNearest = 0x1p-40;

bool isSize(double value) {
  return std::isfinite(value) && value > 0.0;
}

bool isShift(double value) {
  return std::abs(value) <= View::kMaxShift;
}

bool isPageSide(double value) {
  return value >= kSmallestPage && value <= kLargestPage;
}

bool hasDirections(View view) {
  return scene::makeAxesUnit(view);
}

double nearOf(const View& view) {
  return view.orthographic ? view.z_near : std::max(view.z_near, kNearest);
}

}  // namespace

bool isDrawable(const View& view, double page_height) {
  const double opening = view.orthographic ? view.ortho_height : view.tan_half_fovy;
  return isPageSide(page_height) && isPageSide(page_height * view.aspect) && isSize(view.aspect) &&
         isSize(opening) && isSize(opening * view.aspect) && isSize(page_height / opening) &&
         std::isfinite(view.z_near) && view.z_near >= 0.0 && nearOf(view) < view.z_far &&
         isShift(view.shift_x) && isShift(view.shift_y) && isFinite(view.eye) && hasDirections(view);
}

bool narrow(double at_0, double at_1, double& from, double& to) {
  if (at_0 >= 0.0 && at_1 >= 0.0) {
    return true;
  }
  if (!(at_0 >= 0.0 || at_1 >= 0.0)) {
    return false;
  }
  const double zero = at_0 / (at_0 - at_1);
  if (at_0 < 0.0) {
    from = std::max(from, zero);
  } else {
    to = std::min(to, zero);
  }
  return from <= to;
}

LineView::LineView(const View& view, double page_height)
    : view_(view), drawable_(isDrawable(view, page_height)) {
  // The basis may be left-handed: the picture is mirrored then.
  scene::makeAxesUnit(view_);
  view_.z_near = nearOf(view);
  const double half_height = view.orthographic ? 0.5 * view.ortho_height : view.tan_half_fovy;
  const double half_width = half_height * view.aspect;
  left_ = half_width * (view.shift_x - 1.0);
  right_ = half_width * (view.shift_x + 1.0);
  bottom_ = half_height * (view.shift_y - 1.0);
  top_ = half_height * (view.shift_y + 1.0);
  page_scale_ = page_height / (2.0 * half_height);
}

Vec3d LineView::cameraPoint(const Vec3f& position) const {
  const Vec3d p = Vec3d(position) - view_.eye;
  return {dot(p, view_.right), dot(p, view_.up), dot(p, view_.forward)};
}

ScreenPoint LineView::onScreen(const Vec3d& camera) const {
  if (view_.orthographic) {
    return {camera.x, camera.y, -camera.z};
  }
  return {camera.x / camera.z, camera.y / camera.z, 1.0 / camera.z};
}

double LineView::pageX(double screen_x) const {
  return std::clamp((screen_x - left_) * page_scale_, 0.0, (right_ - left_) * page_scale_);
}

double LineView::pageY(double screen_y) const {
  return std::clamp((top_ - screen_y) * page_scale_, 0.0, (top_ - bottom_) * page_scale_);
}

bool LineView::clip(const Vec3d& a, const Vec3d& b, double& from, double& to) const {
  from = 0.0;
  to = 1.0;
  const double scale_a = view_.orthographic ? 1.0 : a.z;
  const double scale_b = view_.orthographic ? 1.0 : b.z;
  return drawable_ && narrow(a.z - view_.z_near, b.z - view_.z_near, from, to) &&
         narrow(view_.z_far - a.z, view_.z_far - b.z, from, to) &&
         narrow(a.x - left_ * scale_a, b.x - left_ * scale_b, from, to) &&
         narrow(right_ * scale_a - a.x, right_ * scale_b - b.x, from, to) &&
         narrow(a.y - bottom_ * scale_a, b.y - bottom_ * scale_b, from, to) &&
         narrow(top_ * scale_a - a.y, top_ * scale_b - b.y, from, to);
}

}  // namespace sightline::drawing
