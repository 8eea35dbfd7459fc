#include "src/layers/hull/support.h"

#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/layers/hull/support.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "sightline/geometry/tolerance.h"
#include "src/layers/hull/hull_starts.h"
#include "src/layers/hull/support-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sightline::layers::HWY_NAMESPACE {

Support climbFrom(const ConvexHull& hull, const Vec3d& direction, std::uint32_t start) {
  return climb(hull, direction, start);
}

}  // namespace sightline::layers::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::layers {

HWY_EXPORT(climbFrom);

Support farthestOfAll(const ConvexHull& hull, const Vec3d& direction) {
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

Support farthest(const ConvexHull& hull, const Vec3d& direction, std::uint32_t start) {
  if (!climbs(hull)) {
    return farthestOfAll(hull, direction);
  }
  std::uint32_t from = start < hull.vertices.size() ? start : 0;
  if (!hull.starts.empty()) {
    const std::uint32_t other = hull.starts[startCell(direction, hull.start_size)];
    from = dot(direction, hull.vertices[other]) > dot(direction, hull.vertices[from]) ? other : from;
  }
  return HWY_DYNAMIC_DISPATCH(climbFrom)(hull, direction, from);
}

double supportError(const ConvexHull& hull, double length) {
  // |v| <= |centre| + radius, and the error of a dot product is slightly more than 3 * 2^-53 * |D| |v|.
  const double reach = l1Norm(hull.centre) + hull.radius;
  const double rounding = 0x1p-50 * length * reach + std::numeric_limits<double>::min();
  return 1.0001 * (length * hull.slack + rounding * (1.0 + 2.0 * hull.descent_factor));
}

}  // namespace sightline::layers
#endif
