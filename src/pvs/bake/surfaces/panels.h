#pragma once

// The surfaces of a scene as a baker asks for them: one-sided, divided wherever they touch, and joined along
// what a viewer before them sees as one surface.
//
// A sheet is one side of an opaque triangle, or of a piece of one: double-sided triangles have two sheets.
// Around an edge at which several sheets end, each is joined with the next one that faces it across the space
// between them: a wall with the floor before it, not with the floor below the wall. A sheet at the border of
// what is double-sided is joined with its own back. Joined sheets run along their edge in opposite
// directions, so a set that holds both sheets of each pair has no boundary at that edge.
//
// A panel is a set of joined sheets of one object and of similar direction, which are taken together.

#include <compare>
#include <cstdint>
#include <span>
#include <vector>

#include "sightline/base/large_vector.h"
#include "sightline/base/parallel_for.h"
#include "sightline/scene/scene.h"
#include "src/pvs/bake/convex/cone_search.h"

namespace sightline::pvs {

inline constexpr std::uint32_t kNoPanel = 0xffffffffu;
inline constexpr std::uint32_t kNoObject = 0xffffffffu;
inline constexpr std::uint32_t kNoRing = 0xffffffffu;

// An edge at the border of a panel.
struct PanelEdge {
  std::uint32_t from = 0, to = 0;  // into Panels::vertices
  std::uint32_t beyond = 0;        // the panel that is joined with it there, or kNoPanel
  // All sheets that end at the edge, in Panels::rings; kNoRing if the two that are joined are the only ones.
  std::uint32_t ring = kNoRing;
};

// The sheets that end at an edge, in the order of their angles, as one of them sees it.
struct EdgeRing {
  std::uint32_t first = 0, count = 0;  // into Panels::around
  std::uint32_t self = 0;              // which of them is the edge's own
};

// A sheet that ends at an edge.
struct SheetAround {
  std::uint32_t panel = 0;          // its panel
  std::uint32_t beyond = kNoPanel;  // the panel of the sheet that it is joined with, or kNoPanel
  bool rises = false;               // its front is towards greater angles
};

struct Panel {
  std::uint32_t first_sheet = 0, sheet_count = 0;  // into Panels::sheets
  std::uint32_t first_edge = 0, edge_count = 0;    // into Panels::edges
  std::uint32_t object = 0;
};

// In which order panels that a line crosses are taken, whatever their numbers are: which objects a question
// leaves out depends on it, and has to be the same when other objects of the scene have changed.
struct PanelRank {
  // Over how many joined edges the way to a border of the surface leads, kMostSteps at most: a change of a
  // border is no change of what is far from it.
  std::uint32_t steps = 0;
  std::uint64_t content = 0;  // a hash of its sheets, and of all triangles of its object as they were given

  bool operator==(const PanelRank&) const = default;
  auto operator<=>(const PanelRank&) const = default;
};
inline constexpr std::uint32_t kMostSteps = 8;

struct Panels {
  // Scene space. None is farther than `slack` metres from where it would be without rounding; there, the
  // sheets of an object are its triangles exactly.
  LargeVector<Vec3d> vertices{};
  LargeVector<std::uint32_t> sheets{};  // three vertices each, counter-clockwise as seen from its front
  LargeVector<PanelEdge> edges{};
  LargeVector<EdgeRing> rings{};
  LargeVector<SheetAround> around{};
  LargeVector<Panel> panels{};
  LargeVector<Box> bounds{};           // by panel, also of what was not rounded
  ConeTree tree{};                     // of the bounds, with the numbers of the panels
  std::vector<PanelRank> ranks{};      // by panel
  std::vector<std::uint32_t> order{};  // by panel: its place among all by rank, those of equal rank by number
  double slack = 0.0;

  std::span<const std::uint32_t> sheetsOf(const Panel& p) const {
    return std::span(sheets).subspan(std::size_t{3} * p.first_sheet, std::size_t{3} * p.sheet_count);
  }
  // Whether panel a is taken before panel b. Those of equal content are taken in the order of their objects.
  bool before(std::uint32_t a, std::uint32_t b) const { return order[a] < order[b]; }
  std::span<const PanelEdge> edgesOf(const Panel& p) const {
    return std::span(edges).subspan(p.first_edge, p.edge_count);
  }
  // The panel that is joined at the edge if some panels are left out, those for which is_out(panel) holds. A
  // sheet whose own partner stays keeps it; others are joined with each other anew, also those that were
  // joined with none.
  template <typename IsOut>
  std::uint32_t joinedWithout(const PanelEdge& edge, const IsOut& is_out) const;
};

// The pairs are those of brackets, all around: each sheet that rises with the next one that falls.
template <typename IsOut>
std::uint32_t Panels::joinedWithout(const PanelEdge& edge, const IsOut& is_out) const {
  if (edge.ring == kNoRing) {
    return kNoPanel;
  }
  const EdgeRing& ring = rings[edge.ring];
  const std::span<const SheetAround> all = std::span(around).subspan(ring.first, ring.count);
  const bool rises = all[ring.self].rises;
  std::uint32_t open = 0;
  for (std::uint32_t i = ring.self, step = 1; step < all.size(); ++step) {
    i = rises ? (i + 1 == all.size() ? 0 : i + 1) : (i == 0 ? ring.count : i) - 1;
    const SheetAround& sheet = all[i];
    if (is_out(sheet.panel) || (sheet.beyond != kNoPanel && !is_out(sheet.beyond))) {
      continue;
    }
    if (sheet.rises == rises) {
      ++open;
    } else if (open == 0) {
      return sheet.panel;
    } else {
      --open;
    }
  }
  return kNoPanel;
}

// How many sheets a panel has at most. One that reaches around the end of a wall joins what is before the
// wall with what is behind it, so small panels hide more; large ones are fewer, and asked about faster.
inline constexpr std::uint32_t kSmallPanel = 4, kLargePanel = 32;

// Makes panels of all opaque triangles that may be occluders and are finite. The result does not depend on
// the threads.
Panels findPanels(const SceneView& scene, std::uint32_t most_sheets = kSmallPanel,
                  const ParallelFor& parallel_for = serialFor);

}  // namespace sightline::pvs
