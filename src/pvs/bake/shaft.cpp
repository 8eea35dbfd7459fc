#include "src/pvs/bake/shaft.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sightline/geometry/tolerance.h"

// Both boxes have the same three directions of edges, so every face of their hull either is perpendicular to
// an axis, or contains an edge of each box that is parallel to an axis: its normal has a zero there, and lies
// in one quadrant of the two other axes (Haines and Wallace 1991). In that quadrant the farthest corners of
// the two boxes are fixed, and the normal is the one along which both are equally far.
//
// Any normal would be safe, since the level is that of the farther corner.

namespace sightline::pvs {
namespace {

constexpr double kProductRounding = 0x1p-48;  // as a fraction of the normal and the point, 32 u

}  // namespace

Shaft::Shaft(const CellBox& region, const CellBox& target, double magnitude, double slack)
    : rounding_(kProductRounding * magnitude + slack) {
  for (int axis = 0; axis < 3; ++axis) {
    Vec3d normal;
    normal[axis] = 1.0;
    add(normal, std::max(region.max[axis], target.max[axis]));
    add(-normal, -std::min(region.min[axis], target.min[axis]));
  }
  for (int zero = 0; zero < 3; ++zero) {
    const int i = (zero + 1) % 3, j = (zero + 2) % 3;
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
        Vec3d normal;
        normal[i] = side_i * std::abs(along_j);
        normal[j] = side_j * std::abs(along_i);
        add(normal, std::max(normal[i] * from_i + normal[j] * from_j, normal[i] * to_i + normal[j] * to_j));
      }
    }
  }
}

void Shaft::add(const Vec3d& normal, double level) {
  sides_[count_++] = {normal, level + rounding_ * l1Norm(normal)};
}

bool Shaft::misses(const Box& box) const {
  const Vec3d low(box.min), high(box.max);
  for (std::uint32_t i = 0; i < count_; ++i) {
    const Vec3d& n = sides_[i].normal;
    const Vec3d nearest{n.x > 0.0 ? low.x : high.x, n.y > 0.0 ? low.y : high.y, n.z > 0.0 ? low.z : high.z};
    if (dot(n, nearest) > sides_[i].level) {
      return true;
    }
  }
  return false;
}

std::uint32_t Shaft::sidesBeyond(const Vec3d& point) const {
  std::uint32_t beyond = 0;
  for (std::uint32_t i = 0; i < count_; ++i) {
    beyond |= std::uint32_t{dot(sides_[i].normal, point) > sides_[i].level} << i;
  }
  return beyond;
}

// What is left of the segment within all sides. The levels are farther out than the products are off, so
// rounding leaves too much rather than too little.
bool Shaft::misses(const Vec3d& from, const Vec3d& to) const {
  double begin = 0.0, end = 1.0;
  for (std::uint32_t i = 0; i < count_; ++i) {
    const double at_from = dot(sides_[i].normal, from) - sides_[i].level,
                 at_to = dot(sides_[i].normal, to) - sides_[i].level;
    if (at_from > 0.0 && at_to > 0.0) {
      return true;
    }
    if (at_from > 0.0) {
      begin = std::max(begin, at_from / (at_from - at_to));
    } else if (at_to > 0.0) {
      end = std::min(end, at_from / (at_from - at_to));
    }
  }
  return begin > end + kAlongSegment;
}

}  // namespace sightline::pvs
