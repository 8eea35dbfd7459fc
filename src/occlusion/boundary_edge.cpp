#include "src/occlusion/boundary_edge.h"

#include <algorithm>
#include <cmath>

namespace sightline::occlusion {
namespace {

constexpr double kSteepest = 256.0;  // pixels a row

// What is not to be used is moved to where it does no harm.
std::int64_t gridNumber(double v) {
  return static_cast<std::int64_t>(std::min(std::max(v, -kLargestGrid), kLargestGrid));
}

// The first row whose middle is not below a point.
std::int64_t rowAfter(std::int64_t y) {
  return (y + kGridStep / 2 - 1) >> kGridShift;
}

std::int16_t clamped(std::int64_t v, std::int64_t least, std::int64_t most) {
  return static_cast<std::int16_t>(std::min(std::max(v, least), most));
}

}  // namespace

BoundaryEdge prepareEdge(const GridPoint& from, const GridPoint& to, const EdgeBuffer& buffer) {
  constexpr std::int64_t kMargin = BoundaryEdge::kMargin, kBeyond = BoundaryEdge::kBeyond;
  constexpr std::int32_t kRowOfTiles = kGridShift + kTileHeightShift, kColumn = kGridShift + kTileWidthShift;
  const std::int64_t x0 = gridNumber(from.x), x1 = gridNumber(to.x), y0 = gridNumber(from.y),
                     y1 = gridNumber(to.y);
  const std::int64_t bottom = std::min(y0, y1), top = std::max(y0, y1);
  const std::int64_t left = std::min(x0, x1) - kMargin, right = std::max(x0, x1) + kMargin;
  const std::int64_t end_x = std::int64_t{buffer.width} << kGridShift,
                     end_y = std::int64_t{buffer.height} << kGridShift;
  BoundaryEdge edge{};
  edge.matters = top + kMargin >= 0 && bottom - kMargin < end_y && left < end_x;
  if (!edge.matters) {
    return edge;
  }
  edge.bottom = static_cast<std::int32_t>(std::max<std::int64_t>(bottom, 0));
  edge.top = static_cast<std::int32_t>(std::min(top, end_y));
  const std::int64_t end_row = buffer.height;
  edge.first_row = clamped((bottom - kMargin) >> kGridShift, 0, end_row);
  edge.last_row = clamped((top + kMargin) >> kGridShift, 0, end_row);
  edge.first_crossed = clamped(rowAfter(bottom), 0, end_row);
  edge.end_crossed = clamped(rowAfter(top), 0, end_row);
  // What single precision loses of a place is less than two units.
  const std::int64_t columns = end_x >> kColumn;
  edge.first_tile = clamped((left - 2) >> kColumn, -1, columns);
  edge.last_tile = clamped((right + 2) >> kColumn, -1, columns);
  edge.left = static_cast<float>(std::max(left, -kBeyond));
  edge.right = static_cast<float>(std::min(std::max(right, -kBeyond), end_x + kBeyond));
  const double dx = to.x - from.x, dy = to.y - from.y;
  edge.falls = dy < 0.0;
  edge.rightwards = dx > 0.0;
  constexpr double kPixel = kGridStep;
  const double widest = 2.0 * kBeyond + static_cast<double>(end_x);
  if (dy == 0.0) {
    edge.kind = EdgeSlope::kLevel;
    edge.x = from.y;
    edge.slope = 0.0;
    edge.reach = static_cast<float>(widest);
    edge.doubt = static_cast<float>(kMargin * (1.0 + 4.0 * kPixel / std::max(std::abs(dx), 1.0)));
    return edge;
  }
  edge.slope = dx / dy;
  const double steepness = std::abs(edge.slope);
  edge.kind = steepness <= kSteepest ? EdgeSlope::kSteep : EdgeSlope::kFlat;
  const auto tiles_y = static_cast<double>((edge.first_row >> kTileHeightShift) << kRowOfTiles);
  edge.x = from.x + (tiles_y - from.y) * edge.slope;
  edge.reach = static_cast<float>(std::min(widest, (steepness + 3.0) * kMargin));
  edge.doubt =
      static_cast<float>(std::min(widest, (steepness + 1.0 + 4.0 * kPixel / std::abs(dy)) * kMargin + 2.0));
  return edge;
}

}  // namespace sightline::occlusion
