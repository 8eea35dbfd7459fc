#pragma once

// The eye as rules about pairs of parts need it: in the first part's space, with what rounding may have moved
// it.

#include "sightline/layers/pair_rule.h"
#include "sightline/scene/camera.h"
#include "src/layers/pairs/placement.h"

namespace sightline::layers {

struct PairEye {
  bool known = false;   // finite, and the way into the part's space is
  bool far = false;     // orthographic: `position` is the unit direction towards the eye
  Vec3d position;       // of the eye
  double error = 0.0;   // the true position lies within this
  double extent = 0.0;  // at least the length of the position
};

PairEye pairEye(const View& view_in_part);
// Any affine placement; where it flattens the part, the eye is not known.
PairEye pairEye(const View& view_world, const Placement& world_from_part);

PairOrder orderOf(const PairPlane& known, const PairEye& eye);
PairOrder orderOf(const SphereCylinderJoint& joint, const PairEye& eye);

}  // namespace sightline::layers
