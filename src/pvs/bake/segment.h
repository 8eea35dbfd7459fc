#pragma once

// A line of sight from one point to another, for tests against many boxes.

#include <algorithm>
#include <cmath>

#include "sightline/math/box.h"
#include "src/pvs/bake/shaft.h"

namespace sightline::pvs {

class SegmentTest {
 public:
  // margin: how close to a box the segment may come without missing it, metres.
  SegmentTest(const Vec3d& from, const Vec3d& to, double margin)
      : low_(from + Vec3d{margin, margin, margin}), high_(from - Vec3d{margin, margin, margin}) {
    // Along an axis on which it stands still, the slope is as good as infinite: all of it is before what lies
    // beyond its start.
    for (int axis = 0; axis < 3; ++axis) {
      const double along = to[axis] - from[axis];
      inverse_[axis] = std::abs(along) > 1e-290 ? 1.0 / along : 1e290;
    }
  }

  bool misses(const Box& box) const {
    double begin = 0.0, end = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
      const double low = (double{box.min[axis]} - low_[axis]) * inverse_[axis],
                   high = (double{box.max[axis]} - high_[axis]) * inverse_[axis];
      begin = std::max(begin, std::min(low, high));
      end = std::min(end, std::max(low, high));
    }
    return begin > end + kAlongSegment;
  }

 private:
  Vec3d low_, high_, inverse_;
};

}  // namespace sightline::pvs
