#pragma once

// How the extents along an axis are measured in one view.

#include <cstdint>

#include "sightline/layers/extent_axis.h"
#include "sightline/scene/camera.h"
#include "src/layers/extents/extent_table.h"

namespace sightline::layers {

struct AxisLook {
  enum class Measure : std::uint8_t {
    kHeights,  // heights along `direction`, above `from`
    kAngles,   // angles around `from` in the plane of `zero` and `direction`
    kNothing,  // the axis cannot be measured in this view, so all extents are infinite
  };
  Measure measure = Measure::kHeights;
  Vec3d direction, zero;  // world space, of unit length or somewhat shorter
  Vec3d from;
  bool across = false;  // whether `direction` was made perpendicular to the rays of an orthographic view

  // Extents measured for one look are valid for an equal one.
  friend bool operator==(const AxisLook&, const AxisLook&) = default;

  ExtentAxis::Kind kind() const {
    return measure == Measure::kAngles ? ExtentAxis::Kind::kAngular : ExtentAxis::Kind::kSpatial;
  }
};

// Returns the axis with directions of unit length, which are perpendicular on an angular axis.
ExtentAxis normalizedAxis(const ExtentAxis& axis);

// Returns how an axis is measured in a view. An angular axis in an orthographic view becomes one of heights
// along a direction across the view.
// axis: normalized. reference: the point above which heights along axes fixed to the world are measured.
AxisLook lookAlong(const ExtentAxis& axis, const View& view, const Vec3d& reference);

// Returns the interval that widens a part's heights to the eye: the eye's height (perspective), infinity
// towards the eye (orthographic), or an empty interval if all rays are perpendicular to the direction.
Interval eyeHeights(const AxisLook& look, const View& view);

}  // namespace sightline::layers
