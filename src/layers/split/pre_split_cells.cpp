// The cells to which meshes are clipped, and the planes between them.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "sightline/layers/pre_split.h"

namespace sightline {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Direction2 {
  double x, y;
};

// Returns the unit vector at a fraction of a full turn. Uses only sums and products, so the bits are the same
// on every machine: a Taylor series for at most an eighth of a turn, accurate to the last bit or two, and
// exact quarter turns.
Direction2 atTurns(double turns) {
  const double quarters = std::floor(turns * 4.0 + 0.5);
  const double a = (turns - quarters * 0.25) * (2.0 * std::numbers::pi);
  double cosine = 1.0, sine = 1.0;
  for (int k = 8; k >= 1; --k) {
    cosine = 1.0 - cosine * a * a / static_cast<double>((2 * k - 1) * (2 * k));
    sine = 1.0 - sine * a * a / static_cast<double>((2 * k) * (2 * k + 1));
  }
  sine *= a;
  switch (static_cast<long long>(quarters) & 3) {
    case 0:
      return {cosine, sine};
    case 1:
      return {-sine, cosine};
    case 2:
      return {-cosine, -sine};
    default:
      return {sine, -cosine};
  }
}

// Returns slab `index` of `count`. The common bound of two neighbours has the same bits in both.
CellSlab slabOf(double low, double high, std::uint32_t index, std::uint32_t count) {
  const auto at = [&](std::uint32_t i) { return low + (high - low) * (static_cast<double>(i) / count); };
  return {index == 0 ? -kInfinity : at(index), index + 1 == count ? kInfinity : at(index + 1)};
}

// Returns the plane through the axis with the angles from `turns` to half a turn more in front.
Plane axisPlane(const SplitCells& cells, double turns) {
  const Direction2 d = atTurns(turns);
  const Vec3d normal = cells.quarter * d.x - cells.zero * d.y;
  return {normal, -dot(normal, cells.axis_point)};
}

// Returns a plane through the axis between two sectors. Sector `second` begins `ahead` sectors after `first`.
// Let t be an angle in sectors, measured from the beginning of `first`. A line at t has `first` behind it for
// 1 <= t <= n / 2, and `second` in front for ahead + 1 - n / 2 <= t <= ahead. The middle of the common range
// is used, which for neighbours is exactly their border.
Plane sectorPlane(const SplitCells& cells, std::uint32_t first, std::uint32_t second) {
  const double n = cells.sectors;
  const double ahead = (second + cells.sectors - first) % cells.sectors;
  const double low = std::max(1.0, ahead + 1.0 - 0.5 * n), high = std::min(ahead, 0.5 * n);
  return axisPlane(cells, std::fmod(first + 0.5 * (low + high), n) / n).flipped();
}

// The middle of a hexagon along the grid's three directions, in halves of a hexagon's width. The first
// direction is u, the others are at 60 and 120 degrees from it.
struct HexagonPlace {
  long long along[3];
};

HexagonPlace hexagonAt(long long column, long long row) {
  // The distance of rows is 1.5 sides; odd rows are shifted by half a width along u.
  const long long first = 2 * column + (row & 1);
  return {{first, (first + 3 * row) / 2, (3 * row - first) / 2}};
}

// Whether the rectangle intersects the closed hexagon, by the slabs of both shapes' sides (separating axes).
bool intersectsRectangle(const HexagonOptions& o, const HexagonPlace& place) {
  const double half = 0.5 * o.width, radius = o.width / std::numbers::sqrt3;
  const double middle_u = half * static_cast<double>(place.along[0]);
  const double middle_v = 0.5 * radius * static_cast<double>(place.along[1] + place.along[2]);
  // Hexagons that nearly touch count, too; one too many does no harm.
  const double slack = 1e-9 * o.width;
  if (middle_u - half > o.high_u + slack || middle_u + half < o.low_u - slack ||
      middle_v - radius > o.high_v + slack || middle_v + radius < o.low_v - slack) {
    return false;
  }
  for (int k = 1; k < 3; ++k) {
    const double cosine = k == 1 ? 0.5 : -0.5, sine = 0.5 * std::numbers::sqrt3;
    const double low = std::min(o.low_u * cosine, o.high_u * cosine) + o.low_v * sine;
    const double high = std::max(o.low_u * cosine, o.high_u * cosine) + o.high_v * sine;
    const double middle = half * static_cast<double>(place.along[k]);
    if (middle - half > high + slack || middle + half < low - slack) {
      return false;
    }
  }
  return true;
}

}  // namespace

SplitCells gridCells(std::span<const SplitAxis> axes) {
  SplitCells cells;
  cells.count = 1;
  for (const SplitAxis& axis : axes) {
    const std::uint32_t count = std::max(axis.count, 1u);
    cells.directions.push_back(normalized(axis.direction));
    cells.widths.push_back((axis.high - axis.low) / count);
    cells.count *= count;
  }
  for (std::uint32_t c = 0; c < cells.count; ++c) {
    std::uint32_t rest = c;
    for (const SplitAxis& axis : axes) {
      const std::uint32_t count = std::max(axis.count, 1u);
      cells.slabs.push_back(slabOf(axis.low, axis.high, rest % count, count));
      rest /= count;
    }
  }
  return cells;
}

SplitCells cylinderCells(const CylinderOptions& options) {
  SplitCells cells;
  const Vec3d axis = normalized(options.axis);
  const double foot = dot(axis, options.axis_point);
  cells.directions = {axis};
  cells.widths = {(options.high - options.low) / options.slices};
  cells.sectors = options.sectors;
  cells.axis_point = options.axis_point;
  cells.zero = normalized(options.zero - axis * dot(options.zero, axis));
  cells.quarter = cross(axis, cells.zero);
  cells.sector_width =
      options.sectors < 2 ? 2.0 * options.radius : 2.0 * options.radius * atTurns(0.5 / options.sectors).y;
  cells.count = options.sectors * options.slices;
  for (std::uint32_t slice = 0; slice < options.slices; ++slice) {
    for (std::uint32_t sector = 0; sector < options.sectors; ++sector) {
      cells.slabs.push_back(slabOf(foot + options.low, foot + options.high, slice, options.slices));
      cells.sector_of.push_back(sector);
    }
  }
  return cells;
}

SplitCells hexagonCells(const HexagonOptions& options) {
  SplitCells cells;
  for (const Direction2 d :
       {Direction2{1.0, 0.0}, {0.5, 0.5 * std::numbers::sqrt3}, {-0.5, 0.5 * std::numbers::sqrt3}}) {
    cells.directions.push_back(options.u * d.x + options.v * d.y);
    cells.widths.push_back(options.width);
  }
  const double half = 0.5 * options.width, row_height = 0.5 * std::numbers::sqrt3 * options.width;
  const auto first_row = static_cast<long long>(std::floor(options.low_v / row_height)) - 1;
  const auto last_row = static_cast<long long>(std::ceil(options.high_v / row_height)) + 1;
  const auto first_column = static_cast<long long>(std::floor(options.low_u / options.width)) - 1;
  const auto last_column = static_cast<long long>(std::ceil(options.high_u / options.width)) + 1;
  for (long long row = first_row; row <= last_row; ++row) {
    for (long long column = first_column; column <= last_column; ++column) {
      const HexagonPlace place = hexagonAt(column, row);
      if (!intersectsRectangle(options, place)) {
        continue;
      }
      for (std::size_t k = 0; k < 3; ++k) {
        const double base = dot(options.origin, cells.directions[k]);
        cells.slabs.push_back({base + half * static_cast<double>(place.along[k] - 1),
                               base + half * static_cast<double>(place.along[k] + 1)});
      }
      ++cells.count;
    }
  }
  return cells;
}

std::vector<Plane> cellPlanes(const SplitCells& cells, std::uint32_t cell, double inflation) {
  std::vector<Plane> planes;
  const std::size_t directions = cells.directions.size();
  for (std::size_t d = 0; d < directions; ++d) {
    const CellSlab& slab = cells.slabs[cell * directions + d];
    const double out = 0.5 * inflation * cells.widths[d];
    if (slab.low > -kInfinity) {
      planes.push_back({cells.directions[d], -(slab.low - out)});
    }
    if (slab.high < kInfinity) {
      planes.push_back({-cells.directions[d], slab.high + out});
    }
  }
  if (cells.sectors > 1) {
    const double n = cells.sectors, out = 0.5 * inflation * cells.sector_width;
    const std::uint32_t sector = cells.sector_of[cell];
    planes.push_back(axisPlane(cells, sector / n));
    planes.back().offset += out;
    // Each of two sectors is a half space, with a single plane.
    if (cells.sectors > 2) {
      planes.push_back(axisPlane(cells, (sector + 1) % cells.sectors / n).flipped());
      planes.back().offset += out;
    }
  }
  return planes;
}

Plane planeBetween(const SplitCells& cells, std::uint32_t first, std::uint32_t second) {
  const std::size_t directions = cells.directions.size();
  Plane best;
  double best_gap = -kInfinity;
  for (std::size_t d = 0; d < directions; ++d) {
    const CellSlab& a = cells.slabs[first * directions + d];
    const CellSlab& b = cells.slabs[second * directions + d];
    const double above = a.low - b.high, below = b.low - a.high;
    if (above >= 0.0 && above > best_gap) {
      best_gap = above;
      best = {cells.directions[d], -(b.high + 0.5 * above)};
    }
    if (below >= 0.0 && below > best_gap) {
      best_gap = below;
      best = {-cells.directions[d], a.high + 0.5 * below};
    }
  }
  if (best_gap < 0.0) {
    best = sectorPlane(cells, cells.sector_of[first], cells.sector_of[second]);
  }
  return best;
}

}  // namespace sightline
