#include "src/occlusion/boundary_runs.h"

#include <algorithm>
#include <array>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/occlusion/boundary_runs.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "src/occlusion/edge_rows-inl.h"

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
  const EdgeRows rows(edge, target.end_x, begins, false);
  rows.forTileRows(target.first_row, target.last_row, [&](std::int32_t row, double x) HWY_ATTR {
    TileRowRuns& runs = target.runs[row];
    rows.forRows(
        row, x,
        [&](std::int32_t lane, PlacesV from, PlacesV to, PlacesM touched, PlacesM crossed, PlacesV,
            PlacesV) HWY_ATTR {
          if (begins) {
            const auto after = hn::Load(kPlaces, runs.after + lane);
            hn::Store(hn::IfThenElse(touched, hn::Max(after, to), after), kPlaces, runs.after + lane);
            const auto bits = hn::VecFromMask(kBits, hn::RebindMask(kBits, crossed));
            hn::Store(hn::Or(hn::Load(kBits, runs.crossed + lane), bits), kBits, runs.crossed + lane);
          } else {
            const auto before = hn::Load(kPlaces, runs.before + lane);
            hn::Store(hn::IfThenElse(touched, hn::Min(before, from), before), kPlaces, runs.before + lane);
          }
        });
  });
}

// Takes the pixels of a level edge out of the runs, and with them the shorter piece beside them.
HWY_INLINE void drawLevelEdge(const RunRows& target, const BoundaryEdge& edge) {
  for (std::int32_t row = std::max<std::int32_t>(edge.first_row, target.first_row * kTileHeight);
       row <= std::min<std::int32_t>(edge.last_row, target.last_row * kTileHeight + kTileHeight - 1); ++row) {
    TileRowRuns& runs = target.runs[row >> kTileHeightShift];
    float &after = runs.after[row % kTileHeight], &before = runs.before[row % kTileHeight];
    if (edge.right - after < before - edge.left) {
      after = std::max(after, edge.right);
    } else {
      before = std::min(before, edge.left);
    }
  }
}

void drawRunsOf(const RunRows& rows, std::span<const BoundaryEdge> edges,
                std::span<const BoundaryChain> chains) {
  for (std::int32_t row = rows.first_row; row <= rows.last_row; ++row) {
    clearRuns(rows.runs[row]);
  }
  std::uint32_t level = 0;
  const auto forEdges = [&](auto&& use) HWY_ATTR {
    for (const BoundaryChain& chain : chains) {
      for (const BoundaryEdge& edge : edges.subspan(chain.first, chain.count)) {
        if (edge.touches(rows.first_row, rows.last_row)) {
          use(edge, chain.value);
        }
      }
    }
  };
  forEdges([&](const BoundaryEdge& edge, std::int32_t value) HWY_ATTR {
    if (edge.kind == EdgeSlope::kLevel) {
      ++level;
    } else {
      drawEdge(rows, edge, edge.rises(value));
    }
  });
  if (level > 0) {  // the others have to be known before
    forEdges([&](const BoundaryEdge& edge, std::int32_t) HWY_ATTR {
      if (edge.kind == EdgeSlope::kLevel) {
        drawLevelEdge(rows, edge);
      }
    });
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace sightline::occlusion
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::occlusion {
namespace {

HWY_EXPORT(drawRunsOf);

// The heights of edges that begin a group, in ascending order.
class Beginnings {
 public:
  // False: there are too many.
  bool add(const BoundaryEdge& edge) {
    if (count_ == heights_.size()) {
      return false;
    }
    std::size_t at = count_++;
    for (; at > 0 && heights_[at - 1].bottom > edge.bottom; --at) {
      heights_[at] = heights_[at - 1];
    }
    heights_[at] = {edge.bottom, edge.top};
    return true;
  }
  // Whether there is at most one of them at each height.
  bool follow() const {
    for (std::size_t i = 1; i < count_; ++i) {
      if (heights_[i].bottom < heights_[i - 1].top) {
        return false;
      }
    }
    return true;
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
  return few && beginnings.follow() && (level == 0 || all([&](const BoundaryEdge& edge, std::int32_t) {
                                          return edge.kind != EdgeSlope::kLevel || edge.bottom <= bottom ||
                                                 edge.top >= top;
                                        }));
}

void drawRuns(const RunRows& rows, std::span<const BoundaryEdge> edges,
              std::span<const BoundaryChain> chains) {
  HWY_DYNAMIC_DISPATCH(drawRunsOf)(rows, edges, chains);
}

}  // namespace sightline::occlusion
#endif
