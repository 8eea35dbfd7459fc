#pragma once

#include <array>
#include <cstdint>

#include "sightline/math/box.h"
#include "sightline/math/plane.h"

namespace sightline {

// The view frustum: six planes with normals pointing inwards (left, right, bottom, top, near, far).
struct Frustum {
  std::array<Plane, 6> planes{};  // unit normals
};

enum class FrustumSide : std::uint8_t { kOutside, kIntersects, kInside };

// Classifies a box. It is outside only if it is strictly outside one plane by more than the rounding of the
// test. This is conservative: boxes near a corner of the frustum may count as intersecting although they are
// outside. mask: bit i is set if plane i must be tested. Bits of planes that the box is entirely inside of
// are cleared, so that its children skip them.
FrustumSide classify(const Frustum& frustum, const Box& box, std::uint8_t& mask);
inline constexpr std::uint8_t kAllFrustumPlanes = 0x3f;

}  // namespace sightline
