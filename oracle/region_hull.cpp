#include "oracle/region_hull.h"

#include <algorithm>
#include <cmath>

namespace sightline {
namespace {

constexpr double kSideMargin = 0x1p-42;  // of a region's sides, of the coordinates; far above rounding
constexpr double kFarthest = 0x1p200;    // metres
constexpr std::array<double, kSightLines> kPlaces{0.5087, 0.2713, 0.7391};

}  // namespace

DoubleBox boxOf(const Corners& t) {
  return {min(min(t.a, t.b), t.c), max(max(t.a, t.b), t.c)};
}

bool apart(const DoubleBox& a, const DoubleBox& b, double distance) {
  const Vec3d gap = max(max(b.min - a.max, a.min - b.max), Vec3d{});
  return std::sqrt(dot(gap, gap)) > distance * (1.0 + 1e-9) + 0x1p-50 * (sizeOf(a.min) + sizeOf(b.max));
}

std::vector<Vec3d> hullOf(const EyeRegion& region) {
  std::vector<Vec3d> points;
  const DoubleBox box{region.min, region.max};
  if (region.sides.size() != 1) {
    for (std::uint32_t i = 0; i < 8; ++i) {
      points.push_back(box.corner(i));  // more sides than one only make the region smaller
    }
    return points;
  }
  const HalfSpace& side = region.sides[0];
  const double margin = kSideMargin * (sizeOf(box.min) + sizeOf(box.max) + std::abs(side.offset));
  const auto above = [&](std::uint32_t i) {
    return dot(side.normal, box.corner(i)) - (side.offset - margin);
  };
  for (std::uint32_t i = 0; i < 8; ++i) {
    if (above(i) < 0.0) {
      continue;  // and not where it is not a number: only then is the point surely without eyes
    }
    points.push_back(box.corner(i));
    for (const std::uint32_t axis : {1u, 2u, 4u}) {
      const std::uint32_t other = i ^ axis;
      if (above(other) < 0.0) {
        const double share = std::min(1.0, (above(i) + margin) / (above(i) - above(other)));
        points.push_back(box.corner(i) + (box.corner(other) - box.corner(i)) * share);
      }
    }
  }
  return points;
}

std::array<Vec3d, kSightLines> startsIn(const std::vector<Vec3d>& hull) {
  std::array<Vec3d, kSightLines> starts{};
  for (std::size_t line = 0; line < kSightLines; ++line) {
    double sum = 0.0;
    Vec3d moved{};
    for (std::size_t i = 0; i < hull.size(); ++i) {
      const double weight = kPlaces[(line + i) % kSightLines] + kPlaces[(line * i) % kSightLines];
      sum += weight;
      moved = moved + (hull[i] - hull[0]) * weight;
    }
    starts[line] = hull[0] + moved * (1.0 / sum);
  }
  return starts;
}

std::array<Vec3d, kSightLines> endsIn(const DoubleBox& box) {
  std::array<Vec3d, kSightLines> ends{};
  const Vec3d e = box.max - box.min;
  for (std::size_t line = 0; line < kSightLines; ++line) {
    const std::size_t i = 2 * line;
    ends[line] = {box.min.x + e.x * kPlaces[i % kSightLines],
                  box.min.y + e.y * kPlaces[(i + 1) % kSightLines],
                  box.min.z + e.z * kPlaces[(i + i / kSightLines) % kSightLines]};
  }
  return ends;
}

bool isNear(const Vec3d& p) {
  return std::abs(p.x) <= kFarthest && std::abs(p.y) <= kFarthest && std::abs(p.z) <= kFarthest;
}

}  // namespace sightline
