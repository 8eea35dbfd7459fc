#pragma once

// The eye in the first part's space with a bound on its rounding error, as rules about pairs of parts need
// it.

#include "sightline/layers/pair_rule.h"
#include "sightline/scene/camera.h"
#include "src/layers/pairs/placement.h"

namespace sightline::layers {

struct PairEye {
  bool known = false;   // false: the eye or the transform into the part's space is not finite
  bool far = false;     // true (orthographic): `position` is the unit direction towards the eye
  Vec3d position;       // of the eye
  double error = 0.0;   // bound of the distance to the exact position
  double extent = 0.0;  // upper bound of the length of `position`
};

PairEye pairEye(const View& view_in_part);
// world_from_part: any affine placement; if it flattens the part, the eye is not known.
PairEye pairEye(const View& view_world, const Placement& world_from_part);

PairOrder orderOf(const PairPlane& known, const PairEye& eye);
PairOrder orderOf(const SphereCylinderJoint& joint, const PairEye& eye);

}  // namespace sightline::layers
