#include "src/layers/hull/hull_flat.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "src/geometry/monotone_chain.h"
#include "src/layers/pairs/exact_volume.h"
#include "src/math/longest_axis.h"

namespace sightline::layers {
namespace {

constexpr double kSqrt3 = 1.7320508075688774;
constexpr double kRoundUp = 1.0 + 0x1p-20;

// A point without the coordinate in which its plane's normal is largest.
struct FlatPoint {
  double x = 0.0, y = 0.0;
  std::uint32_t number = 0;
};

double turn(const FlatPoint& a, const FlatPoint& b, const FlatPoint& c) {
  return exactArea(a.x, a.y, b.x, b.y, c.x, c.y);
}

double distance(const FlatPoint& a, const FlatPoint& b) {
  return std::hypot(b.x - a.x, b.y - a.y);
}

std::vector<FlatPoint> flattened(std::span<const Vec3d> points, const Vec3d& normal) {
  const int dropped = math::longestAxis(abs(normal));
  std::vector<FlatPoint> flat;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    flat.push_back({points[i][(dropped + 1) % 3], points[i][(dropped + 2) % 3], i});
  }
  return flat;
}

// Returns the outline's corners in order around it, by exact turns.
std::vector<FlatPoint> outlineOf(std::vector<FlatPoint> flat) {
  std::sort(flat.begin(), flat.end(), [](const FlatPoint& a, const FlatPoint& b) {
    return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.number < b.number;
  });
  const auto same = [](const FlatPoint& a, const FlatPoint& b) { return a.x == b.x && a.y == b.y; };
  flat.erase(std::unique(flat.begin(), flat.end(), same), flat.end());
  return geometry::convexHull(std::move(flat), [](const FlatPoint& a, const FlatPoint& b,
                                                  const FlatPoint& c) { return turn(a, b, c) > 0.0; });
}

// Keeps the corners that stand out by more than the tolerance from the chord of those kept (Douglas, Peucker
// 1973). The rest of a convex outline is convex. left_out: receives the greatest height of a corner that is
// left out.
class OutlineThinner {
 public:
  OutlineThinner(const std::vector<FlatPoint>& outline, double tolerance)
      : outline_(outline), tolerance_(tolerance), keep_(outline.size(), 0) {}

  std::vector<FlatPoint> thin(std::size_t first, std::size_t second, double& left_out) {
    std::vector<std::pair<std::size_t, std::size_t>> arcs{{first, second}, {second, first + outline_.size()}};
    keep_[first] = keep_[second] = 1;
    left_out = 0.0;
    while (!arcs.empty()) {
      const auto [from, to] = arcs.back();
      arcs.pop_back();
      std::size_t corner = from;
      const double max_height = maxHeight(from, to, corner);
      if (max_height <= tolerance_) {
        left_out = std::max(left_out, max_height);
        continue;
      }
      keep_[corner % outline_.size()] = 1;
      arcs.emplace_back(from, corner);
      arcs.emplace_back(corner, to);
    }
    std::vector<FlatPoint> kept;
    for (std::size_t i = 0; i < outline_.size(); ++i) {
      if (keep_[i] != 0) {
        kept.push_back(outline_[i]);
      }
    }
    return kept;
  }

 private:
  const FlatPoint& at(std::size_t i) const { return outline_[i % outline_.size()]; }

  double maxHeight(std::size_t from, std::size_t to, std::size_t& corner) const {
    double max_height = 0.0;
    const double chord = distance(at(from), at(to));
    for (std::size_t i = from + 1; i < to; ++i) {
      const double height = 1.03 * -turn(at(from), at(to), at(i)) / chord;
      if (height > max_height) {
        max_height = height;
        corner = i;
      }
    }
    return max_height;
  }

  const std::vector<FlatPoint>& outline_;
  double tolerance_ = 0.0;
  std::vector<std::uint8_t> keep_;
};

// Returns two corners that stand out clearly: the farthest from the middle, and the farthest from that one.
std::pair<std::size_t, std::size_t> clearCorners(const std::vector<FlatPoint>& outline,
                                                 const FlatPoint& middle) {
  const auto farthestFrom = [&outline](const FlatPoint& p) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < outline.size(); ++i) {
      if (distance(p, outline[i]) > distance(p, outline[best])) {
        best = i;
      }
    }
    return best;
  };
  const std::size_t first = farthestFrom(middle);
  const std::size_t second = farthestFrom(outline[first]);
  return std::minmax(first, second);
}

// Sets vertices, in the order of the points, and edges. ring: points in order around the outline, or the ends
// of a segment.
void setRing(ConvexHull& hull, std::span<const Vec3d> points, const std::vector<std::uint32_t>& ring,
             std::vector<std::uint32_t>& sorted) {
  sorted = ring;
  std::sort(sorted.begin(), sorted.end());
  const auto vertexOf = [&sorted](std::uint32_t number) {
    return static_cast<std::uint32_t>(std::lower_bound(sorted.begin(), sorted.end(), number) -
                                      sorted.begin());
  };
  std::vector<std::array<std::uint32_t, 2>> around(ring.size());
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const std::uint32_t before = vertexOf(ring[(i + ring.size() - 1) % ring.size()]);
    const std::uint32_t after = vertexOf(ring[(i + 1) % ring.size()]);
    around[vertexOf(ring[i])] = {std::min(before, after), std::max(before, after)};
  }
  hull.first_neighbour.push_back(0);
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    hull.vertices.push_back(points[sorted[i]]);
    for (std::size_t k = 0; k < 2 && k + 1 < ring.size(); ++k) {
      hull.neighbours.push_back(around[i][k]);
    }
    hull.first_neighbour.push_back(static_cast<std::uint32_t>(hull.neighbours.size()));
  }
}

// A point's distance from the segment is at most twice the greatest distance of a point from the measured
// line, since the ends may lie on opposite sides of it.
std::vector<std::uint32_t> segmentEnds(std::span<const Vec3d> points, const HullFrame& frame) {
  const auto along = [&](std::uint32_t i) { return dot(points[i] - frame.origin, frame.along); };
  std::uint32_t low = 0;
  std::uint32_t high = 0;
  for (std::uint32_t i = 1; i < points.size(); ++i) {
    low = along(i) < along(low) ? i : low;
    high = along(i) > along(high) ? i : high;
  }
  return {low, high};
}

}  // namespace

ConvexHull flatHull(std::span<const Vec3d> points, const HullFrame& frame,
                    std::vector<std::uint32_t>& numbers) {
  // Error of distances from the frame's line and plane.
  const double rounding = frame.extent * 0x1p-48;
  ConvexHull hull;
  if (frame.dimension == 0) {
    hull.dimension = 0;
    setRing(hull, points, {0}, numbers);
    hull.slack = 2.0 * kRoundUp * frame.extent;
  } else if (frame.dimension == 1) {
    hull.dimension = 1;
    setRing(hull, points, segmentEnds(points, frame), numbers);
    hull.slack = 2.0 * (frame.off_line + rounding);
  } else {
    // The distance of a point from the polygon below or above it is at most the points' greatest difference
    // of height along the dropped axis, which is at most sqrt(3) times that along the normal.
    std::vector<FlatPoint> flat = flattened(points, frame.normal);
    const FlatPoint middle = flattened(std::span(&frame.middle, 1), frame.normal)[0];
    const std::vector<FlatPoint> outline = outlineOf(std::move(flat));
    const auto [first, second] = clearCorners(outline, middle);
    double left_out = 0.0;
    std::vector<std::uint32_t> ring;
    for (const FlatPoint& p : OutlineThinner(outline, frame.tolerance).thin(first, second, left_out)) {
      ring.push_back(p.number);
    }
    setRing(hull, points, ring, numbers);
    // A polygon that is hardly wider than the tolerance may keep only the two ends of its longest chord. All
    // points are as close to their segment as they would be to a polygon.
    hull.dimension = ring.size() > 2 ? 2 : 1;
    hull.slack = kSqrt3 * (4.0 * (frame.off_plane + rounding) + left_out);
  }
  return hull;
}

}  // namespace sightline::layers
