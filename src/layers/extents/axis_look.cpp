#include "src/layers/extents/axis_look.h"

#include <limits>

#include "src/layers/extents/round_outwards.h"

namespace sightline::layers {
namespace {

using Kind = ExtentAxis::Kind;
using Frame = ExtentAxis::Frame;
using Measure = AxisLook::Measure;

// Sine of an angle above the rounding error of directions of unit length.
constexpr double kAcross = 0x1p-40;
// If the component across the view is shorter than this, another direction is used.
constexpr double kShort = 0.25;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr Interval kEmpty{kInfinity, -kInfinity};
constexpr Interval kEndless{-kInfinity, kInfinity};

Vec3d unit(const Vec3d& v) {
  const double largest = maxComponent(abs(v));
  return largest > 0.0 ? normalized(v / largest) : v;
}

Vec3d inWorld(const Vec3d& direction, Frame frame, const View& view) {
  return frame == Frame::kWorld
             ? direction
             : view.right * direction.x + view.up * direction.y + view.forward * direction.z;
}

// The component across the rays of an orthographic view, perpendicular to them up to 2^-50.
Vec3d across(const Vec3d& direction, const View& view) {
  const double squared = dot(view.forward, view.forward);
  return direction - view.forward * (dot(direction, view.forward) / squared);
}

bool finiteView(const View& view) {
  return isFinite(view.eye) && isFinite(view.right) && isFinite(view.up) && isFinite(view.forward) &&
         dot(view.forward, view.forward) > 0.0;
}

// Tests the products, not only their sum, so that the rays are exactly perpendicular.
bool exactlyAcross(const Vec3d& direction, const Vec3d& ray) {
  return direction.x * ray.x == 0.0 && direction.y * ray.y == 0.0 && direction.z * ray.z == 0.0;
}

AxisLook positions(AxisLook look, const View& view) {
  look.measure = Measure::kHeights;
  const Vec3d along_direction = across(look.direction, view), along_zero = across(look.zero, view);
  look.direction = length(along_direction) >= kShort ? along_direction : along_zero;
  look.zero = {};
  look.across = true;
  if (!(length(look.direction) >= kShort)) {
    look.measure = Measure::kNothing;
  }
  return look;
}

}  // namespace

ExtentAxis normalizedAxis(const ExtentAxis& axis) {
  ExtentAxis unit_axis = axis;
  unit_axis.zero = axis.kind == Kind::kAngular ? unit(axis.zero) : Vec3d();
  const Vec3d direction = unit(axis.direction);
  const Vec3d residue = direction - unit_axis.zero * dot(direction, unit_axis.zero);
  // A direction parallel to `zero` up to rounding spans no plane and becomes zero.
  unit_axis.direction = length(residue) > kAcross ? unit(residue) : Vec3d();
  return unit_axis;
}

AxisLook lookAlong(const ExtentAxis& axis, const View& view, const Vec3d& reference) {
  if (!finiteView(view)) {
    return AxisLook{.measure = Measure::kNothing};
  }
  AxisLook look;
  const bool of_camera = axis.frame == Frame::kCamera;
  look.direction = inWorld(axis.direction, axis.frame, view);
  look.from = of_camera || axis.kind == Kind::kAngular ? view.eye : reference;
  look.zero = inWorld(axis.zero, axis.frame, view);
  if (!isFinite(look.direction) || !isFinite(look.zero) || look.direction == Vec3d()) {
    return AxisLook{.measure = Measure::kNothing};
  }
  if (axis.kind == Kind::kAngular) {
    look.measure = Measure::kAngles;
    return view.orthographic ? positions(look, view) : look;
  }
  // Camera axes have just been rounded: a direction across the view up to rounding is taken as exactly
  // across.
  if (of_camera && view.orthographic && std::abs(dot(look.direction, view.forward)) <= kAcross) {
    look.direction = across(look.direction, view);
    look.across = true;
  }
  return look;
}

Interval eyeHeights(const AxisLook& look, const View& view) {
  if (look.measure != Measure::kHeights || look.across) {
    return kEmpty;
  }
  if (!view.orthographic) {
    const Vec3d offset = view.eye - look.from;
    const double height = dot(look.direction, offset), error = 0x1p-50 * length(offset);
    if (!std::isfinite(height + error)) {
      return kEndless;
    }
    return {roundedDown(height - error), roundedUp(height + error)};
  }
  if (exactlyAcross(look.direction, view.forward)) {
    return kEmpty;
  }
  const double towards_eye = -dot(look.direction, normalized(view.forward));
  return towards_eye > kAcross    ? Interval{kInfinity, kInfinity}
         : towards_eye < -kAcross ? Interval{-kInfinity, -kInfinity}
                                  : kEndless;
}

}  // namespace sightline::layers
