#pragma once

// The one place for tolerances of run-time geometry; docs/conservative.md has the derivations.
//
// All run-time geometry is done in double precision on points relative to the eye. Coordinates of scenes are
// single precision, so the subtraction of the eye has a relative error of 2^-53 and everything after it a few
// times that. Three numbers, each far above the one before, keep rounding on the visible side:
//
//   kOnPlane     a point nearer to a shadow plane than this times its distance from the eye counts as on it.
//                It is above the rounding of a plane through two points and of its evaluation (2^-50)
//   kEdgeMargin  an occluder's outline is drawn in by at least this angle before its shadow planes are made;
//                above kOnPlane, so that "on the plane" never reaches the true outline
//   kDepthMargin a point must lie behind an occluder's plane by at least this times the distances involved;
//                above what kOnPlane and kEdgeMargin can move along a ray that hits the plane at a grazing
//                angle

#include "sightline/base/inline.h"
#include "sightline/math/vec3.h"

namespace sightline {

inline constexpr double kOnPlane = 0x1p-44;
inline constexpr double kEdgeMargin = 0x1p-38;
inline constexpr double kDepthMargin = 0x1p-32;

// Occluders seen at a more grazing angle than this (sine) are not used: their shadow is thin and badly
// conditioned.
inline constexpr double kGrazingSine = 0x1p-10;
// Edges that span less than this angle (sine) give no shadow plane.
inline constexpr double kShortestEdgeSine = 0x1p-20;

// A size for scaling the tolerances: at least the Euclidean length, at most 1.8 times it.
SIGHTLINE_INLINE constexpr double l1Norm(const Vec3d& p) {
  const Vec3d a = abs(p);
  return a.x + a.y + a.z;
}

}  // namespace sightline
