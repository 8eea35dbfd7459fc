#pragma once

// Angles around the eye in a plane, without an inverse tangent.
//
// The pseudo-angle of a direction (x, z), z towards angle 0 and x towards a quarter turn, is its place on the
// diamond |x| + |z| = 1: x / (|x| + |z|) in front, the same mirrored behind. It grows with the angle, no
// faster than it, and makes a full turn in 4; opposite directions are 2 apart.

#include <algorithm>
#include <cmath>
#include <utility>

#include "src/layers/extents/extent_table.h"
#include "src/layers/extents/round_outwards.h"

namespace sightline::layers {

// Relative to the eye.
struct PlanePoint {
  double x = 0.0;  // towards a quarter turn
  double z = 0.0;  // towards angle 0
};

inline double dot(const PlanePoint& a, const PlanePoint& b) {
  return a.x * b.x + a.z * b.z;
}
// > 0: b has the greater angle, seen as less than half a turn from a.
inline double turn(const PlanePoint& a, const PlanePoint& b) {
  return b.x * a.z - a.x * b.z;
}
// In [-2, 2]. Of the zero vector: not a number.
inline double pseudoAngle(const PlanePoint& p) {
  const double side = p.x / (std::abs(p.x) + std::abs(p.z));
  return p.z >= 0.0 ? side : std::copysign(2.0, p.x) - side;
}

// Pseudo-angles from low to high >= low; a width of 4 or more is the full circle.
struct AngleRange {
  double low = -2.0, high = 2.0;

  bool full() const { return !(high - low < 4.0); }
};

// From one direction on to another that is less than half a turn ahead; a little behind counts as the same.
inline AngleRange rangeBetween(const PlanePoint& low, const PlanePoint& high) {
  AngleRange range{pseudoAngle(low), pseudoAngle(high)};
  if (range.high < range.low - 2.0) {
    range.high += 4.0;
  } else if (range.high < range.low) {
    std::swap(range.low, range.high);
  }
  return range;
}

// The narrower one of the two ranges that hold both.
AngleRange unite(const AngleRange& a, const AngleRange& b);

inline constexpr Interval kFullCircle{-2.0f, 2.0f};

// Rounded outwards, in the form that tables hold. Anything that is not a number: the full circle.
inline Interval roundedAngles(const AngleRange& range) {
  // Near the ends of the circle there is room for rounding, so that bounds stay where they are promised.
  constexpr double kRoom = 1e-6;
  if (!(range.high - range.low < 4.0 - 4.0 * kRoom)) {
    return kFullCircle;
  }
  double low = range.low, high = range.high;
  while (low < -2.0 + kRoom) {
    low += 4.0, high += 4.0;
  }
  while (low > 2.0 + kRoom) {
    low -= 4.0, high -= 4.0;
  }
  return {std::min(roundedDown(low), 2.0f), roundedUp(high)};
}

// What each end of an angular interval is moved outwards by, for overlapsAngular: its sums are below 16 and
// round by 2^-21, those of both intervals together by 2^-20.
inline constexpr double kAngleMargin = 4e-6;

}  // namespace sightline::layers
