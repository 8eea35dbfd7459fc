#pragma once

// Angles around the eye in a plane, computed without an inverse tangent.
//
// The pseudo-angle of a direction (x, z), with z towards angle 0 and x towards a quarter turn, is its place
// on the diamond |x| + |z| = 1: x / (|x| + |z|) in front, mirrored behind. It grows with the angle but no
// faster, makes a full turn in 4, and differs by 2 for opposite directions.

#include <algorithm>
#include <cmath>
#include <utility>

#include "src/layers/extents/extent_table.h"
#include "src/layers/extents/round_outwards.h"

namespace sightline::layers {

// A point relative to the eye.
struct PlanePoint {
  double x = 0.0;  // towards a quarter turn
  double z = 0.0;  // towards angle 0
};

inline double dot(const PlanePoint& a, const PlanePoint& b) {
  return a.x * b.x + a.z * b.z;
}
// Positive if b has the greater angle, at less than half a turn from a.
inline double turn(const PlanePoint& a, const PlanePoint& b) {
  return b.x * a.z - a.x * b.z;
}
// Returns the pseudo-angle, in [-2, 2]; NaN for the zero vector.
inline double pseudoAngle(const PlanePoint& p) {
  const double side = p.x / (std::abs(p.x) + std::abs(p.z));
  return p.z >= 0.0 ? side : std::copysign(2.0, p.x) - side;
}

// The pseudo-angles from low to high >= low. A width of 4 or more is the full circle.
struct AngleRange {
  double low = -2.0, high = 2.0;

  bool full() const { return !(high - low < 4.0); }
};

// Returns the range from one direction to another that is less than half a turn ahead. A direction a little
// behind counts as the same.
inline AngleRange rangeBetween(const PlanePoint& low, const PlanePoint& high) {
  AngleRange range{pseudoAngle(low), pseudoAngle(high)};
  if (range.high < range.low - 2.0) {
    range.high += 4.0;
  } else if (range.high < range.low) {
    std::swap(range.low, range.high);
  }
  return range;
}

// Returns the narrower one of the two ranges that contain both.
AngleRange unite(const AngleRange& a, const AngleRange& b);

inline constexpr Interval kFullCircle{-2.0f, 2.0f};

// Returns the range as an interval of an ExtentTable, rounded outwards. A range with NaN becomes the full
// circle.
inline Interval roundedAngles(const AngleRange& range) {
  // Leaves room for rounding near the ends of the circle, so that bounds keep to the ranges that Interval
  // states.
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

// Each end of an angular interval is moved outwards by this for overlapsAngular(), whose sums are below 16
// and so round by up to 2^-21, or 2^-20 for both intervals together.
inline constexpr double kAngleMargin = 4e-6;

}  // namespace sightline::layers
