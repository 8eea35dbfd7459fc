#pragma once

// The region, the box and the lines between them of which RegionProof speaks.

#include <array>
#include <cstdint>
#include <vector>

#include "oracle/eye_region.h"
#include "oracle/region_signs.h"

namespace sightline {

constexpr std::size_t kSightLines = 3;  // whose crossings are counted

struct DoubleBox {
  Vec3d min, max;
  Vec3d corner(std::uint32_t i) const {
    return {(i & 1) != 0 ? max.x : min.x, (i & 2) != 0 ? max.y : min.y, (i & 4) != 0 ? max.z : min.z};
  }
};

DoubleBox boxOf(const Corners& t);
// True if the boxes are farther apart than the distance, for sure. At 0 they must not touch.
bool apart(const DoubleBox& a, const DoubleBox& b, double distance);

// Points whose convex hull holds every eye of the region. A point on an edge of the box is moved outwards by
// more than rounding.
std::vector<Vec3d> hullOf(const EyeRegion& region);
// Points of a hull at which lines of sight start: means of its corners, rounded, with weights that have no
// pattern, so that lines rarely meet edges.
std::array<Vec3d, kSightLines> startsIn(const std::vector<Vec3d>& hull);
// Where they end: in the box.
std::array<Vec3d, kSightLines> endsIn(const DoubleBox& box);
// True if no product of the coordinates overflows. False for coordinates that are not finite, too.
bool isNear(const Vec3d& p);

}  // namespace sightline
