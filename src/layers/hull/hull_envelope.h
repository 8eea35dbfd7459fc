#pragma once

// An ellipsoid and a box around a hull, which bound its heights along a direction without comparing vertices.

#include <array>
#include <cmath>
#include <cstddef>

#include "sightline/layers/hull.h"
#include "src/layers/hull/hull_box.h"

namespace sightline::layers {

// In the hull's space. The ellipsoid is all points centre + x a + y b + z c with x^2 + y^2 + z^2 <= 1, with
// the half axes a, b and c; the box is those with |x|, |y|, |z| <= 1 for its own centre and half axes.
class HullEnvelope {
 public:
  // For a single point, and for a hull that is not finite, all numbers and heights are NaN.
  // box: boxOf(hull).
  HullEnvelope(const ConvexHull& hull, const HullBox& box);

  // Returns an upper bound of dot(direction, p) over the input points p of the hull, up to rounding, and up
  // to 1e-160 where squares underflow.
  double height(const Vec3d& direction) const {
    const Heights at = along(direction);
    const double round = roundHeight(at), square = boxHeight(at);
    return round < square ? round : square;
  }
  // Returns the farthest point, along a direction, of the ellipsoid or the box, whichever is lower. It need
  // not lie in the hull.
  Vec3d farthest(const Vec3d& direction) const;
  Vec3d centre() const { return vector(kRoundCentre); }
  // Bound of the points' components and of the sum of the magnitudes that height() adds.
  double reach() const { return reach_; }

 private:
  // Numbers of the eight vectors; the half axes of the ellipsoid come first.
  static constexpr std::size_t kRoundCentre = 3, kBox = 4, kBoxCentre = 7, kVectors = 8;
  using Heights = std::array<double, kVectors>;

  void set(std::size_t i, const Vec3d& v) { x_[i] = v.x, y_[i] = v.y, z_[i] = v.z; }
  Vec3d vector(std::size_t i) const { return {x_[i], y_[i], z_[i]}; }
  Heights along(const Vec3d& direction) const {
    Heights heights;
    for (std::size_t i = 0; i < kVectors; ++i) {
      heights[i] = x_[i] * direction.x + y_[i] * direction.y + z_[i] * direction.z;
    }
    return heights;
  }
  static double root(const Heights& at) { return std::sqrt(at[0] * at[0] + at[1] * at[1] + at[2] * at[2]); }
  static double roundHeight(const Heights& at) { return at[kRoundCentre] + root(at); }
  static double boxHeight(const Heights& at) {
    return at[kBoxCentre] + (std::abs(at[kBox]) + std::abs(at[kBox + 1]) + std::abs(at[kBox + 2]));
  }

  // Columns, of which the compiler makes vector code. Nothing is summed across them, so every processor gives
  // the same bits.
  std::array<double, kVectors> x_{}, y_{}, z_{};
  double reach_ = 0.0;
};

}  // namespace sightline::layers
