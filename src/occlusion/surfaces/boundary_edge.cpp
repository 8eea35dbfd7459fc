#include "src/occlusion/surfaces/boundary_edge.h"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/occlusion/surfaces/boundary_edge.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sightline::occlusion {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// An edge in each lane. Coordinates are whole numbers of less than 2^53, for which doubles are exact.
using Doubles = hn::CappedTag<double, kMostLanes>;
using DoublesV = hn::Vec<Doubles>;
inline constexpr Doubles kDoubles;

constexpr double kSteepest = 256.0;  // pixels a row
constexpr double kPixel = kGridStep, kMargin = BoundaryEdge::kMargin, kBeyond = BoundaryEdge::kBeyond;

// What was computed of the edges of a vector.
struct Prepared {
  HWY_ALIGN double x[kMostLanes], slope[kMostLanes];
  HWY_ALIGN float left[kMostLanes], right[kMostLanes], reach_left[kMostLanes], reach_right[kMostLanes],
      doubt[kMostLanes], end_doubt[kMostLanes];
  HWY_ALIGN std::int32_t bottom[kMostLanes], top[kMostLanes], first_row[kMostLanes], last_row[kMostLanes],
      first_crossed[kMostLanes], end_crossed[kMostLanes], first_whole[kMostLanes], end_whole[kMostLanes],
      first_tile[kMostLanes], last_tile[kMostLanes], kind[kMostLanes], falls[kMostLanes],
      rightwards[kMostLanes], matters[kMostLanes];

  static std::int16_t narrow(std::int32_t v) { return static_cast<std::int16_t>(v); }
  BoundaryEdge edge(std::size_t i) const {
    return {.x = x[i],
            .slope = slope[i],
            .left = left[i],
            .right = right[i],
            .reach_left = reach_left[i],
            .reach_right = reach_right[i],
            .doubt = doubt[i],
            .end_doubt = end_doubt[i],
            .bottom = bottom[i],
            .top = top[i],
            .first_row = narrow(first_row[i]),
            .last_row = narrow(last_row[i]),
            .first_crossed = narrow(first_crossed[i]),
            .end_crossed = narrow(end_crossed[i]),
            .first_whole = narrow(first_whole[i]),
            .end_whole = narrow(end_whole[i]),
            .first_tile = narrow(first_tile[i]),
            .last_tile = narrow(last_tile[i]),
            .kind = static_cast<EdgeSlope>(kind[i]),
            .falls = falls[i] != 0,
            .rightwards = rightwards[i] != 0,
            .matters = matters[i] != 0};
  }
};

HWY_INLINE DoublesV set(double v) {
  return hn::Set(kDoubles, v);
}
HWY_INLINE DoublesV clamp(DoublesV v, double least, double most) {
  return hn::Min(hn::Max(v, set(least)), set(most));
}
HWY_INLINE void store(DoublesV v, float* to) {
  const hn::Rebind<float, Doubles> d;
  hn::Store(hn::DemoteTo(d, v), d, to);
}
// Whole numbers that have been clamped.
HWY_INLINE void store(DoublesV v, std::int32_t* to) {
  const hn::Rebind<std::int32_t, Doubles> d;
  hn::Store(hn::DemoteTo(d, v), d, to);
}
HWY_INLINE void store(hn::Mask<Doubles> mask, std::int32_t* to) {
  store(hn::IfThenElseZero(mask, set(1.0)), to);
}

// The rows that the edges cross and may touch. Returns the first ones that they may touch.
HWY_INLINE DoublesV prepareRows(DoublesV bottom, DoublesV top, DoublesV touched_bottom, DoublesV touched_top,
                                const EdgeBuffer& buffer, Prepared& out) {
  const double end_y = buffer.height * kPixel;
  store(clamp(bottom, 0.0, end_y), out.bottom);
  store(clamp(top, 0.0, end_y), out.top);
  const auto rowOf = [&](DoublesV y) HWY_ATTR {
    return clamp(hn::Floor(hn::Mul(y, set(1.0 / kPixel))), 0.0, buffer.height);
  };
  // The first row whose middle is not below a point.
  const auto rowAfter = [&](DoublesV y) HWY_ATTR { return rowOf(hn::Add(y, set(0.5 * kPixel - 1.0))); };
  const auto first_row = rowOf(touched_bottom);
  store(first_row, out.first_row);
  store(rowOf(touched_top), out.last_row);
  store(rowAfter(bottom), out.first_crossed);
  store(rowAfter(top), out.end_crossed);
  store(rowOf(hn::Add(bottom, set(kPixel))), out.first_whole);
  store(rowOf(hn::Sub(top, set(1.0))), out.end_whole);
  return first_row;
}

// The places along rows, and the tiles, between which the edges may touch anything.
HWY_INLINE void prepareColumns(DoublesV left, DoublesV right, const EdgeBuffer& buffer, Prepared& out) {
  constexpr double kColumn = kPixel * kTileWidth;
  const double end_x = buffer.width * kPixel, columns = end_x / kColumn;
  // What single precision loses of a place is less than two units.
  const auto columnOf = [&](DoublesV x) HWY_ATTR {
    return clamp(hn::Floor(hn::Mul(x, set(1.0 / kColumn))), -1.0, std::floor(columns));
  };
  store(columnOf(hn::Sub(left, set(2.0))), out.first_tile);
  store(columnOf(hn::Add(right, set(2.0))), out.last_tile);
  store(hn::Max(left, set(-kBeyond)), out.left);
  store(clamp(right, -kBeyond, end_x + kBeyond), out.right);
}

// Which way the edges run, and where their lines cross the lower border of the tiles of their first row.
// Level edges have no slope.
HWY_INLINE void prepareLines(DoublesV from_x, DoublesV from_y, DoublesV dx, DoublesV dy, DoublesV slope,
                             DoublesV first_row, Prepared& out) {
  constexpr double kRow = kPixel * kTileHeight;
  const auto level = hn::Eq(dy, set(0.0));
  store(hn::Lt(dy, set(0.0)), out.falls);
  store(hn::Gt(dx, set(0.0)), out.rightwards);
  const auto kind =
      hn::IfThenElse(hn::Le(hn::Abs(slope), set(kSteepest)), set(static_cast<double>(EdgeSlope::kSteep)),
                     set(static_cast<double>(EdgeSlope::kFlat)));
  store(hn::IfThenElse(level, set(static_cast<double>(EdgeSlope::kLevel)), kind), out.kind);
  const auto tiles_y = hn::Mul(hn::Floor(hn::Mul(first_row, set(1.0 / kTileHeight))), set(kRow));
  const auto x = hn::Add(from_x, hn::Mul(hn::Sub(tiles_y, from_y), slope));
  hn::Store(hn::IfThenElse(level, from_y, x), kDoubles, out.x);
  hn::Store(slope, kDoubles, out.slope);
}

// How near to the edges it is unknown on which side of them a pixel's centre is. swept: how far they are
// swept.
HWY_INLINE void prepareDoubts(DoublesV dx, DoublesV dy, DoublesV steepness, DoublesV swept_x,
                              DoublesV swept_y, DoublesV widest, Prepared& out) {
  const auto level = hn::Eq(dy, set(0.0));
  const auto margin = set(kMargin);
  const auto over = [](DoublesV length) HWY_ATTR { return hn::Div(set(4.0 * kPixel), length); };
  const auto beside = hn::Mul(hn::Add(hn::Add(steepness, set(1.0)), over(hn::Abs(dy))), margin);
  const auto along = hn::Mul(margin, hn::Add(set(1.0), over(hn::Max(hn::Abs(dx), set(1.0)))));
  const auto doubt = hn::IfThenElse(level, along, hn::Min(widest, hn::Add(beside, set(2.0))));
  store(doubt, out.doubt);
  // Whether the line meets a pixel is known the less, the farther beyond the edge's ends it is: rounding an
  // end by a unit turns the line by up to a unit for each length of the edge. Where an edge is hardly longer
  // than that, its direction says nothing. Pixels: along the middle of a row, or of a level edge upwards.
  constexpr double kShort = 4.0;
  const auto on_line = [&](DoublesV swept, DoublesV length) HWY_ATTR {
    const auto lengths = hn::Div(hn::Add(swept, set(kPixel)), hn::Max(hn::Abs(length), set(1.0)));
    const auto known = hn::Add(set(0.5 * kPixel), hn::Mul(hn::Mul(set(3.0), margin), lengths));
    return hn::IfThenElse(hn::Lt(hn::Abs(length), set(kShort)), widest, known);
  };
  const auto meets_line = hn::IfThenElse(level, on_line(swept_x, dx),
                                         hn::Mul(hn::Add(steepness, set(1.0)), on_line(swept_y, dy)));
  const auto unswept = hn::Eq(hn::Max(swept_x, swept_y), set(0.0));
  store(hn::Min(widest, hn::Add(doubt, hn::IfThenZeroElse(unswept, meets_line))), out.end_doubt);
}

HWY_INLINE void prepareLanes(const GridLines& lines, const GridSweeps* sweeps, std::size_t at,
                             const EdgeBuffer& buffer, Prepared& out) {
  const double end_x = buffer.width * kPixel, end_y = buffer.height * kPixel;
  const auto from_x = hn::LoadU(kDoubles, lines.from_x.data() + at),
             from_y = hn::LoadU(kDoubles, lines.from_y.data() + at),
             to_x = hn::LoadU(kDoubles, lines.to_x.data() + at),
             to_y = hn::LoadU(kDoubles, lines.to_y.data() + at);
  // What is not to be used is moved to where it does no harm.
  const auto x0 = clamp(from_x, -kLargestGrid, kLargestGrid), x1 = clamp(to_x, -kLargestGrid, kLargestGrid),
             y0 = clamp(from_y, -kLargestGrid, kLargestGrid), y1 = clamp(to_y, -kLargestGrid, kLargestGrid);
  const auto bottom = hn::Min(y0, y1), top = hn::Max(y0, y1);
  const auto sweepOf = [&](const std::vector<double> GridSweeps::*side) HWY_ATTR {
    return sweeps == nullptr ? set(0.0) : hn::LoadU(kDoubles, (sweeps->*side).data() + at);
  };
  const auto leftwards = sweepOf(&GridSweeps::left), rightwards = sweepOf(&GridSweeps::right),
             downwards = sweepOf(&GridSweeps::down), upwards = sweepOf(&GridSweeps::up);
  const auto left = hn::Sub(hn::Min(x0, x1), hn::Add(leftwards, set(kMargin))),
             right = hn::Add(hn::Max(x0, x1), hn::Add(rightwards, set(kMargin)));
  const auto touched_bottom = hn::Sub(bottom, hn::Add(downwards, set(kMargin))),
             touched_top = hn::Add(top, hn::Add(upwards, set(kMargin)));
  store(hn::And(hn::And(hn::Ge(touched_top, set(0.0)), hn::Lt(touched_bottom, set(end_y))),
                hn::Lt(left, set(end_x))),
        out.matters);
  const auto first_row = prepareRows(bottom, top, touched_bottom, touched_top, buffer, out);
  prepareColumns(left, right, buffer, out);

  const auto dx = hn::Sub(to_x, from_x), dy = hn::Sub(to_y, from_y);
  const auto level = hn::Eq(dy, set(0.0));
  const auto slope = hn::IfThenZeroElse(level, hn::Div(dx, dy)), steepness = hn::Abs(slope);
  prepareLines(from_x, from_y, dx, dy, slope, first_row, out);
  const auto widest = set(2.0 * kBeyond + end_x);
  const auto reach = hn::Mul(hn::Add(steepness, set(3.0)), set(kMargin));
  const auto reachTo = [&](DoublesV swept) HWY_ATTR {
    return hn::IfThenElse(level, widest, hn::Min(widest, hn::Add(reach, swept)));
  };
  store(reachTo(sweepOf(&GridSweeps::left_of_line)), out.reach_left);
  store(reachTo(sweepOf(&GridSweeps::right_of_line)), out.reach_right);
  prepareDoubts(dx, dy, steepness, hn::Max(leftwards, rightwards), hn::Max(downwards, upwards), widest, out);
}

void prepareAll(const GridLines& lines, const GridSweeps* sweeps, const EdgeBuffer& buffer,
                std::span<BoundaryEdge> edges) {
  const std::size_t lanes = hn::Lanes(kDoubles);
  Prepared prepared;
  for (std::size_t first = 0; first < edges.size(); first += lanes) {
    prepareLanes(lines, sweeps, first, buffer, prepared);
    const std::size_t count = std::min(lanes, edges.size() - first);
    for (std::size_t i = 0; i < count; ++i) {
      edges[first + i] = prepared.edge(i);
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace sightline::occlusion
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::occlusion {

HWY_EXPORT(prepareAll);

void prepareEdges(const GridLines& lines, const GridSweeps* sweeps, const EdgeBuffer& buffer,
                  std::span<BoundaryEdge> edges) {
  HWY_DYNAMIC_DISPATCH(prepareAll)(lines, sweeps, buffer, edges);
}

}  // namespace sightline::occlusion
#endif
