#include "src/layers/pairs/swept_set.h"

#include <cmath>

#include "sightline/geometry/tolerance.h"

namespace sightline::layers {
namespace {

// Relative to the coordinates; some hundred times the rounding error of what it is compared with.
constexpr double kSweepMargin = 1e-12;

// The heights of a ball around a placed hull along a direction of the world.
struct Heights {
  double middle = 0.0, half = 0.0;
  double magnitude = 0.0;  // sum of the absolute values from which the middle was computed
};

Heights heightsAlong(const ConvexSet& set, const Vec3d& direction) {
  const double radius = (set.hull->radius + set.hull->slack) * stretchOf(set.placement);
  const double steep = l1Norm(direction);
  return {dot(set.placement.point(set.hull->centre), direction),
          radius * length(direction) * (1.0 + kSweepMargin), reachOf(set) * steep};
}

}  // namespace

double reachOf(const ConvexSet& set) {
  const Placement& p = set.placement;
  return l1Norm(p.origin) +
         (l1Norm(p.x) + l1Norm(p.y) + l1Norm(p.z)) * (l1Norm(set.hull->centre) + set.hull->radius);
}

// The direction is scaled by a power of two, so that it stays exact.
bool sweepPast(const Vec3d& forward, const ConvexSet& front, ConvexSet& back) {
  const Vec3d towards_eye = -forward;
  const Heights f = heightsAlong(front, towards_eye), b = heightsAlong(back, towards_eye);
  const double way = (f.middle + f.half) - (b.middle - b.half) + kSweepMargin * (f.magnitude + b.magnitude);
  if (way < 0.0) {
    return false;
  }
  back.kind = ConvexSet::Kind::kSwept;
  const double steps = way / dot(towards_eye, towards_eye);
  int exponent = 0;
  (void)std::frexp(steps, &exponent);
  // testIntersection() leaves sets that are not finite undecided.
  back.eye_or_sweep = towards_eye * (std::isfinite(steps) ? std::ldexp(1.0, exponent) : steps);
  return true;
}

}  // namespace sightline::layers
