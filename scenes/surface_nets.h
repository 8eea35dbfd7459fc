#pragma once

// The surface between the inside and the outside of a solid that a function describes.
// Based on: Sarah F. F. Gibson. Constrained elastic surface nets. MICCAI 1998; without its relaxation: each
// cell's vertex is the mean of the crossings of its edges.

#include <array>
#include <cstdint>
#include <vector>

#include "sightline/math/vec3.h"

namespace sightline::scenes {

// Values at the points of a grid: positive in the solid, negative in free space.
struct ValueGrid {
  Vec3d origin;
  double cell = 1.0;                      // side of a cell, metres
  std::array<std::uint32_t, 3> points{};  // number of grid points along each axis
  std::vector<float> values{};            // points[0] * points[1] * points[2], x fastest

  std::size_t index(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    return (std::size_t{z} * points[1] + y) * points[0] + x;
  }
  Vec3d point(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    return origin + Vec3d(x, y, z) * cell;
  }
};

// Leaves of the free space only what is connected to the grid point nearest to `start`, and of the solid only
// what is connected to the grid's border; the rest changes sides. All points on the border become solid.
void keepConnected(ValueGrid& grid, const Vec3d& start);

// Fills free points, until no face of a cell has two free corners and two solid ones that lie crosswise:
// there four quads would share an edge. May divide the free space.
void fillPinches(ValueGrid& grid);

struct SurfaceNet {
  std::vector<Vec3d> points{};
  std::vector<std::array<std::uint32_t, 4>> quads{};  // counter-clockwise as seen from free space
};
// The whole surface; it is closed if all points on the grid's border are solid. Each edge belongs to as many
// quads in one direction as in the other: to one in each if there are no pinches.
SurfaceNet surfaceNet(const ValueGrid& grid);

}  // namespace sightline::scenes
