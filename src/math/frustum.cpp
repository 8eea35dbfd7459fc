#include "sightline/math/frustum.h"

namespace sightline {

FrustumSide classify(const Frustum& frustum, const Box& box, std::uint8_t& mask) {
  if (!box.wellFormed()) {
    return FrustumSide::kIntersects;
  }
  const Vec3d box_center = center(box);
  const Vec3d half = (Vec3d(box.max) - Vec3d(box.min)) * 0.5;
  const Vec3d reach = abs(box_center) + half;
  for (int i = 0; i < 6; ++i) {
    const auto bit = static_cast<std::uint8_t>(1u << i);
    if ((mask & bit) == 0) {
      continue;
    }
    const Plane& plane = frustum.planes[static_cast<std::size_t>(i)];
    const double distance = plane.evaluate(box_center);
    const double radius = dot(abs(plane.normal), half);
    // The rounding of the sums above is below 2^-49 of the largest term; the slack is sixteen times that.
    const double slack = 0x1p-45 * (reach.x + reach.y + reach.z + std::abs(plane.offset));
    if (distance + radius < -slack) {
      return FrustumSide::kOutside;
    }
    if (distance - radius > slack) {
      mask = static_cast<std::uint8_t>(mask & ~bit);
    }
  }
  return mask == 0 ? FrustumSide::kInside : FrustumSide::kIntersects;
}

}  // namespace sightline
