#pragma once

// The dimension of a set of points, and corners that span it.

#include <array>
#include <cstdint>
#include <span>

#include "sightline/math/vec3.h"

namespace sightline::layers {

// Corners are clearly extreme points: of points that are about equally far along a direction, the one
// farthest from the middle. Axes are orthonormal up to rounding, also for points that are nearly on a line.
struct HullFrame {
  int dimension = 0;
  std::array<std::uint32_t, 4> corners{};  // dimension + 1 of them
  Vec3d middle;                            // about the mean of the points
  Vec3d origin, along, across, normal;     // corners[0], and one axis per dimension
  double tolerance = 0.0;                  // distances up to this count as rounding error
  double extent = 0.0;                     // greatest distance of a point from the origin, up to rounding
  double off_line = 0.0, off_plane = 0.0;  // greatest distances from the line and from the plane
};

// Finds the frame of some points.
// points: at least one, with coordinates of at most 1. chosen: numbers of the points to use. The tolerance is
// 2^-46 of the extent plus 2^-51 of the largest coordinate, which is the error of points that have been
// rotated and moved into place.
HullFrame hullFrame(std::span<const Vec3d> points, std::span<const std::uint32_t> chosen);

}  // namespace sightline::layers
