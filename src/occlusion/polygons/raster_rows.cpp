#include "src/occlusion/polygons/raster_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/occlusion/polygons/raster_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sightline::occlusion {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// As many rows, or pixels, at a time; at most RowRuns::kRows.
using Lanes = hn::CappedTag<float, RowRuns::kRows>;
using Vector = hn::Vec<Lanes>;

constexpr float kFar = 1e9f;  // pixels, beyond any buffer
constexpr float kUntouched = std::numeric_limits<float>::infinity();

HWY_INLINE std::uint32_t laneCount() {
  return static_cast<std::uint32_t>(hn::Lanes(Lanes()));
}

// The first and last pixels, in each of some rows, that come within a margin of an edge; where there are none
// the first is beyond the last. No fused operations: they would round differently from one instruction set to
// another.
struct Crossing {
  Vector first, last;

  void store(const RasterBand& band, std::uint32_t row, RowRuns& runs) const {
    const Lanes d;
    const hn::RebindToSigned<Lanes> di;
    const auto width = hn::Set(d, static_cast<float>(band.width));
    const auto from = hn::Min(hn::Max(first, hn::Zero(d)), width);
    const auto to = hn::Max(hn::Min(last, hn::Sub(width, hn::Set(d, 1.0f))), hn::Set(d, -1.0f));
    hn::StoreU(hn::ConvertTo(di, from), di, runs.first + row);
    hn::StoreU(hn::ConvertTo(di, to), di, runs.last + row);
  }
};
HWY_INLINE Crossing cross(const BufferEdge& edge, float margin, Vector y) {
  const Lanes d;
  const auto m = hn::Set(d, margin);
  const auto low = hn::Set(d, edge.low), high = hn::Set(d, edge.high);
  const auto bottom = hn::Sub(y, m), top = hn::Add(y, hn::Set(d, 1.0f + margin));
  const auto left = hn::Set(d, edge.left), right = hn::Set(d, edge.right);
  auto min = left, max = right;
  if (!edge.flat()) {
    const auto slope = hn::Set(d, edge.slope), at_low = hn::Set(d, edge.x_at_low);
    const auto a = hn::Sub(hn::Max(bottom, low), low);
    const auto b = hn::Sub(hn::Min(top, high), low);
    const auto xa = hn::Add(at_low, hn::Mul(slope, a)), xb = hn::Add(at_low, hn::Mul(slope, b));
    min = hn::Max(hn::Min(xa, xb), left);
    max = hn::Min(hn::Max(xa, xb), right);
  }
  const auto intersects = hn::And(hn::Ge(top, low), hn::Le(bottom, high));
  return {hn::IfThenElse(intersects, hn::Floor(hn::Sub(min, m)), hn::Set(d, kFar)),
          hn::IfThenElse(intersects, hn::Floor(hn::Add(max, m)), hn::Set(d, -kFar))};
}

HWY_INLINE Vector rowsFrom(std::uint32_t y) {
  return hn::Add(hn::Set(Lanes(), static_cast<float>(y)), hn::Iota(Lanes(), 0.0f));
}

// Fills the polygon's reciprocal depth in the first pixel of each run. A row's bits must not depend on where
// the part begins.
void findAtFirst(std::uint32_t y, RasterScratch::Part& part) {
  for (std::uint32_t p = 0; p < part.polygon->plane_count; ++p) {
    const ReciprocalDepthPlane& plane = part.polygon->planes[p];
    for (std::uint32_t i = 0; i < RowRuns::kRows; ++i) {
      part.at_first[p][i] =
          static_cast<float>(plane.at_origin + plane.along_y * (y + i) + plane.along_x * part.runs.first[i]);
    }
  }
}

// A polygon's reciprocal depth along one row of a part.
struct RowReciprocalDepth {
  float at_first[BufferPolygon::kMaxPlanes], step[BufferPolygon::kMaxPlanes];
  float farthest = 0.0f;
  std::uint32_t planes = 0, first = 0;

  HWY_INLINE RowReciprocalDepth(const RasterScratch::Part& part, std::uint32_t row)
      : farthest(part.polygon->farthest),
        planes(part.polygon->plane_count),
        first(static_cast<std::uint32_t>(part.runs.first[row])) {
    for (std::uint32_t p = 0; p < planes; ++p) {
      at_first[p] = part.at_first[p][row];
      step[p] = static_cast<float>(part.polygon->planes[p].along_x);
    }
  }
  // Returns that of the pixels x, x + 1, ...
  HWY_INLINE Vector from(std::uint32_t x) const {
    const Lanes d;
    const auto offset = hn::Add(hn::Set(d, static_cast<float>(x - first)), hn::Iota(d, 0.0f));
    auto min = along(0, offset);
    for (std::uint32_t p = 1; p < planes; ++p) {
      min = hn::Min(min, along(p, offset));
    }
    return hn::Max(min, hn::Set(d, farthest));
  }

 private:
  HWY_INLINE Vector along(std::uint32_t p, Vector offset) const {
    const Lanes d;
    return hn::Add(hn::Set(d, at_first[p]), hn::Mul(hn::Set(d, step[p]), offset));
  }
};

// A run of pixels of one row.
struct Run {
  std::uint32_t first = 1, last = 0;

  static HWY_INLINE Run of(const RowRuns& runs, std::uint32_t row) {
    const bool some = runs.first[row] <= runs.last[row];
    return some ? Run{static_cast<std::uint32_t>(runs.first[row]), static_cast<std::uint32_t>(runs.last[row])}
                : Run{};
  }
};

// Calls body(x, mask) for the vectors of a run.
template <typename Body>
HWY_INLINE void forRun(Run run, Body&& body) {
  const Lanes d;
  for (std::uint32_t x = run.first; x <= run.last; x += laneCount()) {
    body(x, hn::FirstN(d, run.last - x + 1));
  }
}

// Finds the pixels that lie inside all edges, in RowRuns::kRows rows from y on.
void insideRows(std::span<const BufferEdge> edges, std::uint32_t y, const RasterBand& band, RowRuns& runs) {
  const Lanes d;
  for (std::uint32_t i = 0; i < RowRuns::kRows; i += laneCount()) {
    const auto rows = rowsFrom(y + i);
    auto begin = hn::Set(d, -kFar), end = hn::Set(d, kFar);
    for (const BufferEdge& edge : edges) {
      if (edge.side == 0) {
        continue;
      }
      const Crossing crossing = cross(edge, edge.margin, rows);
      if (edge.side < 0) {
        begin = hn::Max(begin, crossing.last);
      } else {
        end = hn::Min(end, crossing.first);
      }
    }
    const auto one = hn::Set(d, 1.0f);
    Crossing{hn::Add(begin, one), hn::Sub(end, one)}.store(band, i, runs);
  }
}

// Whether all pixels of the run are nearer than `nearest`.
bool hiddenRow(const float* row, Run run, float nearest) {
  const Lanes d;
  const auto limit = hn::Set(d, nearest);
  for (std::uint32_t x = run.first; x <= run.last; x += laneCount()) {
    const auto before = hn::Lt(hn::LoadU(d, row + x), limit);
    if (!hn::AllFalse(d, hn::And(before, hn::FirstN(d, run.last - x + 1)))) {
      return false;
    }
  }
  return true;
}

struct Rows {
  std::uint32_t first = 0, end = 0;
};
// Returns the rows of the band that the heights from `low` to `high` (pixels) touch.
Rows rowsOf(float low, float high, const RasterBand& band) {
  const float first = std::max(std::floor(low), static_cast<float>(band.first_row));
  const float end = std::min(std::floor(high) + 1.0f, static_cast<float>(band.end_row));
  return first < end ? Rows{static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(end)} : Rows{};
}

// Returns whether all that the polygon would have drawn is behind what is there.
bool drawInside(const BufferPolygons& polygons, const BufferPolygon& polygon, const RasterBand& band,
                RasterScratch& scratch) {
  const Rows rows =
      rowsOf(std::ceil(polygon.low + polygon.margin), std::floor(polygon.high - polygon.margin) - 1.0f, band);
  if (rows.first == rows.end) {
    return true;
  }
  scratch.insides.clear();
  for (std::uint32_t y = rows.first; y < rows.end; y += RowRuns::kRows) {
    RasterScratch::Part& part = scratch.insides.emplace_back();
    part.polygon = &polygon;
    insideRows(polygons.outline(polygon), y, band, part.runs);
  }
  std::uint32_t y = rows.first;
  const auto part_at = [&](std::uint32_t row) HWY_ATTR -> RasterScratch::Part& {
    return scratch.insides[(row - rows.first) / RowRuns::kRows];
  };
  const auto row_in_part = [&](std::uint32_t row) HWY_ATTR { return (row - rows.first) % RowRuns::kRows; };
  while (y < rows.end && hiddenRow(band.reciprocal_depth + std::size_t{y} * band.stride,
                                   Run::of(part_at(y).runs, row_in_part(y)), polygon.nearest)) {
    ++y;
  }
  if (y == rows.end) {
    return true;
  }
  const Lanes d;
  y -= row_in_part(y);
  for (; y < rows.end; ++y) {
    RasterScratch::Part& part = part_at(y);
    const std::uint32_t in_part = row_in_part(y);
    if (in_part == 0) {
      findAtFirst(y, part);
    }
    float* row = band.reciprocal_depth + std::size_t{y} * band.stride;
    const RowReciprocalDepth reciprocal_depth(part, in_part);
    forRun(Run::of(part.runs, in_part), [&](std::uint32_t x, auto mask) HWY_ATTR {
      const auto old = hn::LoadU(d, row + x);
      hn::StoreU(hn::IfThenElse(mask, hn::Max(old, reciprocal_depth.from(x)), old), d, row + x);
    });
  }
  return false;
}

void drawInsidesOf(const BufferPolygons& polygons, std::span<const std::uint32_t> order,
                   const RasterBand& band, RasterScratch& scratch, std::span<std::uint8_t> drawn) {
  for (const std::uint32_t p : order) {
    if (!drawInside(polygons, polygons.polygons[p], band, scratch)) {
      drawn[p] = 1;
    }
  }
}

// Draws the pixels near the shared edges of a group of polygons. A pixel is covered by the group where some
// of its polygons touch it and no open edge comes near it: then a polygon goes on beyond each edge that
// crosses the pixel, and together they cover all of it (docs/conservative.md). Its depth is the farthest of
// all polygons whose shared edges come near: the mesh's own edge may lie on either side of the polygons'
// edge, by less than the margin.
class SharedEdgeDrawer {
 public:
  SharedEdgeDrawer(const BufferPolygons& polygons, std::span<const std::uint32_t> group,
                   const RasterBand& band, double rounding, RasterScratch& scratch)
      : polygons_(polygons),
        group_(group),
        band_(band),
        rounding_(static_cast<float>(rounding)),
        scratch_(scratch) {}

  void draw() {
    float low = kFar, high = -kFar;
    for (const std::uint32_t p : group_) {
      for (const BufferEdge& edge : polygons_.outline(polygons_.polygons[p])) {
        if (edge.kind == EdgeKind::kShared) {
          low = std::min(low, edge.low - edge.margin);
          high = std::max(high, edge.high + edge.margin);
        }
      }
    }
    const Rows rows = rowsOf(low, high, band_);
    scratch_.edge_rows.resize(std::size_t{band_.stride} * RowRuns::kRows, kUntouched);
    for (first_ = rows.first; first_ < rows.end; first_ += RowRuns::kRows) {
      findSharedEdges();
      row_count_ = std::min(rows.end - first_, RowRuns::kRows);
      if (allHidden()) {
        continue;
      }
      findOpenEdges();
      gather();
      clearOpenEdges();
      commit();
    }
  }

 private:
  bool inRows(const BufferEdge& edge) const {
    return edge.high + edge.margin >= static_cast<float>(first_) &&
           edge.low - edge.margin <= static_cast<float>(first_ + RowRuns::kRows);
  }

  // Finds, for each shared edge, the pixels that it comes near, and those of them that its polygon touches.
  void findSharedEdges() {
    scratch_.shared_edges.clear();
    std::fill_n(all_.first, RowRuns::kRows, static_cast<std::int32_t>(band_.width));
    std::fill_n(all_.last, RowRuns::kRows, -1);
    for (const std::uint32_t p : group_) {
      const BufferPolygon& polygon = polygons_.polygons[p];
      bool touched_known = false;
      RowRuns touched;
      for (const BufferEdge& edge : polygons_.outline(polygon)) {
        if (edge.kind != EdgeKind::kShared || !inRows(edge)) {
          continue;
        }
        if (!touched_known) {
          findTouched(polygon, touched);
          touched_known = true;
        }
        RasterScratch::Part& part = scratch_.shared_edges.emplace_back();
        part.polygon = &polygon;
        findCrossed(edge, part.runs);
        bool some = false;
        for (std::uint32_t i = 0; i < RowRuns::kRows; ++i) {
          part.own.first[i] = std::max(part.runs.first[i], touched.first[i]);
          part.own.last[i] = std::min(part.runs.last[i], touched.last[i]);
          const bool none = part.runs.first[i] > part.runs.last[i];
          some |= !none;
          all_.first[i] = none ? all_.first[i] : std::min(all_.first[i], part.runs.first[i]);
          all_.last[i] = none ? all_.last[i] : std::max(all_.last[i], part.runs.last[i]);
        }
        if (some) {
          findAtFirst(first_, part);
        } else {
          scratch_.shared_edges.pop_back();
        }
      }
    }
  }

  // Whether all that the shared edges would draw is behind what the buffer has.
  bool allHidden() const {
    for (const RasterScratch::Part& part : scratch_.shared_edges) {
      for (std::uint32_t row = 0; row < row_count_; ++row) {
        const float* buffer_row = band_.reciprocal_depth + std::size_t{first_ + row} * band_.stride;
        if (!hiddenRow(buffer_row, Run::of(part.own, row), part.polygon->nearest)) {
          return false;
        }
      }
    }
    return true;
  }

  void findTouched(const BufferPolygon& polygon, RowRuns& runs) const {
    const Lanes d;
    for (std::uint32_t i = 0; i < RowRuns::kRows; i += laneCount()) {
      const auto rows = rowsFrom(first_ + i);
      Crossing touched{hn::Set(d, kFar), hn::Set(d, -kFar)};
      for (const BufferEdge& edge : polygons_.outline(polygon)) {
        const Crossing crossing = cross(edge, rounding_, rows);
        touched.first = hn::Min(touched.first, crossing.first);
        touched.last = hn::Max(touched.last, crossing.last);
      }
      touched.store(band_, i, runs);
    }
  }

  void findCrossed(const BufferEdge& edge, RowRuns& runs) const {
    for (std::uint32_t i = 0; i < RowRuns::kRows; i += laneCount()) {
      cross(edge, edge.margin, rowsFrom(first_ + i)).store(band_, i, runs);
    }
  }

  // Finds the pixels near open edges, as far as shared edges may come near them too.
  void findOpenEdges() {
    scratch_.open_edges.clear();
    for (const std::uint32_t p : group_) {
      const BufferPolygon& polygon = polygons_.polygons[p];
      const std::uint32_t count = polygon.edge_count + polygon.gap_count;
      for (const BufferEdge& edge : std::span(polygons_.edges).subspan(polygon.first_edge, count)) {
        if (edge.kind != EdgeKind::kOpen || !inRows(edge)) {
          continue;
        }
        RowRuns crossed;
        findCrossed(edge, crossed);
        bool some = false;
        for (std::uint32_t i = 0; i < RowRuns::kRows; ++i) {
          crossed.first[i] = std::max(crossed.first[i], all_.first[i]);
          crossed.last[i] = std::min(crossed.last[i], all_.last[i]);
          some |= crossed.first[i] <= crossed.last[i];
        }
        if (some) {
          scratch_.open_edges.push_back(crossed);
        }
      }
    }
  }

  float* edgeRow(std::uint32_t row) { return scratch_.edge_rows.data() + std::size_t{row} * band_.stride; }

  // Gathers, for each pixel, the farthest of the polygons whose shared edges come near it.
  void gather() {
    const Lanes d;
    for (const RasterScratch::Part& part : scratch_.shared_edges) {
      for (std::uint32_t row = 0; row < row_count_; ++row) {
        float* edge_row = edgeRow(row);
        const RowReciprocalDepth reciprocal_depth(part, row);
        forRun(Run::of(part.runs, row), [&](std::uint32_t x, auto mask) HWY_ATTR {
          const auto old = hn::LoadU(d, edge_row + x);
          hn::StoreU(hn::IfThenElse(mask, hn::Min(old, reciprocal_depth.from(x)), old), d, edge_row + x);
        });
      }
    }
  }

  // Takes away the pixels near open edges.
  void clearOpenEdges() {
    const Lanes d;
    for (const RowRuns& crossed : scratch_.open_edges) {
      for (std::uint32_t row = 0; row < row_count_; ++row) {
        float* edge_row = edgeRow(row);
        forRun(Run::of(crossed, row), [&](std::uint32_t x, auto mask) HWY_ATTR {
          const auto old = hn::LoadU(d, edge_row + x);
          const auto touched = hn::And(mask, hn::Ne(old, hn::Set(d, kUntouched)));
          hn::StoreU(hn::IfThenElse(touched, hn::Set(d, kUncovered), old), d, edge_row + x);
        });
      }
    }
  }

  // Draws what is left into the buffer, and empties the rows for the next use.
  void commit() {
    const Lanes d;
    for (const RasterScratch::Part& part : scratch_.shared_edges) {
      for (std::uint32_t row = 0; row < row_count_; ++row) {
        const float* edge_row = edgeRow(row);
        float* buffer_row = band_.reciprocal_depth + std::size_t{first_ + row} * band_.stride;
        forRun(Run::of(part.own, row), [&](std::uint32_t x, auto mask) HWY_ATTR {
          const auto old = hn::LoadU(d, buffer_row + x);
          hn::StoreU(hn::IfThenElse(mask, hn::Max(old, hn::LoadU(d, edge_row + x)), old), d, buffer_row + x);
        });
      }
    }
    for (std::uint32_t row = 0; row < row_count_; ++row) {
      float* edge_row = edgeRow(row);
      forRun(Run::of(all_, row),
             [&](std::uint32_t x, auto) HWY_ATTR { hn::StoreU(hn::Set(d, kUntouched), d, edge_row + x); });
    }
  }

  const BufferPolygons& polygons_;
  std::span<const std::uint32_t> group_;
  const RasterBand& band_;
  float rounding_;
  RasterScratch& scratch_;
  std::uint32_t first_ = 0;      // the lowest of the rows that are drawn together
  std::uint32_t row_count_ = 0;  // how many of them the band has
  RowRuns all_;                  // in each row, from the first to the last pixel near a shared edge
};

void drawSharedEdgesOf(const BufferPolygons& polygons, std::span<const std::uint32_t> group,
                       const RasterBand& band, double rounding, RasterScratch& scratch) {
  SharedEdgeDrawer(polygons, group, band, rounding, scratch).draw();
}

void fillAll(std::span<float> reciprocal_depth, float value) {
  const hn::ScalableTag<float> d;
  const auto v = hn::Set(d, value);
  std::size_t i = 0;
  for (; i + hn::Lanes(d) <= reciprocal_depth.size(); i += hn::Lanes(d)) {
    hn::StoreU(v, d, reciprocal_depth.data() + i);
  }
  for (; i < reciprocal_depth.size(); ++i) {
    reciprocal_depth[i] = value;
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace sightline::occlusion
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::occlusion {

HWY_EXPORT(drawInsidesOf);
HWY_EXPORT(drawSharedEdgesOf);
HWY_EXPORT(fillAll);

void drawInsides(const BufferPolygons& polygons, std::span<const std::uint32_t> order, const RasterBand& band,
                 RasterScratch& scratch, std::span<std::uint8_t> drawn) {
  HWY_DYNAMIC_DISPATCH(drawInsidesOf)(polygons, order, band, scratch, drawn);
}

void drawSharedEdges(const BufferPolygons& polygons, std::span<const std::uint32_t> group,
                     const RasterBand& band, double rounding, RasterScratch& scratch) {
  HWY_DYNAMIC_DISPATCH(drawSharedEdgesOf)(polygons, group, band, rounding, scratch);
}

void fillBuffer(std::span<float> reciprocal_depth, float value) {
  HWY_DYNAMIC_DISPATCH(fillAll)(reciprocal_depth, value);
}

}  // namespace sightline::occlusion
#endif
