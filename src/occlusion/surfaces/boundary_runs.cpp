#include "src/occlusion/surfaces/boundary_runs.h"

#include <algorithm>
#include <array>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/occlusion/surfaces/boundary_runs.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "src/occlusion/surfaces/depth_target.h"
#include "src/occlusion/surfaces/edge_rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sightline::occlusion {
namespace HWY_NAMESPACE {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

HWY_INLINE void clearRuns(TileRowRuns& runs) {
  for (std::int32_t lane = 0; lane < kTileHeight; lane += static_cast<std::int32_t>(hn::Lanes(kPlaces))) {
    hn::Store(hn::Set(kPlaces, -kInfinity), kPlaces, runs.after + lane);
    hn::Store(hn::Set(kPlaces, kInfinity), kPlaces, runs.before + lane);
    hn::Store(hn::Zero(kBits), kBits, runs.crossed + lane);
  }
}

HWY_INLINE void drawEdge(const RunRows& target, const BoundaryEdge& edge, bool begins) {
  const EdgeRows rows(edge, target.buffer, begins, false);
  // Edges begin and end a group in turn, so a branch would often be predicted wrong.
  const auto beginning = hn::Ne(hn::Set(kPlaces, begins ? 1.0f : 0.0f), hn::Zero(kPlaces));
  rows.forRows(target.tiles.first_row, target.tiles.last_row,
               [&](std::int32_t row, std::int32_t lane, PlacesV from, PlacesV to, PlacesM touched,
                   PlacesM crossed, PlacesV, PlacesV) HWY_ATTR {
                 TileRowRuns& runs = target.runs[row];
                 const auto after = hn::Load(kPlaces, runs.after + lane),
                            before = hn::Load(kPlaces, runs.before + lane);
                 const auto begin = hn::And(touched, beginning), end = hn::AndNot(beginning, touched);
                 hn::Store(hn::IfThenElse(begin, hn::Max(after, to), after), kPlaces, runs.after + lane);
                 hn::Store(hn::IfThenElse(end, hn::Min(before, from), before), kPlaces, runs.before + lane);
                 const auto bits = hn::VecFromMask(kBits, hn::RebindMask(kBits, hn::And(crossed, beginning)));
                 hn::Store(hn::Or(hn::Load(kBits, runs.crossed + lane), bits), kBits, runs.crossed + lane);
               });
}

// Takes the pixels of a level edge out of the runs, and with them the shorter piece beside them.
HWY_INLINE void drawLevelEdge(const RunRows& target, const BoundaryEdge& edge) {
  const TileRange& tiles = target.tiles;
  for (std::int32_t row = std::max<std::int32_t>(edge.first_row, tiles.first_row * kTileHeight);
       row <= std::min<std::int32_t>(edge.last_row, tiles.last_row * kTileHeight + kTileHeight - 1); ++row) {
    TileRowRuns& runs = target.runs[row >> kTileHeightShift];
    float &after = runs.after[row % kTileHeight], &before = runs.before[row % kTileHeight];
    if (edge.right - after < before - edge.left) {
      after = std::max(after, edge.right);
    } else {
      before = std::min(before, edge.left);
    }
  }
}

// Finds the pixels of the runs in a row of tiles from the places between which they lie.
HWY_INLINE void finishRuns(const RunRows& target, std::int32_t tile_row) {
  TileRowRuns& runs = target.runs[tile_row];
  const std::int32_t rows = target.buffer.height - tile_row * kTileHeight;
  const auto lowest = static_cast<float>(target.tiles.first_column * kTileWidth),
             highest = static_cast<float>(
                 std::min((target.tiles.last_column + 1) * kTileWidth, drawnWidth(target.buffer.width)));
  const auto pixel = hn::Set(kPlaces, 1.0f / kGridStep);
  const auto within = [&](PlacesV v) HWY_ATTR {
    return hn::Min(hn::Max(hn::Floor(v), hn::Set(kPlaces, lowest)), hn::Set(kPlaces, highest));
  };
  auto least = hn::Set(kPlaces, highest), greatest = hn::Set(kPlaces, lowest);
  for (std::int32_t lane = 0; lane < kTileHeight; lane += static_cast<std::int32_t>(hn::Lanes(kPlaces))) {
    const auto after = hn::Mul(hn::Load(kPlaces, runs.after + lane), pixel),
               before = hn::Mul(hn::Load(kPlaces, runs.before + lane), pixel);
    const auto crossed = hn::MaskFromVec(hn::BitCast(kPlaces, hn::Load(kBits, runs.crossed + lane)));
    const auto begin = within(hn::Add(after, hn::Set(kPlaces, 1.0f))),
               end = hn::IfThenElse(crossed, within(before), hn::Set(kPlaces, lowest));
    hn::Store(wholeOf(begin), kNumbers, runs.begin + lane);
    hn::Store(wholeOf(end), kNumbers, runs.end + lane);
    const auto row = hn::Iota(kPlaces, static_cast<float>(lane));
    const auto some = hn::And(hn::Lt(begin, end), hn::Lt(row, hn::Set(kPlaces, static_cast<float>(rows))));
    least = hn::IfThenElse(some, hn::Min(least, begin), least);
    greatest = hn::IfThenElse(some, hn::Max(greatest, end), greatest);
  }
  const auto first = static_cast<std::int32_t>(hn::GetLane(hn::MinOfLanes(kPlaces, least))),
             end = static_cast<std::int32_t>(hn::GetLane(hn::MaxOfLanes(kPlaces, greatest)));
  runs.extent = {first / kTileWidth, (end - 1) >> kTileWidthShift};
}

void drawRunsOf(const RunRows& target, std::span<const BoundaryEdge> edges,
                std::span<const BoundaryChain> chains) {
  const TileRange& tiles = target.tiles;
  for (std::int32_t row = tiles.first_row; row <= tiles.last_row; ++row) {
    clearRuns(target.runs[row]);
  }
  std::uint32_t level = 0;
  const auto forEdges = [&](auto&& use) HWY_ATTR {
    for (const BoundaryChain& chain : chains) {
      for (const BoundaryEdge& edge : edges.subspan(chain.first, chain.count)) {
        if (edge.touches(tiles.first_row, tiles.last_row)) {
          use(edge, chain.value);
        }
      }
    }
  };
  forEdges([&](const BoundaryEdge& edge, std::int32_t value) HWY_ATTR {
    if (edge.kind == EdgeSlope::kLevel) {
      ++level;
    } else {
      drawEdge(target, edge, edge.rises(value));
    }
  });
  if (level > 0) {  // the others have to be known before
    forEdges([&](const BoundaryEdge& edge, std::int32_t) HWY_ATTR {
      if (edge.kind == EdgeSlope::kLevel) {
        drawLevelEdge(target, edge);
      }
    });
  }
  for (std::int32_t row = tiles.first_row; row <= tiles.last_row; ++row) {
    finishRuns(target, row);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace sightline::occlusion
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::occlusion {
namespace {

HWY_EXPORT(drawRunsOf);

// The heights of edges that begin a group, in ascending order; no two edges are at the same height.
class Beginnings {
 public:
  // False: one is at the height of another, or there are too many.
  bool add(const BoundaryEdge& edge) {
    if (count_ == heights_.size()) {
      return false;
    }
    std::size_t at = count_;
    for (; at > 0 && heights_[at - 1].bottom > edge.bottom; --at) {
      heights_[at] = heights_[at - 1];
    }
    heights_[at] = {edge.bottom, edge.top};
    ++count_;
    return (at == 0 || heights_[at - 1].top <= edge.bottom) &&
           (at + 1 == count_ || edge.top <= heights_[at + 1].bottom);
  }

 private:
  struct Heights {
    std::int32_t bottom, top;
  };
  std::array<Heights, 32> heights_;
  std::size_t count_ = 0;
};

}  // namespace

bool hasRuns(std::span<const BoundaryEdge> edges, std::span<const BoundaryChain> chains) {
  const auto all = [&](auto&& holds) {
    return std::all_of(chains.begin(), chains.end(), [&](const BoundaryChain& chain) {
      const auto of_chain = edges.subspan(chain.first, chain.count);
      return std::all_of(of_chain.begin(), of_chain.end(),
                         [&](const BoundaryEdge& edge) { return holds(edge, chain.value); });
    });
  };
  Beginnings beginnings;
  std::int32_t bottom = std::numeric_limits<std::int32_t>::max(), top = 0, level = 0;
  const bool few = all([&](const BoundaryEdge& edge, std::int32_t value) {
    bottom = std::min(bottom, edge.bottom);
    top = std::max(top, edge.top);
    level += edge.kind == EdgeSlope::kLevel ? 1 : 0;
    return edge.kind == EdgeSlope::kLevel || !edge.rises(value) || beginnings.add(edge);
  });
  // A level edge between bottom and top is a step or a slit.
  return few && (level == 0 || all([&](const BoundaryEdge& edge, std::int32_t) {
                   return edge.kind != EdgeSlope::kLevel || edge.bottom <= bottom || edge.top >= top;
                 }));
}

void drawRuns(const RunRows& target, std::span<const BoundaryEdge> edges,
              std::span<const BoundaryChain> chains) {
  HWY_DYNAMIC_DISPATCH(drawRunsOf)(target, edges, chains);
}

}  // namespace sightline::occlusion
#endif
