#pragma once

// How many dimensions some points fill, and corners that span them.

#include <array>
#include <cstdint>
#include <span>

#include "sightline/math/vec3.h"

namespace sightline::layers {

// Corners are extreme points, clearly so: of those that are about equally far along, the one farthest from
// the middle. Axes are orthonormal up to rounding even where the points are nearly on a line.
struct HullFrame {
  int dimension = 0;
  std::array<std::uint32_t, 4> corners{};  // dimension + 1 of them
  Vec3d middle;                            // about the mean
  Vec3d origin, along, across, normal;     // corners[0], and axes as far as there are dimensions
  double tolerance = 0.0;                  // what counts as rounding
  double extent = 0.0;                     // no point is farther from the origin, up to rounding
  double off_line = 0.0, off_plane = 0.0;  // nor than this from the line and the plane
};

// points: at least one, coordinates of at most 1. chosen: numbers of those to look at.
//
// Rounding: 2^-46 of the extent, and 2^-51 of the largest coordinate, which is what points are off by that
// were turned and moved to where they are.
HullFrame hullFrame(std::span<const Vec3d> points, std::span<const std::uint32_t> chosen);

}  // namespace sightline::layers
