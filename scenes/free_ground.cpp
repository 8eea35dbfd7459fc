#include "scenes/free_ground.h"

#include <algorithm>
#include <cmath>

namespace sightline::scenes {
namespace {

double squareToLeg(Point2 p, Point2 a, Point2 b) {
  const Point2 d = b - a;
  const double square = dot(d, d);
  const double t = square > 0.0 ? std::clamp(dot(p - a, d) / square, 0.0, 1.0) : 0.0;
  const Point2 between = p - (a + d * t);
  return dot(between, between);
}

// True if a side of the first footprint separates the two.
bool isSeparated(const Footprint& a, const Footprint& b) {
  const Point2 across{-a.along.y, a.along.x}, between = b.middle - a.middle;
  const auto reach = [&](Point2 axis) {
    return std::abs(dot(axis, b.along)) * b.half_length + std::abs(cross(axis, b.along)) * b.half_width;
  };
  return std::abs(dot(between, a.along)) > a.half_length + reach(a.along) ||
         std::abs(dot(between, across)) > a.half_width + reach(across);
}

}  // namespace

double Footprint::distance(Point2 p) const {
  const Point2 from = p - middle;
  const double x = std::max(std::abs(dot(from, along)) - half_length, 0.0);
  const double y = std::max(std::abs(cross(along, from)) - half_width, 0.0);
  return length(Point2{x, y});
}

bool overlaps(const Footprint& a, const Footprint& b) {
  return !isSeparated(a, b) && !isSeparated(b, a);
}

double distanceToLine(Point2 p, std::span<const Vec3d> line) {
  double nearest = 1e60;  // square of the distance: one root for all legs
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    nearest = std::min(nearest, squareToLeg(p, {line[i].x, line[i].y}, {line[i + 1].x, line[i + 1].y}));
  }
  return std::sqrt(nearest);
}

void FreeGround::keepLine(std::span<const Vec3d> line, double half_width) {
  lines_.push_back({{line.begin(), line.end()}, half_width});
}

bool FreeGround::isFree(Point2 middle, double radius) const {
  const auto touches = [&](const Circle& c) {
    const Point2 between = c.middle - middle;
    const double reach = c.radius + radius;
    return dot(between, between) < reach * reach;
  };
  return std::none_of(circles_.begin(), circles_.end(), touches) &&
         std::none_of(footprints_.begin(), footprints_.end(),
                      [&](const Footprint& f) { return f.distance(middle) < radius; }) &&
         std::none_of(lines_.begin(), lines_.end(), [&](const Line& line) {
           return distanceToLine(middle, line.points) < line.half_width + radius;
         });
}

bool FreeGround::isFree(const Footprint& footprint) const {
  if (std::any_of(footprints_.begin(), footprints_.end(),
                  [&](const Footprint& f) { return overlaps(f, footprint); }) ||
      std::any_of(circles_.begin(), circles_.end(),
                  [&](const Circle& c) { return footprint.distance(c.middle) < c.radius; })) {
    return false;
  }
  // Points in steps of less than a metre stand for the whole rectangle.
  const auto steps = static_cast<int>(2.0 * std::max(footprint.half_length, footprint.half_width)) + 2;
  const double half_diagonal = length(Point2{footprint.half_length, footprint.half_width});
  for (const Line& line : lines_) {
    // No point is nearer to the line than the middle by more than half the diagonal.
    if (distanceToLine(footprint.middle, line.points) > line.half_width + half_diagonal + 1e-6) {
      continue;
    }
    for (int i = 0; i <= steps; ++i) {
      for (int k = 0; k <= steps; ++k) {
        const Point2 p = footprint.at(2.0 * i / steps - 1.0, 2.0 * k / steps - 1.0);
        if (distanceToLine(p, line.points) < line.half_width) {
          return false;
        }
      }
    }
  }
  return true;
}

bool FreeGround::tryCircle(Point2 middle, double radius) {
  const bool free = isFree(middle, radius);
  if (free) {
    takeCircle(middle, radius);
  }
  return free;
}

bool FreeGround::tryFootprint(const Footprint& footprint) {
  const bool free = isFree(footprint);
  if (free) {
    takeFootprint(footprint);
  }
  return free;
}

}  // namespace sightline::scenes
