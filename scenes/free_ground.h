#pragma once

// Which places on the ground are still free, so that things neither stand in each other nor on the walk.

#include <span>
#include <vector>

#include "scenes/placement.h"

namespace sightline::scenes {

// A rectangle of any direction on the ground.
struct Footprint {
  Point2 middle;
  Point2 along{1.0, 0.0};  // unit vector
  double half_length = 1.0, half_width = 1.0;

  Point2 at(double length_part, double width_part) const {
    return middle + along * (half_length * length_part) +
           Point2{-along.y, along.x} * (half_width * width_part);
  }
  double distance(Point2 p) const;  // 0 inside
};
bool overlaps(const Footprint& a, const Footprint& b);

// Distance from a point to a polyline on the ground; heights are ignored.
double distanceToLine(Point2 p, std::span<const Vec3d> line);

class FreeGround {
 public:
  // Keeps everything at least half_width away from the line.
  void keepLine(std::span<const Vec3d> line, double half_width);
  void takeCircle(Point2 middle, double radius) { circles_.push_back({middle, radius}); }
  void takeFootprint(const Footprint& footprint) { footprints_.push_back(footprint); }

  bool isFree(Point2 middle, double radius) const;
  bool isFree(const Footprint& footprint) const;
  // Takes the circle if it is free.
  bool tryCircle(Point2 middle, double radius);
  bool tryFootprint(const Footprint& footprint);

 private:
  struct Circle {
    Point2 middle;
    double radius;
  };
  struct Line {
    std::vector<Vec3d> points;
    double half_width;
  };
  std::vector<Line> lines_;
  std::vector<Circle> circles_;
  std::vector<Footprint> footprints_;
};

}  // namespace sightline::scenes
