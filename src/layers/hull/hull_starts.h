#pragma once

// Vertices from which a search uphill has few steps left, for searches that know no better one.

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sightline/layers/hull.h"

namespace sightline::layers {

// The number of a direction's cell: each side of a cube around the hull's box, scaled to unit size, has
// kStartCells * kStartCells cells, so that long hulls are divided as finely as round ones.
inline constexpr std::size_t kStartCells = 4;
inline constexpr std::size_t kStarts = 6 * kStartCells * kStartCells;

inline std::size_t startCell(const Vec3d& direction, const Vec3d& size) {
  const std::array<double, 3> d{direction.x * size.x, direction.y * size.y, direction.z * size.z};
  const double x = std::abs(d[0]), y = std::abs(d[1]), z = std::abs(d[2]);
  const std::size_t main = x >= y && x >= z ? 0 : y >= z ? 1 : 2;
  const double length = std::abs(d[main]);
  const auto along = [&](double value) {
    return static_cast<std::size_t>(value >= -0.5 * length) + static_cast<std::size_t>(value >= 0.0) +
           static_cast<std::size_t>(value >= 0.5 * length);
  };
  const std::size_t side = 2 * main + static_cast<std::size_t>(d[main] < 0.0);
  return (side * kStartCells + along(d[(main + 1) % 3])) * kStartCells + along(d[(main + 2) % 3]);
}

// Fills in ConvexHull::starts and start_size of a hull on which searches go uphill; leaves others without.
// The start of a direction's cell is lower than the farthest vertex by at most the largest of the direction's
// components times size: the middle of the cell differs by a quarter of it along two axes, and two vertices
// by twice the size.
void findStarts(ConvexHull& hull);

}  // namespace sightline::layers
