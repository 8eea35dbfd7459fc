#include "src/layers/hull/hull_frame.h"

#include <algorithm>
#include <cmath>

namespace sightline::layers {
namespace {

constexpr double kExtentRounding = 0x1p-46;
constexpr double kCoordinateRounding = 0x1p-51;

struct Farthest {
  std::uint32_t point = 0;
  double value = 0.0;
};

// Finds the point of greatest value. Of points within the tolerance of it, it takes the one farthest from the
// middle, which is a corner if the points lie on a side or an edge.
template <typename Value>
Farthest farthestOf(std::span<const Vec3d> points, std::span<const std::uint32_t> chosen, const Vec3d& middle,
                    double tolerance, const Value& value) {
  double max_value = 0.0;
  for (const std::uint32_t i : chosen) {
    max_value = std::max(max_value, value(points[i]));
  }
  Farthest best{chosen[0], max_value};
  double best_distance = -1.0;
  for (const std::uint32_t i : chosen) {
    const double distance = length(points[i] - middle);
    if (distance > best_distance && value(points[i]) >= max_value - tolerance) {
      best.point = i;
      best_distance = distance;
    }
  }
  return best;
}

Vec3d without(const Vec3d& v, const Vec3d& unit) {
  return v - unit * dot(v, unit);
}

}  // namespace

HullFrame hullFrame(std::span<const Vec3d> points, std::span<const std::uint32_t> chosen) {
  HullFrame frame;
  double largest = 0.0;
  Vec3d sum;
  const Vec3d first = points[chosen[0]];
  for (const std::uint32_t i : chosen) {
    largest = std::max(largest, maxComponent(abs(points[i])));
    sum += points[i] - first;
  }
  frame.middle = first + sum / static_cast<double>(chosen.size());
  const auto find = [&](const auto& value) {
    return farthestOf(points, chosen, frame.middle, frame.tolerance, value);
  };
  frame.corners[0] = find([&](const Vec3d& p) { return length(p - frame.middle); }).point;
  frame.origin = points[frame.corners[0]];

  const Farthest end = find([&](const Vec3d& p) { return length(p - frame.origin); });
  frame.extent = end.value;
  frame.tolerance = kExtentRounding * frame.extent + kCoordinateRounding * largest;
  if (frame.extent <= frame.tolerance) {
    return frame;
  }
  frame.corners[1] = end.point;
  frame.along = normalized(points[end.point] - frame.origin);

  const Farthest side = find([&](const Vec3d& p) { return length(without(p - frame.origin, frame.along)); });
  frame.off_line = side.value;
  frame.dimension = 1;
  if (frame.off_line <= frame.tolerance) {
    return frame;
  }
  frame.corners[2] = side.point;
  const Vec3d rough = normalized(without(points[side.point] - frame.origin, frame.along));
  frame.across = normalized(without(rough, frame.along));
  frame.normal = normalized(cross(frame.along, frame.across));

  const Farthest top = find([&](const Vec3d& p) { return std::abs(dot(p - frame.origin, frame.normal)); });
  frame.off_plane = top.value;
  frame.dimension = frame.off_plane <= frame.tolerance ? 2 : 3;
  frame.corners[3] = top.point;
  return frame;
}

}  // namespace sightline::layers
