#pragma once

#include <array>
#include <cstdint>

#include "sightline/math/box.h"
#include "sightline/math/plane.h"

namespace sightline {

// The visible volume of a view: six planes with normals pointing inwards (left, right, bottom, top, near,
// far).
struct Frustum {
  std::array<Plane, 6> planes{};  // unit normals
};

enum class FrustumSide : std::uint8_t { kOutside, kIntersects, kInside };

// Where a box lies; outside only when all of it is strictly outside one plane by more than the rounding of
// the test (conservative; boxes near a corner of the frustum may be called intersecting though they are
// outside). mask: bit i set: plane i must be tested; bits of planes that the box is inside of are cleared for
// its children.
FrustumSide classify(const Frustum& frustum, const Box& box, std::uint8_t& mask);
inline constexpr std::uint8_t kAllFrustumPlanes = 0x3f;

}  // namespace sightline
