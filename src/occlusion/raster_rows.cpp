#include "occlusion/raster_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "occlusion/raster_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sightline::occlusion_detail {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::ScalableTag<float>;
using Vector = hn::Vec<Lanes>;

constexpr float kFar = 1e9f;          // pixels, beyond any map
constexpr std::uint32_t kChunk = 64;  // rows that are prepared together; a multiple of the lanes
constexpr float kUntouched = std::numeric_limits<float>::infinity();
constexpr float kDead = -std::numeric_limits<float>::max();

// First and last pixels, in the rows from y on, of the squares that come within `margin` of an edge; where
// there are none the first is beyond the last. No fused operations: they would round differently from one
// instruction set to another.
struct Crossing {
  Vector first, last;
};
HWY_INLINE Crossing cross(const MapEdge& edge, float margin, Vector y) {
  const Lanes d;
  const auto m = hn::Set(d, margin);
  const auto low = hn::Set(d, edge.low), high = hn::Set(d, edge.high);
  const auto bottom = hn::Sub(y, m), top = hn::Add(y, hn::Set(d, 1.0f + margin));
  const auto left = hn::Set(d, edge.left), right = hn::Set(d, edge.right);
  auto least = left, most = right;
  if (!edge.flat()) {
    const auto slope = hn::Set(d, edge.slope), at_low = hn::Set(d, edge.x_at_low);
    const auto a = hn::Sub(hn::Max(bottom, low), low);
    const auto b = hn::Sub(hn::Min(top, high), low);
    const auto xa = hn::Add(at_low, hn::Mul(slope, a)), xb = hn::Add(at_low, hn::Mul(slope, b));
    least = hn::Max(hn::Min(xa, xb), left);
    most = hn::Min(hn::Max(xa, xb), right);
  }
  const auto meets = hn::And(hn::Ge(top, low), hn::Le(bottom, high));
  return {hn::IfThenElse(meets, hn::Floor(hn::Sub(least, m)), hn::Set(d, kFar)),
          hn::IfThenElse(meets, hn::Floor(hn::Add(most, m)), hn::Set(d, -kFar))};
}

HWY_INLINE Vector rowsFrom(std::uint32_t y) {
  const Lanes d;
  return hn::Iota(d, static_cast<float>(y));
}

// A polygon's nearness along one row: its farthest in every pixel.
struct RowNearness {
  float at_x = 0.0f;  // in pixel `x`
  float step = 0.0f;
  float farthest = 0.0f;
  std::uint32_t x = 0;

  RowNearness(const MapPolygon& polygon, std::uint32_t y, std::uint32_t first, std::uint32_t last) {
    x = first;
    step = static_cast<float>(polygon.along_x);
    farthest = polygon.farthest;
    const double from = first + (polygon.along_x < 0.0 ? 1.0 : 0.0),
                 row = y + (polygon.along_y < 0.0 ? 1.0 : 0.0);
    const double value = polygon.at_origin + polygon.along_x * from + polygon.along_y * row;
    const double spread = std::abs(polygon.along_x) * (last - first);
    // Above the rounding of these sums, to single precision, and of the ones in single precision below.
    const double rounding = 0x1p-22 * (std::abs(value) + spread) +
                            0x1p-50 * (std::abs(polygon.at_origin) + std::abs(polygon.along_x) * from +
                                       std::abs(polygon.along_y) * row);
    at_x = static_cast<float>(value - rounding);
  }
  // Of pixels at, at + 1, ...
  HWY_INLINE Vector from(std::uint32_t at) const {
    const Lanes d;
    const auto offset = hn::Iota(d, static_cast<float>(at - x));
    return hn::Max(hn::Add(hn::Set(d, at_x), hn::Mul(hn::Set(d, step), offset)), hn::Set(d, farthest));
  }
};

// A run of pixels of one row.
struct Run {
  std::uint32_t first = 1, last = 0;

  bool empty() const { return first > last; }
};
HWY_INLINE Run runOf(float first, float last, const RasterBand& band) {
  if (!(first <= last) || last < 0.0f || first >= static_cast<float>(band.width)) {
    return {};
  }
  return {first > 0.0f ? static_cast<std::uint32_t>(first) : 0,
          std::min(last < kFar ? static_cast<std::uint32_t>(last) : band.width, band.width - 1)};
}

// Calls body(x, mask) for the vectors of a run.
template <typename Body>
HWY_INLINE void forRun(Run run, Body&& body) {
  const Lanes d;
  const auto lanes = static_cast<std::uint32_t>(hn::Lanes(d));
  for (std::uint32_t x = run.first; x <= run.last; x += lanes) {
    body(x, hn::FirstN(d, run.last - x + 1));
  }
}

// The pixels of each row that lie inside all edges, for `count` rows from y on.
void insideRows(std::span<const MapEdge> edges, std::uint32_t y, std::uint32_t count, float* first,
                float* last) {
  const Lanes d;
  for (std::uint32_t i = 0; i < count; i += static_cast<std::uint32_t>(hn::Lanes(d))) {
    const auto rows = rowsFrom(y + i);
    auto begin = hn::Set(d, -kFar), end = hn::Set(d, kFar);
    for (const MapEdge& edge : edges) {
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
    hn::StoreU(hn::Add(begin, hn::Set(d, 1.0f)), d, first + i);
    hn::StoreU(hn::Sub(end, hn::Set(d, 1.0f)), d, last + i);
  }
}

bool hiddenRow(const float* row, Run run, float nearest) {
  const Lanes d;
  const auto limit = hn::Set(d, nearest);
  for (std::uint32_t x = run.first; x <= run.last; x += static_cast<std::uint32_t>(hn::Lanes(d))) {
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
// Rows from `low` to `high` (pixels), whole ones only or all that are touched, within the band.
Rows rowsOf(float low, float high, const RasterBand& band) {
  const float first = std::max(std::floor(low), static_cast<float>(band.first_row));
  const float end = std::min(std::floor(high) + 1.0f, static_cast<float>(band.end_row));
  return first < end ? Rows{static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(end)} : Rows{};
}

// Returns whether what it would have drawn is behind what is there.
bool drawInside(const MapPolygons& polygons, const MapPolygon& polygon, const RasterBand& band,
                RasterScratch& scratch) {
  const Rows rows =
      rowsOf(std::ceil(polygon.low + polygon.margin), std::floor(polygon.high - polygon.margin) - 1.0f, band);
  const std::uint32_t count = rows.end - rows.first;
  if (count == 0) {
    return true;
  }
  scratch.low.resize(std::max<std::size_t>(scratch.low.size(), count + kRowSlack));
  scratch.high.resize(std::max<std::size_t>(scratch.high.size(), count + kRowSlack));
  insideRows(polygons.outline(polygon), rows.first, count, scratch.low.data(), scratch.high.data());
  const auto run_of = [&](std::uint32_t y) {
    return runOf(scratch.low[y - rows.first], scratch.high[y - rows.first], band);
  };
  std::uint32_t y = rows.first;
  while (y < rows.end &&
         hiddenRow(band.nearness + std::size_t{y} * band.stride, run_of(y), polygon.nearest)) {
    ++y;
  }
  if (y == rows.end) {
    return true;
  }
  const Lanes d;
  for (; y < rows.end; ++y) {
    const Run run = run_of(y);
    if (run.empty()) {
      continue;
    }
    float* row = band.nearness + std::size_t{y} * band.stride;
    const RowNearness nearness(polygon, y, run.first, run.last);
    forRun(run, [&](std::uint32_t x, auto mask) {
      const auto old = hn::LoadU(d, row + x);
      hn::StoreU(hn::IfThenElse(mask, hn::Max(old, nearness.from(x)), old), d, row + x);
    });
  }
  return false;
}

void drawInsidesOf(const MapPolygons& polygons, std::span<const std::uint32_t> order, const RasterBand& band,
                   RasterScratch& scratch, std::span<std::uint8_t> hidden) {
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (!drawInside(polygons, polygons.polygons[order[i]], band, scratch)) {
      hidden[i] = 0;
    }
  }
}

// Seams. A pixel is covered by the group where some of its polygons touch it, and nothing that comes near it
// is an end of one of them: then one goes on beyond each edge that crosses the pixel, and together they cover
// all of it (docs/conservative.md). What is farthest of all that touch it counts.
class SeamDrawer {
 public:
  SeamDrawer(const MapPolygons& polygons, std::span<const std::uint32_t> group, const RasterBand& band,
             double rounding, RasterScratch& scratch)
      : polygons_(polygons),
        group_(group),
        band_(band),
        rounding_(static_cast<float>(rounding)),
        scratch_(scratch) {}

  void draw() {
    float low = kFar, high = -kFar;
    std::size_t lists = 0;
    for (const std::uint32_t p : group_) {
      const MapPolygon& polygon = polygons_.polygons[p];
      lists += 1 + polygon.edge_count + polygon.gap_count;
      for (const MapEdge& edge : polygons_.outline(polygon)) {
        if (edge.kind == EdgeKind::kSealed) {
          low = std::min(low, edge.low - edge.margin);
          high = std::max(high, edge.high + edge.margin);
        }
      }
    }
    const Rows rows = rowsOf(low, high, band_);
    scratch_.low.resize(std::max(scratch_.low.size(), lists * kChunk));
    scratch_.high.resize(std::max(scratch_.high.size(), lists * kChunk));
    scratch_.seam_row.resize(band_.stride, kUntouched);
    for (std::uint32_t y = rows.first; y < rows.end; y += kChunk) {
      chunk_ = {y, std::min(y + kChunk, rows.end)};
      prepare();
      for (row_ = chunk_.first; row_ < chunk_.end; ++row_) {
        drawRow();
      }
    }
  }

 private:
  // Lists of one number a row of the chunk: for every polygon what it touches, then its edges.
  void prepare() {
    const Lanes d;
    std::size_t list = 0;
    for (const std::uint32_t p : group_) {
      const MapPolygon& polygon = polygons_.polygons[p];
      const std::span<const MapEdge> edges = polygons_.outline(polygon);
      for (std::uint32_t i = 0; i < chunk_.end - chunk_.first;
           i += static_cast<std::uint32_t>(hn::Lanes(d))) {
        const auto rows = rowsFrom(chunk_.first + i);
        auto first = hn::Set(d, kFar), last = hn::Set(d, -kFar);
        for (const MapEdge& edge : edges) {
          const Crossing crossing = cross(edge, rounding_, rows);
          first = hn::Min(first, crossing.first);
          last = hn::Max(last, crossing.last);
        }
        store(list, i, {first, last});
        std::size_t at = list;
        for (const MapEdge& edge : edges) {
          store(++at, i, cross(edge, edge.margin, rows));
        }
        for (const MapEdge& edge : polygons_.gaps(polygon)) {
          store(++at, i, cross(edge, edge.margin, rows));
        }
      }
      list += 1 + polygon.edge_count + polygon.gap_count;
    }
  }
  HWY_INLINE void store(std::size_t list, std::uint32_t i, const Crossing& crossing) {
    const Lanes d;
    hn::StoreU(crossing.first, d, scratch_.low.data() + list * kChunk + i);
    hn::StoreU(crossing.last, d, scratch_.high.data() + list * kChunk + i);
  }
  HWY_INLINE Run run(std::size_t list) const {
    const std::size_t at = list * kChunk + (row_ - chunk_.first);
    return runOf(scratch_.low[at], scratch_.high[at], band_);
  }

  // Calls body(polygon, run) for what each polygon touches of the pixels that its seams come near.
  template <typename Body>
  HWY_INLINE void forSeams(Body&& body) const {
    std::size_t list = 0;
    for (const std::uint32_t p : group_) {
      const MapPolygon& polygon = polygons_.polygons[p];
      const Run touched = run(list);
      if (!touched.empty()) {
        for (std::uint32_t e = 0; e < polygon.edge_count; ++e) {
          if (polygons_.edges[polygon.first_edge + e].kind == EdgeKind::kSealed) {
            const Run crossed = run(list + 1 + e);
            const Run both{std::max(crossed.first, touched.first), std::min(crossed.last, touched.last)};
            if (!crossed.empty() && !both.empty()) {
              body(polygon, both);
            }
          }
        }
      }
      list += 1 + polygon.edge_count + polygon.gap_count;
    }
  }

  void drawRow() {
    const Lanes d;
    float* seam = scratch_.seam_row.data();
    Run all{band_.width, 0};
    forSeams([&](const MapPolygon& polygon, Run run) {
      const RowNearness nearness(polygon, row_, run.first, run.last);
      forRun(run, [&](std::uint32_t x, auto mask) {
        const auto old = hn::LoadU(d, seam + x);
        hn::StoreU(hn::IfThenElse(mask, hn::Min(old, nearness.from(x)), old), d, seam + x);
      });
      all = {std::min(all.first, run.first), std::max(all.last, run.last)};
    });
    if (all.empty()) {
      return;
    }
    killEnds(all);
    float* row = band_.nearness + std::size_t{row_} * band_.stride;
    forRun(all, [&](std::uint32_t x, auto mask) {
      const auto value = hn::LoadU(d, seam + x);
      const auto old = hn::LoadU(d, row + x);
      const auto touched = hn::And(mask, hn::Ne(value, hn::Set(d, kUntouched)));
      hn::StoreU(hn::IfThenElse(touched, hn::Max(old, value), old), d, row + x);
      hn::StoreU(hn::IfThenElse(mask, hn::Set(d, kUntouched), value), d, seam + x);
    });
  }

  // Takes the pixels away, of those in `all`, that come near an end of a polygon.
  void killEnds(Run all) {
    const Lanes d;
    float* seam = scratch_.seam_row.data();
    std::size_t list = 0;
    for (const std::uint32_t p : group_) {
      const MapPolygon& polygon = polygons_.polygons[p];
      const std::uint32_t count = polygon.edge_count + polygon.gap_count;
      for (std::uint32_t e = 0; e < count; ++e) {
        if (polygons_.edges[polygon.first_edge + e].kind != EdgeKind::kOpen) {
          continue;
        }
        const Run open = run(list + 1 + e);
        const Run both{std::max(open.first, all.first), std::min(open.last, all.last)};
        if (!open.empty() && !both.empty()) {
          forRun(both, [&](std::uint32_t x, auto mask) {
            const auto old = hn::LoadU(d, seam + x);
            const auto touched = hn::And(mask, hn::Ne(old, hn::Set(d, kUntouched)));
            hn::StoreU(hn::IfThenElse(touched, hn::Set(d, kDead), old), d, seam + x);
          });
        }
      }
      list += 1 + count;
    }
  }

  const MapPolygons& polygons_;
  std::span<const std::uint32_t> group_;
  const RasterBand& band_;
  float rounding_;
  RasterScratch& scratch_;
  Rows chunk_;
  std::uint32_t row_ = 0;
};

void drawSeamsOf(const MapPolygons& polygons, std::span<const std::uint32_t> group, const RasterBand& band,
                 double rounding, RasterScratch& scratch) {
  SeamDrawer(polygons, group, band, rounding, scratch).draw();
}

void fillAll(std::span<float> nearness, float value) {
  const Lanes d;
  const auto v = hn::Set(d, value);
  std::size_t i = 0;
  for (; i + hn::Lanes(d) <= nearness.size(); i += hn::Lanes(d)) {
    hn::StoreU(v, d, nearness.data() + i);
  }
  for (; i < nearness.size(); ++i) {
    nearness[i] = value;
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace sightline::occlusion_detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::occlusion_detail {

HWY_EXPORT(drawInsidesOf);
HWY_EXPORT(drawSeamsOf);
HWY_EXPORT(fillAll);

void drawInsides(const MapPolygons& polygons, std::span<const std::uint32_t> order, const RasterBand& band,
                 RasterScratch& scratch, std::span<std::uint8_t> hidden) {
  HWY_DYNAMIC_DISPATCH(drawInsidesOf)(polygons, order, band, scratch, hidden);
}

void drawSeams(const MapPolygons& polygons, std::span<const std::uint32_t> group, const RasterBand& band,
               double rounding, RasterScratch& scratch) {
  HWY_DYNAMIC_DISPATCH(drawSeamsOf)(polygons, group, band, rounding, scratch);
}

void fillMap(std::span<float> nearness, float value) {
  HWY_DYNAMIC_DISPATCH(fillAll)(nearness, value);
}

void drawCentres(const MapPolygons& polygons, std::span<const std::uint32_t> order, const RasterBand& band) {
  const auto end_row = band.end_row;
  for (const std::uint32_t p : order) {
    const MapPolygon& polygon = polygons.polygons[p];
    forEachCentreSpan(polygons.corners(polygon), band.width, end_row,
                      [&](std::uint32_t y, std::uint32_t first, std::uint32_t last) {
                        if (y < band.first_row) {
                          return;
                        }
                        float* row = band.nearness + std::size_t{y} * band.stride;
                        const double at_row = polygon.at_origin + polygon.along_y * (y + 0.5);
                        for (std::uint32_t x = first; x <= last; ++x) {
                          const auto value = static_cast<float>(at_row + polygon.along_x * (x + 0.5));
                          row[x] = std::max(row[x], value);
                        }
                      });
  }
}

}  // namespace sightline::occlusion_detail
#endif
