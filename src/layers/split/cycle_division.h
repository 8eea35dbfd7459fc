#pragma once

// Finds the planes by which the parts of one group are divided so that the group falls apart.
//
// Planes are chosen one after the other: of some planes through the parts that hold the cycle together, the
// one that leaves the least weight in cycles. Several may be needed before a group falls apart, as of two
// rings that are links of a chain, so a cut need not gain at once; at the end all cuts are taken back that
// the result can do without. Source of the idea: Snyder, Lengyel. MSR-TR-97-11, section 13 (future work).

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "src/layers/pairs/convex_pair.h"
#include "src/layers/pairs/set_occlusion.h"
#include "src/layers/split/cycle_graph.h"
#include "src/layers/split/part_shape.h"

namespace sightline::layers {

// A part of the group, or a piece of a part.
struct CycleMember {
  std::uint32_t part = 0;       // the whole part's number; pieces of one part have the same
  std::vector<ConvexSet> sets;  // its hulls, placed in the world
  Placement placement;
  double weight = 1.0;   // its share of a whole part
  double surface = 0.0;  // of its hulls
  bool is_piece = false;
  std::uint32_t cuts_left = 0;  // by how many planes more it may be cut, one after the other
};

struct DivisionLimits {
  double erosion = 0.0;          // the contact tolerance of the sort
  std::uint32_t max_pieces = 0;  // pieces that may be added
  std::uint32_t max_trials = 0;  // planes that may be tried
};

// A node is a member, by number, or a half of a node.
struct DivisionCut {
  std::uint32_t node = 0;               // what is divided
  std::uint32_t front = 0, behind = 0;  // its halves
  Plane plane;                          // in the part's space
};

class CycleDivision {
 public:
  // The shape of a member, asked for once it is to be divided; nothing if it has none.
  using ShapeOfMember = std::function<std::optional<PartShape>(std::uint32_t member)>;

  // eyes: the view's and the further ones; a single one, far away, in an orthographic view. All must stay as
  // long as this.
  CycleDivision(const SetOcclusion& occlusion, std::span<const Vec3d> eyes, std::vector<CycleMember> members,
                ShapeOfMember shape_of, const DivisionLimits& limits);

  void addArc(std::uint32_t front, std::uint32_t back) { graph_.addArc(front, back); }
  // Looks for cuts. False if none makes the group fall apart.
  bool run();
  // The cuts to make, each after the one of the node that it divides.
  const std::vector<DivisionCut>& cuts() const { return cuts_; }
  PartShape& shape(std::uint32_t node) { return *shapes_[node]; }
  double weightOf(std::uint32_t node) const { return graph_[node].weight; }
  std::uint32_t trials() const { return trials_; }

 private:
  static constexpr std::uint32_t kNoNode = 0xffffffffu;

  struct Choice {
    std::uint32_t node = 0;
    Plane plane;
    ShapeHalves halves;
    CycleGraph::Score score;
  };

  std::vector<std::uint32_t> worstCycle();
  std::vector<std::uint32_t> nodesToDivide(std::span<const std::uint32_t> cycle) const;
  std::optional<Choice> bestCut(std::span<const std::uint32_t> cycle);
  void tryPlanes(std::uint32_t node, std::span<const std::uint32_t> cycle, std::optional<Choice>& best);
  std::vector<ConvexSet> neighboursOf(std::uint32_t node, std::span<const std::uint32_t> cycle) const;
  void addHalves(std::uint32_t node, const Plane& plane, const ShapeHalves& halves);
  void addArcsOfHalves(std::uint32_t front, std::uint32_t behind, const Plane& plane, const Placement& p);
  void apply(Choice choice);
  void setDivided(const DivisionCut& cut, bool divided);
  void takeBackInVain(double enough);
  void completeArcs(std::uint32_t node, std::uint32_t first_later);
  bool areOfOnePart(std::uint32_t a, std::uint32_t b) const;
  void copyArc(std::uint32_t node, std::uint32_t other);
  bool haveShape(std::uint32_t node);
  const Placement& placementOf(std::uint32_t node) const { return members_[member_of_[node]].placement; }
  std::uint32_t piecesOf(std::uint32_t node) const;

  const SetOcclusion& occlusion_;
  std::span<const Vec3d> eyes_;
  std::vector<CycleMember> members_;
  ShapeOfMember shape_of_;
  DivisionLimits limits_;
  CycleGraph graph_;
  // One per node.
  std::vector<std::uint32_t> member_of_;
  std::vector<std::uint32_t> parent_of_;  // the node of which it is a half; kNoNode: none
  std::vector<std::uint32_t> cuts_left_;
  std::vector<std::vector<ConvexSet>> sets_;
  std::deque<std::optional<PartShape>> shapes_;  // of nodes that were to be divided, and of halves
  std::vector<DivisionCut> cuts_;
  std::uint32_t trials_ = 0, pieces_ = 0;
};

}  // namespace sightline::layers
