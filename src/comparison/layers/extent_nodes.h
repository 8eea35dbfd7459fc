#pragma once

// A kd-tree over the parts' intervals.
//
// Based on: Snyder, Lengyel. MSR-TR-97-11, section 5.2.
// Differs from the paper in:
// - A node has two sorted lists, one of lower and one of upper bounds (min_cost.h). A part is in the left
//   child if its low <= value, so these parts begin the lower list, and in the right child if its high >
//   value, so these end the upper list. A mark on each bound says whether the part is in that child now.
//   Where mark and place disagree, the part must be handed down or removed.
// - Parts have no pointers to their nodes. A part lies in exactly the nodes to which the rule leads with its
//   bounds; setActive() follows that path. A part that leaves a node is handed down as removed and leaves all
//   nodes below in the same depth-first pass, before any query.
// - Whether a part is active is stored once per part, not in each leaf. Nodes count their active parts.
// - The depth and the number of copies of parts are limited; nodes beyond the limit become leaves.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sightline/comparison/layer_sorting.h"
#include "src/comparison/layers/extent_keys.h"
#include "src/comparison/layers/leaf_overlap.h"
#include "src/comparison/layers/min_cost.h"
#include "src/comparison/layers/row_blocks.h"
#include "src/layers/extents/extent_table.h"

namespace sightline::comparison {

// Counts of the work done, for tests and reports.
struct ExtentTreeWork {
  std::uint64_t nodes_made = 0;       // nodes built
  std::uint64_t nodes_visited = 0;    // nodes visited by rebalancing
  std::uint64_t nodes_divided = 0;    // of these, nodes divided anew since a bound moved
  std::uint64_t parts_moved = 0;      // parts handed down to a child or removed from it
  std::uint64_t sorted_outright = 0;  // lists too disordered for insertion sort
  std::uint64_t takeovers = 0;        // trees built in the background that replaced the current one
};

class ExtentNodes {
 public:
  static constexpr std::uint32_t kNone = 0xffffffffu;
  static constexpr std::uint32_t kMaxDepth = 64;
  // Nodes are no longer divided once leaves and pending nodes hold more copies than this per part. Otherwise
  // intervals that overlap nearly all others would be copied without end.
  static constexpr std::uint32_t kMaxCopies = 16;

  struct Node {
    std::uint32_t value =
        0;  // a key: parts with low <= value are in the left child, high > value in the right
    std::uint32_t axis = kNone;  // kNone: a leaf
    std::uint32_t left = kNone;  // the right child follows
    std::uint32_t active = 0;    // number of active parts in this node
  };

  // Begins a tree; makeSome() then makes its nodes.
  void begin(const ExtentTreeSettings& settings, std::uint32_t parts, std::size_t axes);
  // Makes up to max_nodes nodes, or sorts the bounds of one axis. Returns whether the tree is complete; it
  // must then be rebalanced before the first query. keys: the same in each call.
  bool makeSome(const ExtentKeys& keys, std::uint32_t max_nodes, ExtentTreeWork& work);
  // Moves the parts to their current nodes. All parts are active afterwards.
  void rebalance(const ExtentKeys& keys, const ExtentTable& table, ExtentTreeWork& work);

  // Adds `by` (1 or -1 modulo 2^32) to the counts of the nodes that hold the part. keys: those of the last
  // rebalance().
  void countActive(const ExtentKeys& keys, std::uint32_t part, std::uint32_t by);

  struct Query {
    OverlapTests tests;
    std::array<KeyInterval, kMaxExtentAxes> keys;
    std::uint32_t epoch = 0;
  };
  // Appends the overlapping parts with seen[part] < epoch, unsorted, and sets their seen[part] to epoch.
  // Returns how many parts the visited leaves hold. seen: one per part.
  std::uint64_t query(const Query& query, std::span<std::uint32_t> seen,
                      std::vector<std::uint32_t>& parts) const;

  // For tests: node 0 is the root.
  std::span<const Node> nodes() const { return nodes_; }
  std::span<const std::uint32_t> partsOfLeaf(std::uint32_t node) const;
  std::span<const Bound> lowsOf(std::uint32_t node) const;  // for inner nodes
  std::span<const Bound> highsOf(std::uint32_t node) const;

 private:
  // The block that holds a node's lists. Inner nodes: rows of bounds_, first all lower and then all upper
  // bounds. Leaves: rows of leaf_parts_ and leaf_bounds_.
  struct List {
    std::uint32_t first = 0, count = 0, size_class = 0;
  };
  struct Pending {  // a node to be made, whose bounds of all tree axes begin at lists_[first]
    std::uint32_t node = 0, count = 0, depth = 0;
    std::size_t first = 0;
  };
  struct Handed {  // a parent's changes to a node: the parts from handed_[first], the added ones before the
                   // removed
    std::size_t first = 0, added = 0, removed = 0;
  };
  struct Choice {
    std::size_t list = 0;
    Division division;
  };

  Bound* lows(const List& list) { return bounds_.data() + 2 * std::size_t{list.first}; }
  Bound* highs(const List& list) { return lows(list) + RowBlocks::rowsOf(list.size_class); }
  float* leafBounds(const List& list) { return leaf_bounds_.data() + 2 * axes_ * std::size_t{list.first}; }

  // extent_tree_build.cpp
  void sortAxis(const ExtentKeys& keys);
  void makeNode();
  bool choose(const Pending& pending, Choice& choice) const;
  void makeInner(const Pending& pending, const Choice& choice);
  void shareOut(const Pending& pending, const Choice& choice);
  void makeLeaf(std::uint32_t node, std::span<const Bound> bounds);
  void takeInner(List& list, std::uint32_t count);
  void takeLeaf(List& list, std::uint32_t count);
  std::span<const Bound> listOf(const Pending& pending, std::size_t list) const;
  void reserve();

  // extent_tree_update.cpp
  struct Frame;
  void visit(std::uint32_t node, const Handed& handed, Frame& frame);
  void visitLeaf(std::uint32_t node, const Handed& handed, Frame& frame);
  void fillLeaf(const List& list, const ExtentTable& table);
  void stampRemoved(const Handed& handed);
  bool refresh(Bound* bounds, std::uint32_t count, std::span<const std::uint32_t> keys, const Handed& handed,
               std::vector<std::uint32_t>& dropped, Frame& frame) const;
  void merge(const Handed& handed, std::span<const std::uint32_t> keys, Bound* bounds, std::uint32_t count);
  void growInner(List& list, std::uint32_t count);
  void growLeaf(List& list, std::uint32_t count);
  Handed handLeft(const List& list, std::uint32_t in_left);
  Handed handRight(const List& list, std::uint32_t in_right);

  std::vector<Node> nodes_;
  std::vector<List> node_lists_;  // one per node
  std::size_t axes_ = 0;
  std::uint32_t parts_ = 0;

  RowBlocks inner_rows_, leaf_rows_;
  std::vector<Bound> bounds_;              // two per row
  std::vector<std::uint32_t> leaf_parts_;  // one per row
  std::vector<float>
      leaf_bounds_;  // 2 * axes_ per row; a block holds for each axis all lows and then all highs

  // State and scratch of the build.
  std::vector<std::uint32_t> tree_axes_;
  std::uint32_t min_gain_ = 1;
  std::size_t sorted_axes_ = 0;
  std::uint64_t copies_ = 0;  // number of parts in all leaves and pending nodes
  std::vector<Bound>
      lists_;  // a stack of the pending nodes' bounds: for each tree axis the lows, then the highs
  std::vector<Bound> left_lists_;
  std::vector<Pending> pending_;
  std::vector<std::uint8_t> sides_;  // one per part: bit 0 left, bit 1 right

  // Scratch for rebalance().
  std::vector<std::uint32_t> handed_;  // a stack of part numbers
  std::vector<std::uint32_t> dropped_left_, dropped_right_;
  std::vector<Bound> added_;
  std::vector<std::uint32_t> stamps_;  // one per part: stamp_ if it is being removed
  std::uint32_t stamp_ = 0;
};

}  // namespace sightline::comparison
