#include "src/scene/usable_view.h"

#include <algorithm>
#include <cmath>

namespace sightline::scene {
namespace {

// Axes this close to unit length are used unchanged; single precision is four times better.
constexpr double kUnitSlack = 0x1p-20;
// Minimum cosine between two axes at which they no longer count as perpendicular.
constexpr double kSkewCosine = 0x1p-20;
// Directions of unit length that differ by less are the same up to rounding: a sixteenth of kOnPlane, which
// allows for it at any distance.
constexpr double kSameDirection = 0x1p-48;

bool isPositive(double value) {
  return std::isfinite(value) && value > 0.0;
}

const char* projectionFault(const View& view) {
  if (view.orthographic ? !isPositive(view.ortho_height) : !isPositive(view.tan_half_fovy)) {
    return view.orthographic ? "View::ortho_height must be greater than 0 and finite"
                             : "View::tan_half_fovy must be greater than 0 and finite";
  }
  if (!isPositive(view.aspect)) {
    return "View::aspect (width / height) must be greater than 0 and finite";
  }
  const double shift = std::max(std::abs(view.shift_x), std::abs(view.shift_y));
  if (!(std::isfinite(view.shift_x) && std::isfinite(view.shift_y) && shift <= View::kMaxShift)) {
    return "View::shift_x and shift_y must be from -1000 to 1000 half widths and half heights of the view";
  }
  const double height = (view.orthographic ? view.ortho_height : view.tan_half_fovy) * (1.0 + shift);
  if (!isPositive(height) || !isPositive(view.aspect * height)) {
    return "View::aspect times the height of the view must be greater than 0 and finite";
  }
  if (!(std::isfinite(view.z_near) && view.z_near >= 0.0)) {
    return "View::z_near must be 0 or more metres and finite; to see what is behind the eye, move the eye "
           "back";
  }
  if (!(view.z_far > view.z_near)) {
    return "View::z_far must be greater than View::z_near; it may be infinite";
  }
  return nullptr;
}

}  // namespace

bool makeUnit(Vec3d& axis) {
  const double square = dot(axis, axis);
  if (std::abs(square - 1.0) <= kUnitSlack) {
    return true;
  }
  const double largest = maxComponent(abs(axis));
  if (!isPositive(largest)) {
    return false;
  }
  axis = normalized(axis / largest);
  return isFinite(axis) && dot(axis, axis) > 0.5;
}

bool makeAxesUnit(View& view) {
  const bool right = makeUnit(view.right), up = makeUnit(view.up), forward = makeUnit(view.forward);
  return right && up && forward;
}

View withUnitAxes(const View& view) {
  View unit = view;
  makeAxesUnit(unit);
  return unit;
}

bool isLeftHanded(const View& view) {
  return dot(cross(view.right, view.up), view.forward) > 0.0;
}

const char* makeUsable(View& view) {
  if (!isFinite(view.eye)) {
    return "View::eye must be finite";
  }
  View usable = view;
  if (!makeAxesUnit(usable)) {
    return "View::right, up and forward must be finite and not zero; setOrientation() makes them";
  }
  if (std::abs(dot(usable.right, usable.up)) > kSkewCosine ||
      std::abs(dot(usable.up, usable.forward)) > kSkewCosine ||
      std::abs(dot(usable.forward, usable.right)) > kSkewCosine) {
    return "View::right, up and forward must be perpendicular to each other; setOrientation() makes them so";
  }
  if (const char* fault = projectionFault(usable)) {
    return fault;
  }
  // A mirrored view shows the same objects.
  if (isLeftHanded(usable)) {
    usable.right = -usable.right;
    usable.shift_x = -usable.shift_x;
  }
  view = usable;
  return nullptr;
}

Vec3d sightDirection(const View& view) {
  const Vec3d across = cross(view.right, view.up);
  const Vec3d sight = across / dot(across, view.forward);
  return maxComponent(abs(sight - view.forward)) <= kSameDirection ? view.forward : sight;
}

}  // namespace sightline::scene

namespace sightline {

Result<View> validate(const View& view) {
  View usable = view;
  if (const char* fault = scene::makeUsable(usable)) {
    return Error{fault};
  }
  return usable;
}

}  // namespace sightline
