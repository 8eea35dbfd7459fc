#include "layers/support.h"

#include <cstddef>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "layers/support.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "sightline/geometry/tolerance.h"

HWY_BEFORE_NAMESPACE();
namespace sightline::layers {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Lanes = hn::CappedTag<double, 4>;

// The highest of a vertex' neighbours, if one is higher than it. Mostly none is, and four are asked at once.
HWY_INLINE Support highestAround(const ConvexHull& hull, const Vec3d& direction, const Support& at) {
  const Lanes d;
  const std::size_t lanes = hn::Lanes(d);
  const auto x = hn::Set(d, direction.x), y = hn::Set(d, direction.y), z = hn::Set(d, direction.z);
  Support best = at;
  const std::uint32_t first = hull.first_quad[at.vertex], last = hull.first_quad[at.vertex + 1];
  for (std::uint32_t quad = first; quad < last; ++quad) {
    const double* corners = hull.neighbour_quads.data() + 12 * std::size_t{quad};
    for (std::size_t i = 0; i < 4; i += lanes) {
      const auto heights =
          hn::Add(hn::Add(hn::Mul(x, hn::LoadU(d, corners + i)), hn::Mul(y, hn::LoadU(d, corners + 4 + i))),
                  hn::Mul(z, hn::LoadU(d, corners + 8 + i)));
      if (hn::AllFalse(d, hn::Gt(heights, hn::Set(d, best.height)))) {
        continue;
      }
      double each[4];
      hn::StoreU(heights, d, each);
      for (std::size_t k = 0; k < lanes; ++k) {
        if (each[k] > best.height) {
          best = {hull.neighbours[hull.first_neighbour[at.vertex] + 4 * (quad - first) + i + k], each[k]};
        }
      }
    }
  }
  return best;
}

Support climb(const ConvexHull& hull, const Vec3d& direction, std::uint32_t start) {
  Support at{start, dot(direction, hull.vertices[start])};
  while (true) {
    const Support next = highestAround(hull, direction, at);
    if (next.vertex == at.vertex) {
      return at;
    }
    at = next;
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace sightline::layers
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::layers {

HWY_EXPORT(climb);

namespace {

constexpr std::size_t kScanUpTo = 24;

Support scan(const ConvexHull& hull, const Vec3d& direction) {
  Support best{0, dot(direction, hull.vertices[0])};
  const auto count = static_cast<std::uint32_t>(hull.vertices.size());
  for (std::uint32_t v = 1; v < count; ++v) {
    const double height = dot(direction, hull.vertices[v]);
    if (height > best.height) {
      best = {v, height};
    }
  }
  return best;
}

}  // namespace

Support farthest(const ConvexHull& hull, const Vec3d& direction, std::uint32_t start) {
  const std::size_t count = hull.vertices.size();
  if (hull.descent_factor <= 0.0 || count <= kScanUpTo) {
    return scan(hull, direction);
  }
  return HWY_DYNAMIC_DISPATCH(climb)(hull, direction, start < count ? start : 0);
}

double supportError(const ConvexHull& hull, double length) {
  // |v| <= |centre| + radius; a dot product is off by at most 3 * 2^-53 * |D| |v| and a little.
  const double reach = magnitude(hull.centre) + hull.radius;
  const double rounding = 0x1p-50 * length * reach + std::numeric_limits<double>::min();
  return 1.0001 * (length * hull.slack + rounding * (1.0 + 2.0 * hull.descent_factor));
}

}  // namespace sightline::layers
#endif
