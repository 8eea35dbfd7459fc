#pragma once

// Boxes around points and edges, and what is close to a line: for searches in BoxPairs.

#include <cmath>
#include <limits>

#include "sightline/math/box.h"
#include "sightline/math/vec3.h"

namespace sightline::occluders {

// Grows a box in single precision, outwards, so that boxes meet if the points are closer than the width.
inline Box grownBox(const Vec3d& low, const Vec3d& high, double by) {
  Box box;
  for (int axis = 0; axis < 3; ++axis) {
    constexpr float kFar = std::numeric_limits<float>::max();
    box.min[axis] = std::nextafterf(static_cast<float>(low[axis] - by), -kFar);
    box.max[axis] = std::nextafterf(static_cast<float>(high[axis] + by), kFar);
  }
  return box;
}

// What is close to a line. Source: the separating axes of a segment and a box (Gottschalk, Lin, Manocha.
// OBBTree: a hierarchical structure for rapid interference detection. SIGGRAPH 1996), of which those that are
// normal to the line and to an edge of the box.
class NearLine {
 public:
  NearLine(const Vec3d& at, const Vec3d& to, double width) : at_(at), along_(to - at), width_(width) {}

  // False only if all of the box is farther from the line than the width.
  bool mayMeet(const Box& box) const {
    // Rounding is by much less than this part of what is added up.
    constexpr double kMargin = 1e-12;
    const Vec3d low(box.min), high(box.max);
    const Vec3d from = at_ - (low + high) * 0.5, half = (high - low) * 0.5 + Vec3d(width_, width_, width_);
    for (int axis = 0; axis < 3; ++axis) {
      const int i = (axis + 1) % 3, k = (axis + 2) % 3;
      const double p = from[i] * along_[k], q = from[k] * along_[i];
      const double reach = half[i] * std::abs(along_[k]) + half[k] * std::abs(along_[i]);
      if (std::abs(p - q) > reach + kMargin * (std::abs(p) + std::abs(q) + reach)) {
        return false;
      }
    }
    return true;
  }

 private:
  Vec3d at_, along_;
  double width_;
};

}  // namespace sightline::occluders
