#pragma once

// The envelope of a hull in the world.

#include <array>
#include <cmath>
#include <cstddef>

#include "src/layers/hull/hull_envelope.h"
#include "src/layers/pairs/placement.h"

namespace sightline::layers {

// Eight vectors: the half axes and the centre of the ellipsoid, then those of the box. Centres are relative
// to the placement's origin. They are columns of numbers, so that the compiler makes vector code of their
// products with a direction; no products are summed across columns, so every processor gives the same bits.
class PlacedEnvelope {
 public:
  static constexpr std::size_t kRoundCentre = 3, kBox = 4, kBoxCentre = 7, kVectors = 8;
  using Heights = std::array<double, kVectors>;

  PlacedEnvelope() = default;
  PlacedEnvelope(const HullEnvelope& around, const Placement& placement);

  // The heights of the eight vectors along a direction.
  Heights along(const Vec3d& direction) const {
    Heights heights;
    for (std::size_t i = 0; i < kVectors; ++i) {
      heights[i] = x_[i] * direction.x + y_[i] * direction.y + z_[i] * direction.z;
    }
    return heights;
  }
  // An upper bound of the heights of the hull's points above the placement's origin, up to reach() times
  // 2^-46, and up to 1e-160 where squares underflow.
  double height(const Vec3d& direction) const {
    const Heights at = along(direction);
    const double round = at[kRoundCentre] + std::sqrt(at[0] * at[0] + at[1] * at[1] + at[2] * at[2]);
    const double square =
        at[kBoxCentre] + (std::abs(at[kBox]) + std::abs(at[kBox + 1]) + std::abs(at[kBox + 2]));
    return round < square ? round : square;
  }
  // The farthest point, along a direction, of the ellipsoid or the box, whichever is lower, relative to the
  // placement's origin. It need not lie in the hull.
  Vec3d farthest(const Vec3d& direction) const;
  // Bound of the points' components relative to the placement's origin.
  double reach() const { return reach_; }
  Vec3d vector(std::size_t i) const { return {x_[i], y_[i], z_[i]}; }

 private:
  std::array<double, kVectors> x_{}, y_{}, z_{};
  double reach_ = 0.0;
};

}  // namespace sightline::layers
