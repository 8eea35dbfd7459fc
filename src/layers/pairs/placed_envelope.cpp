#include "src/layers/pairs/placed_envelope.h"

#include "sightline/geometry/tolerance.h"

namespace sightline::layers {

PlacedEnvelope::PlacedEnvelope(const HullEnvelope& around, const Placement& placement) {
  const auto take = [&](std::size_t i, const Vec3d& v) {
    x_[i] = placement.x.x * v.x + placement.y.x * v.y + placement.z.x * v.z;
    y_[i] = placement.x.y * v.x + placement.y.y * v.y + placement.z.y * v.z;
    z_[i] = placement.x.z * v.x + placement.y.z * v.y + placement.z.z * v.z;
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    take(axis, around.round_axes[axis]);
    take(kBox + axis, around.box_axes[axis]);
  }
  take(kRoundCentre, around.round_centre);
  take(kBoxCentre, around.box_centre);
  reach_ = (l1Norm(placement.x) + l1Norm(placement.y) + l1Norm(placement.z)) * around.reach;
}

Vec3d PlacedEnvelope::farthest(const Vec3d& direction) const {
  const Heights at = along(direction);
  const double root = std::sqrt(at[0] * at[0] + at[1] * at[1] + at[2] * at[2]);
  const double square =
      at[kBoxCentre] + (std::abs(at[kBox]) + std::abs(at[kBox + 1]) + std::abs(at[kBox + 2]));
  if (root > 0.0 && at[kRoundCentre] + root < square) {
    return vector(kRoundCentre) + (vector(0) * at[0] + vector(1) * at[1] + vector(2) * at[2]) / root;
  }
  return vector(kBoxCentre) + vector(kBox) * std::copysign(1.0, at[kBox]) +
         vector(kBox + 1) * std::copysign(1.0, at[kBox + 1]) +
         vector(kBox + 2) * std::copysign(1.0, at[kBox + 2]);
}

}  // namespace sightline::layers
