#pragma once

// The box of a hull along axes of its own, and the hull made smaller by a length.

#include <array>

#include "sightline/layers/hull.h"
#include "src/layers/pairs/placement.h"

namespace sightline::layers {

// A box around a hull, in the hull's space.
struct HullBox {
  Vec3d centre;
  std::array<Vec3d, 3> axes{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};  // orthonormal, up to rounding
  std::array<double, 3> half{};  // of the hull's extent along them, rounded up
};

// About the smallest one; that of a box is the box itself.
HullBox boxOf(const ConvexHull& hull);

// Returns the placement under which the hull is squeezed towards the middle of its box, along each of the
// box's axes by the same length. No point moves by more than `by`, world space, up to rounding; what is
// thinner than that becomes flat.
Placement eroded(const Placement& placement, const HullBox& box, double by);

}  // namespace sightline::layers
