#pragma once

#include "sightline/geometry/tolerance.h"
#include "sightline/math/box.h"

namespace sightline::occlusion {

// A box relative to the eye.
struct EyeBox {
  Vec3d min, max;

  static EyeBox of(const Box& box, const Vec3d& eye) { return {Vec3d(box.min) - eye, Vec3d(box.max) - eye}; }
  Vec3d center() const { return (min + max) * 0.5; }
  Vec3d half() const { return (max - min) * 0.5; }
  // How far from the eye it extends along each axis, metres.
  Vec3d reach() const { return sightline::max(abs(min), abs(max)); }
  // The l1Norm() of its farthest corner and of its nearest point, metres.
  double farthest() const { return l1Norm(reach()); }
  double nearest() const { return l1Norm(sightline::max(sightline::max(min, -max), Vec3d())); }
};

}  // namespace sightline::occlusion
