#pragma once

// How the extents along an axis are measured for one view.

#include <cstdint>

#include "sightline/layers/extent_axis.h"
#include "sightline/scene/camera.h"
#include "src/layers/extents/extent_table.h"

namespace sightline::layers {

struct AxisLook {
  enum class Measure : std::uint8_t {
    kHeights,  // along `direction`, above `from`
    kAngles,   // around `from` in the plane of `zero` and `direction`
    kNothing,  // the axis says nothing for this view: all extents are infinite
  };
  Measure measure = Measure::kHeights;
  Vec3d direction, zero;  // world space, unit length or somewhat less
  Vec3d from;
  bool across = false;  // of heights: made perpendicular to the rays of an orthographic view

  // Extents taken for one look hold for an equal one.
  friend bool operator==(const AxisLook&, const AxisLook&) = default;

  ExtentAxis::Kind kind() const {
    return measure == Measure::kAngles ? ExtentAxis::Kind::kAngular : ExtentAxis::Kind::kSpatial;
  }
};

// The axis with directions of unit length, those of an angular one perpendicular.
ExtentAxis normalizedAxis(const ExtentAxis& axis);

// axis: normalized. reference: the point above which the heights of axes that are fixed to the world are
// taken. An angular axis of an orthographic view becomes one of heights, along a direction across the view.
AxisLook lookAlong(const ExtentAxis& axis, const View& view, const Vec3d& reference);

// What a part's heights must be united with to reach the eye: its height (perspective); infinity towards it
// (orthographic); an empty interval where all rays run across the direction.
Interval eyeHeights(const AxisLook& look, const View& view);

}  // namespace sightline::layers
