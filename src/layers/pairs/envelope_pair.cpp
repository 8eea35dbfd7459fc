// Based on: Gilbert, Johnson, Keerthi. A fast procedure for computing the distance between complex objects in
// three-dimensional space. IEEE J. Robotics and Automation 1988.
// Differs from the paper in: the sets are envelopes, whose farthest points need no vertices; the search goes
// on for a step after the first direction that separates them, since a wider gap lasts for more frames.

#include "src/layers/pairs/envelope_pair.h"

#include <algorithm>
#include <cmath>

#include "src/layers/pairs/simplex.h"

namespace sightline::layers {
namespace {

constexpr int kMaxTries = 8;
// Directions tried after the first that separates, for a wider gap.
constexpr int kMoreTries = 1;

// The point of the set's envelope that is farthest along a direction, above a point.
Vec3d outerPoint(const ConvexSet& set, const Vec3d& direction, const Vec3d& above) {
  const Placement& p = set.placement;
  const Vec3d far = set.around->farthest(p.toHull(direction));
  const Vec3d point = p.x * far.x + p.y * far.y + p.z * far.z + (p.origin - above);
  if (set.kind == ConvexSet::Kind::kWithEye) {
    const Vec3d eye = set.eye_or_sweep - above;
    Vec3d farthest = dot(direction, eye) > dot(direction, point) ? eye : point;
    for (const Vec3d& more : set.more_eyes) {
      farthest = dot(direction, more - above) > dot(direction, farthest) ? more - above : farthest;
    }
    return farthest;
  }
  return set.kind == ConvexSet::Kind::kSwept && dot(direction, set.eye_or_sweep) > 0.0
             ? point + set.eye_or_sweep
             : point;
}

// The lowest point of the difference, second minus first, along a direction.
Vec3d lowestDifference(const ConvexSet& first, const ConvexSet& second, const Vec3d& direction) {
  const Vec3d& origin = first.placement.origin;
  return outerPoint(second, -direction, origin) - outerPoint(first, direction, origin);
}

double gapAlong(const ConvexSet& first, const ConvexSet& second, const Vec3d& direction) {
  const Vec3d& origin = first.placement.origin;
  return -(outerHeight(first, direction, origin) + outerHeight(second, -direction, origin));
}

Vec3d nearestOnSegment(const Vec3d& p, const Vec3d& q) {
  const Vec3d way = q - p;
  const double square = dot(way, way), along = -dot(p, way);
  return square > 0.0 && along > 0.0 ? p + way * std::min(1.0, along / square) : p;
}

}  // namespace

double outerHeight(const ConvexSet& set, const Vec3d& direction, const Vec3d& above) {
  double height = outerHeight(*set.around, set.placement, set.placement.origin - above, direction);
  if (set.kind == ConvexSet::Kind::kWithEye) {
    const double of_eye = outerHeight(set.eye_or_sweep - above, direction);
    height = std::isnan(height) || of_eye <= height ? height : of_eye;
    for (const Vec3d& eye : set.more_eyes) {
      const double of_other = outerHeight(eye - above, direction);
      height = std::isnan(height) || of_other <= height ? height : of_other;
    }
  } else if (set.kind == ConvexSet::Kind::kSwept) {
    const double along = outerHeight(set.eye_or_sweep, direction);
    height = along <= 0.0 ? height : height + along;
  }
  return height;
}

Vec3d directionBetween(const ConvexSet& first, const ConvexSet& second) {
  const auto middleOf = [](const ConvexSet& set) { return set.placement.point(set.around->centre()); };
  const Vec3d from = middleOf(first), to = middleOf(second) - from;
  Vec3d nearest = to;
  if (second.kind == ConvexSet::Kind::kWithEye) {
    nearest = nearestOnSegment(to, second.eye_or_sweep - from);
  } else if (second.kind == ConvexSet::Kind::kSwept) {
    nearest = nearestOnSegment(to, to + second.eye_or_sweep);
  }
  const Vec3d unit = unitOrZero(nearest);
  return unit == Vec3d() ? Vec3d{1, 0, 0} : unit;
}

bool separates(const ConvexSet& first, const ConvexSet& second, const Vec3d& direction) {
  return gapAlong(first, second, direction) > 0.0;
}

bool separateEnvelopes(const ConvexSet& first, const ConvexSet& second, Vec3d& direction,
                       std::uint64_t& steps) {
  const Vec3d start = lowestDifference(first, second, direction);
  const double size = maxComponent(abs(start)), unit = size > 0.0 ? 1.0 / size : 1.0;
  Simplex simplex;
  simplex.add({start * unit, 0, 0});
  double widest = 0.0;
  for (int tries_left = kMaxTries; tries_left > 0; --tries_left) {
    const NearestPart part = nearestPart(simplex);
    if (part.holds_origin || part.direction == Vec3d()) {
      break;
    }
    ++steps;
    const double gap = gapAlong(first, second, part.direction);
    if (gap > widest) {
      tries_left = widest > 0.0 ? tries_left : std::min(tries_left, 1 + kMoreTries);
      widest = gap;
      direction = part.direction;
    }
    keepCorners(simplex, part.corners);
    simplex.add({lowestDifference(first, second, part.direction) * unit, 0, 0});
  }
  return widest > 0.0;
}

}  // namespace sightline::layers
