#include "oracle/image_space.h"

#include "src/math/longest_axis.h"
#include "src/scene/usable_view.h"

namespace sightline {
namespace {

const Whole& component(const WholeVec& v, int axis) {
  return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

}  // namespace

ImageSpace::ImageSpace(const View& view, std::span<const Vec3f> positions, int lowest_exponent,
                       std::span<const Vec3f> more)
    : view_(view),
      positions_(positions),
      more_(more),
      exponent_(std::min({lowest_exponent, lowestExponent(view.eye), 0})),
      direction_exponent_(lowestExponent(view.forward)),
      exact_eye_(wholeOf(view.eye, exponent_)),
      exact_forward_(wholeOf(view.forward, direction_exponent_)),
      right_(view.right),
      up_(view.up),
      forward_(view.forward) {
  if (!view.orthographic) {
    return;
  }
  sight_ = scene::sightDirection(view);
  direction_exponent_ = std::min(direction_exponent_, lowestExponent(sight_));
  exact_forward_ = wholeOf(view.forward, direction_exponent_);
  exact_sight_ = wholeOf(sight_, direction_exponent_);
  axis_ = math::longestAxis(abs(sight_));
  const double shift = std::max(std::abs(view.shift_x), std::abs(view.shift_y));
  const int size = std::ilogb(0.5 * view.ortho_height * std::max(view.aspect, 1.0) * (1.0 + shift));
  last_ = std::ldexp(sight_[axis_] > 0.0 ? 1.0 : -1.0, size);
  exponent_ = std::min(exponent_, size);
  exact_eye_ = wholeOf(view.eye, exponent_);
  const int i = (axis_ + 1) % 3, j = (axis_ + 2) % 3;
  right_ = Vec3d{view.right[i], view.right[j], 0.0} / sight_[axis_];
  up_ = Vec3d{view.up[i], view.up[j], 0.0} / sight_[axis_];
  forward_ = {0.0, 0.0, 1.0 / last_};
}

Vec3d ImageSpace::fromEye(std::uint32_t position) const {
  return this->position(position) - view_.eye;
}

// Projects along the lines of sight onto the plane across `axis_`, times sight_[axis_].
Vec3d ImageSpace::project(const Vec3d& from_eye, double last) const {
  const int i = (axis_ + 1) % 3, j = (axis_ + 2) % 3;
  const Vec3d& s = sight_;
  return {from_eye[i] * s[axis_] - from_eye[axis_] * s[i], from_eye[j] * s[axis_] - from_eye[axis_] * s[j],
          last};
}

// The same without rounding; all coordinates, the last one too, are times 2^-(exponent +
// direction_exponent_).
WholeVec ImageSpace::exactProject(const WholeVec& from_eye, int exponent) const {
  const int i = (axis_ + 1) % 3, j = (axis_ + 2) % 3;
  const Whole &s = component(exact_sight_, axis_), &depth = component(from_eye, axis_);
  const Whole last = wholeOf(last_, exponent + direction_exponent_);
  return {component(from_eye, i) * s - depth * component(exact_sight_, i),
          component(from_eye, j) * s - depth * component(exact_sight_, j), last};
}

RoundedVec ImageSpace::direction(std::uint32_t position) const {
  const Vec3d from_eye = fromEye(position);
  if (!view_.orthographic) {
    return {from_eye, kRounding * maxNorm(from_eye)};
  }
  return {project(from_eye, last_), 8.0 * kRounding * maxNorm(from_eye)};
}

RoundedVec ImageSpace::difference(std::uint32_t from, std::uint32_t to) const {
  const Vec3d d = position(to) - position(from);
  if (!view_.orthographic) {
    return {d, kRounding * maxNorm(d)};
  }
  return {project(d, 0.0), 8.0 * kRounding * maxNorm(d)};
}

WholeVec ImageSpace::exactDirection(std::uint32_t position) const {
  return exactDirectionOf(this->position(position));
}

double ImageSpace::weight(std::uint32_t position) const {
  return view_.orthographic ? -dot(fromEye(position), view_.forward) : 1.0;
}

double ImageSpace::weightError(std::uint32_t position) const {
  return view_.orthographic ? 16.0 * kRounding * maxNorm(fromEye(position)) : 0.0;
}

Whole ImageSpace::exactWeight(std::uint32_t position) const {
  if (!view_.orthographic) {
    return 1;
  }
  return -dot(wholeOf(this->position(position), exponent_) - exact_eye_, exact_forward_);
}

ImageSpace::ExactNearness ImageSpace::exactNearnessAt(double depth) const {
  if (view_.orthographic) {
    // Minus the depth, times the last coordinate of the direction over that coordinate in `exactProject`.
    // Both are in units of 2^(exponent_ + direction_exponent_), so the units cancel.
    const int exponent = std::min(lowestExponent(depth / last_), 0);
    return {{0, 0, -wholeOf(depth / last_, exponent)}, wholeOf(1.0, exponent)};
  }
  const int exponent = std::min(lowestExponent(depth), 0);
  // forward . d / depth. Directions are in units of 2^exponent_, and the viewing direction in units of
  // 2^direction_exponent_; the depth is brought to the product of both.
  const int unit = exponent_ + direction_exponent_;
  const int common = std::min(exponent, unit);
  return {exact_forward_ * (Whole(1) << static_cast<unsigned>(unit - common)), wholeOf(depth, common)};
}

WholeVec ImageSpace::exactDirectionOf(const Vec3d& point) const {
  const int exponent = std::min(exponent_, lowestExponent(point));
  WholeVec from_eye =
      wholeOf(point, exponent) - exact_eye_ * (Whole(1) << static_cast<unsigned>(exponent_ - exponent));
  return view_.orthographic ? exactProject(from_eye, exponent) : from_eye;
}

Vec3d ImageSpace::directionOf(const Vec3d& point) const {
  return view_.orthographic ? project(point - view_.eye, last_) : point - view_.eye;
}

ViewRay ImageSpace::lineOfSight(const Vec3d& direction) const {
  if (!view_.orthographic) {
    return {view_.eye, direction};
  }
  const double scale = last_ / (direction.z * sight_[axis_]);
  Vec3d across{};
  across[(axis_ + 1) % 3] = direction.x * scale;
  across[(axis_ + 2) % 3] = direction.y * scale;
  return {view_.eye + across - sight_ * dot(across, view_.forward), sight_};
}

ViewRay ImageSpace::ray(const Vec3d& direction) const {
  const Vec3d d = direction / dot(direction, forward_);
  return rayThrough(view_, dot(d, right_) / halfWidth() - view_.shift_x,
                    dot(d, up_) / halfHeight() - view_.shift_y);
}

}  // namespace sightline
