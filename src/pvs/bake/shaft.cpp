#include "src/pvs/bake/shaft.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sightline/geometry/tolerance.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/pvs/bake/shaft.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

// Both boxes have the same three directions of edges, so every face of their hull either is perpendicular to
// an axis, or contains an edge of each box that is parallel to an axis: its normal has a zero there, and lies
// in one quadrant of the two other axes (Haines and Wallace 1991). In that quadrant the farthest corners of
// the two boxes are fixed, and the normal is the one along which both are equally far.
//
// Any normal would be safe, since the level is that of the farther corner.

HWY_BEFORE_NAMESPACE();
namespace sightline::pvs {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Four bits for each axis: the sides whose normals are across it that the point is beyond. No fused
// operations: they would round differently on different instruction sets.
std::uint32_t slantedBeyond(const std::array<Shaft::Sides, 3>& slanted, const Vec3d& point) {
  constexpr hn::CappedTag<double, 4> kLanes;
  const auto x = hn::Set(kLanes, point.x), y = hn::Set(kLanes, point.y), z = hn::Set(kLanes, point.z);
  std::uint32_t beyond = 0;
  const auto add = [&](const Shaft::Sides& across, auto i, auto j, std::uint32_t bit) HWY_ATTR {
    for (std::size_t first = 0; first < 4; first += hn::Lanes(kLanes)) {
      const auto place = hn::Add(hn::Mul(hn::Load(kLanes, across.normal_i.data() + first), i),
                                 hn::Mul(hn::Load(kLanes, across.normal_j.data() + first), j));
      const auto is_beyond = hn::Gt(place, hn::Load(kLanes, across.level.data() + first));
      std::uint8_t bits[8] = {};  // StoreMaskBits() may write all of these
      hn::StoreMaskBits(kLanes, is_beyond, bits);
      beyond |= std::uint32_t{bits[0]} << (bit + first);
    }
  };
  add(slanted[0], y, z, 0);
  add(slanted[1], z, x, 4);
  add(slanted[2], x, y, 8);
  return beyond;
}

}  // namespace HWY_NAMESPACE
}  // namespace sightline::pvs
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::pvs {
namespace {

HWY_EXPORT(slantedBeyond);

constexpr double kProductRounding = 0x1p-48;  // as a fraction of the normal and the point, 32 u

}  // namespace

Shaft::Shaft(const CellBox& region, const CellBox& target, double magnitude, double slack) {
  // A product of a normal and a point is rounded by at most so much for each metre of the normal's size.
  const double rounding = kProductRounding * magnitude + slack;
  const Vec3d margin{rounding, rounding, rounding};
  low_ = min(region.min, target.min) - margin;
  high_ = max(region.max, target.max) + margin;
  for (int zero = 0; zero < 3; ++zero) {
    const int i = (zero + 1) % 3, j = (zero + 2) % 3;
    Sides& across = slanted_[static_cast<std::size_t>(zero)];
    for (const double side_i : {-1.0, 1.0}) {
      for (const double side_j : {-1.0, 1.0}) {
        const auto corner = [&](const CellBox& box) {
          return std::pair(side_i > 0.0 ? box.max[i] : box.min[i], side_j > 0.0 ? box.max[j] : box.min[j]);
        };
        const auto [from_i, from_j] = corner(region);
        const auto [to_i, to_j] = corner(target);
        const double along_i = side_i * (to_i - from_i), along_j = side_j * (to_j - from_j);
        if (!(along_i * along_j < 0.0)) {
          continue;  // one of the corners is the farther one along every normal of the quadrant
        }
        const double normal_i = side_i * std::abs(along_j), normal_j = side_j * std::abs(along_i);
        const double level =
            std::max(normal_i * from_i + normal_j * from_j, normal_i * to_i + normal_j * to_j);
        across.normal_i[across.count] = normal_i;
        across.normal_j[across.count] = normal_j;
        across.level[across.count++] = level + rounding * (std::abs(normal_i) + std::abs(normal_j));
      }
    }
  }
}

bool Shaft::misses(const Box& box) const {
  const Vec3d low(box.min), high(box.max);
  for (int axis = 0; axis < 3; ++axis) {
    if (low[axis] > high_[axis] || high[axis] < low_[axis]) {
      return true;
    }
  }
  for (int zero = 0; zero < 3; ++zero) {
    const int i = (zero + 1) % 3, j = (zero + 2) % 3;
    const Sides& across = slanted_[static_cast<std::size_t>(zero)];
    for (std::uint32_t s = 0; s < across.count; ++s) {
      const double nearest_i = across.normal_i[s] > 0.0 ? low[i] : high[i],
                   nearest_j = across.normal_j[s] > 0.0 ? low[j] : high[j];
      if (across.normal_i[s] * nearest_i + across.normal_j[s] * nearest_j > across.level[s]) {
        return true;
      }
    }
  }
  return false;
}

std::uint32_t Shaft::sidesBeyond(const Vec3d& point) const {
  std::uint32_t beyond = 0, bit = 0;
  for (int axis = 0; axis < 3; ++axis) {
    beyond |= std::uint32_t{point[axis] > high_[axis]} << bit++;
    beyond |= std::uint32_t{point[axis] < low_[axis]} << bit++;
  }
  return beyond | (HWY_DYNAMIC_DISPATCH(slantedBeyond)(slanted_, point) << bit);
}

// What is left of the segment within all sides. The levels are farther out than the products are off, so
// rounding leaves too much rather than too little.
bool Shaft::misses(const Vec3d& from, const Vec3d& to) const {
  double begin = 0.0, end = 1.0;
  // How far both ends are beyond a side. True if all of the segment is.
  const auto isBeyond = [&](double at_from, double at_to) {
    if (at_from > 0.0 && at_to > 0.0) {
      return true;
    }
    if (at_from > 0.0) {
      begin = std::max(begin, at_from / (at_from - at_to));
    } else if (at_to > 0.0) {
      end = std::min(end, at_from / (at_from - at_to));
    }
    return false;
  };
  for (int axis = 0; axis < 3; ++axis) {
    if (isBeyond(from[axis] - high_[axis], to[axis] - high_[axis]) ||
        isBeyond(low_[axis] - from[axis], low_[axis] - to[axis])) {
      return true;
    }
  }
  for (int zero = 0; zero < 3; ++zero) {
    const int i = (zero + 1) % 3, j = (zero + 2) % 3;
    const Sides& across = slanted_[static_cast<std::size_t>(zero)];
    for (std::uint32_t s = 0; s < across.count; ++s) {
      const double normal_i = across.normal_i[s], normal_j = across.normal_j[s], level = across.level[s];
      if (isBeyond(normal_i * from[i] + normal_j * from[j] - level,
                   normal_i * to[i] + normal_j * to[j] - level)) {
        return true;
      }
    }
  }
  return begin > end + kAlongSegment;
}

}  // namespace sightline::pvs
#endif
