#include "src/layers/pairs/convex_set.h"

#include <algorithm>
#include <cmath>

#include "sightline/geometry/tolerance.h"
#include "src/layers/hull/support.h"

namespace sightline::layers {
namespace {

// Rounding errors. u = 2^-53, |v| is the sum of a vector's absolute components, D the direction, |D_k| <= 1 +
// 1e-9.
//
// The exact height of a point p of a hull is D . (X p + o), X = (x y z) the placement's axes and o its origin
// from the local origin. What is computed instead:
//   d = X^T D    each component off by at most 3.1 u |axis|, so d . p by 3.1 u F r,
//                F = |x| + |y| + |z|, r = the largest |p_i| <= |centre| + radius + slack;
//   max d . p    exceeds farthest()'s height by at most supportError(F (1 + 4 u)), as the length of d <= |d|;
//   o            = fl(origin - local origin), off by u |o|; D . o: 3.1 u |o| more;
//   the sum of the two, the error added, and the sum of two sets' heights: three roundings of at most
//                1.1 u (F r + |o|) each.
// Together at most supportError + (6.4 F r + 7.4 |o|) u. The height of the eye e is off by 7.4 u |e|
// likewise, that of the sweep s by 6.4 u |s|. 16 u is used for all of them, which also covers the rounding of
// the bounds themselves. Products that underflow lose at most 1e-323 each, times |p_i| <= 1e100: kTiny.
constexpr double kRounding = 0x1p-49;
constexpr double kTiny = 1e-200;

}  // namespace

LocalSet localSet(const ConvexSet& set, const Vec3d& local_origin) {
  LocalSet local{set.hull, set.placement, set.kind, set.eye_or_sweep, set.more_eyes, local_origin};
  local.placement.origin = set.placement.origin - local_origin;
  const ConvexHull& hull = *set.hull;
  const double stretch = l1Norm(set.placement.x) + l1Norm(set.placement.y) + l1Norm(set.placement.z);
  const double reach = l1Norm(hull.centre) + hull.radius + hull.slack;
  local.size = stretch * reach + l1Norm(local.placement.origin);
  local.hull_error = supportError(hull, stretch * (1.0 + 0x1p-50)) + kRounding * local.size + kTiny;
  if (set.kind != ConvexSet::Kind::kHull) {
    if (set.kind == ConvexSet::Kind::kWithEye) {
      local.eye_or_sweep = set.eye_or_sweep - local_origin;
    }
    double far_size = l1Norm(local.eye_or_sweep);
    for (const Vec3d& eye : set.more_eyes) {
      // Unlike std::max, this keeps a NaN.
      const double size = l1Norm(eye - local_origin);
      far_size = size <= far_size ? far_size : size;
    }
    local.far_error = kRounding * far_size + kTiny;
    local.size += far_size;
  }
  return local;
}

Reach reach(const LocalSet& set, const Vec3d& direction, std::uint32_t start) {
  const std::uint32_t begin = start & ~PairWitness::kSweptBit;
  const Support hull =
      farthest(*set.hull, set.placement.toHull(direction), begin < set.hull->vertices.size() ? begin : 0);
  const double height = hull.height + dot(direction, set.placement.origin);
  Reach result{hull.vertex, hull.vertex, height + set.hull_error};
  if (set.kind == ConvexSet::Kind::kWithEye) {
    const double eye_height = dot(direction, set.eye_or_sweep);
    result.upper = std::max(result.upper, eye_height + set.far_error);
    double highest = height;
    if (eye_height > highest) {
      highest = eye_height;
      result.vertex = PairWitness::kEye;
    }
    for (std::size_t i = 0; i < set.more_eyes.size(); ++i) {
      const double other = dot(direction, set.more_eyes[i] - set.local_origin);
      result.upper = std::max(result.upper, other + set.far_error);
      if (other > highest) {
        highest = other;
        result.vertex = PairWitness::kEye - 1 - static_cast<std::uint32_t>(i);
      }
    }
  } else if (set.kind == ConvexSet::Kind::kSwept) {
    const double along = dot(direction, set.eye_or_sweep);
    result.upper += std::max(0.0, along + set.far_error);
    if (along > 0.0) {
      result.vertex |= PairWitness::kSweptBit;
    }
  }
  return result;
}

std::uint32_t knownVertex(const LocalSet& set, std::uint32_t vertex) {
  if (set.kind == ConvexSet::Kind::kWithEye && PairWitness::kEye - vertex <= set.more_eyes.size()) {
    return vertex;
  }
  const std::uint32_t last = static_cast<std::uint32_t>(set.hull->vertices.size() - 1);
  const std::uint32_t end = set.kind == ConvexSet::Kind::kSwept ? vertex & PairWitness::kSweptBit : 0;
  return std::min(vertex & ~PairWitness::kSweptBit, last) | end;
}

Vec3d pointOf(const LocalSet& set, std::uint32_t vertex) {
  if (vertex == PairWitness::kEye) {
    return set.eye_or_sweep;
  }
  if (PairWitness::isEye(vertex)) {
    return set.more_eyes[PairWitness::kEye - 1 - vertex] - set.local_origin;
  }
  const Vec3d point = set.placement.point(set.hull->vertices[vertex & ~PairWitness::kSweptBit]);
  return (vertex & PairWitness::kSweptBit) != 0 ? point + set.eye_or_sweep : point;
}

Vec3d innerPoint(const LocalSet& set, const Vec3d& target) {
  const Vec3d centre = set.placement.point(set.hull->centre);
  if (set.kind == ConvexSet::Kind::kHull) {
    return centre;
  }
  const Vec3d away = set.kind == ConvexSet::Kind::kWithEye ? set.eye_or_sweep - centre : set.eye_or_sweep;
  const double square = dot(away, away);
  const double along = dot(target - centre, away);
  if (!(square > 0.0 && along > 0.0)) {
    return centre;
  }
  return centre + away * std::min(1.0, along / square);
}

}  // namespace sightline::layers
