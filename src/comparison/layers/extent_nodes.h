#pragma once

// One kd-tree over the intervals of parts.
//
// Based on: Snyder, Lengyel. MSR-TR-97-11, section 5.2.
// Differs from the paper in:
// - A node's sorted list is two, lower and upper bounds apart (min_cost.h). A part is in the left child iff
//   its low <= value, so a beginning of the lower list, and in the right child iff its high > value, an end
//   of the upper list. A mark on each bound says whether the part is in that child now: what must be handed
//   down or taken out is where mark and place disagree.
// - There are no child pointers for each part. A part lies in exactly the nodes to which the rule leads with
//   its own bounds, which is the way of setActive(). A part that leaves a node is handed down as removed and
//   leaves all nodes below in the same depth-first pass, before any query.
// - Whether a part is active is noted once a part, not in each leaf. Nodes count their active parts.
// - Depth and the number of copies of parts are limited; nodes beyond become leaves.

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

// What has been done, for tests and reports. Counts, never times.
struct ExtentTreeWork {
  std::uint64_t nodes_made = 0;       // by building
  std::uint64_t nodes_visited = 0;    // by rebalancing
  std::uint64_t nodes_divided = 0;    // of which: a bound moved, so that they were divided anew
  std::uint64_t parts_moved = 0;      // handed down to a child, or removed from it
  std::uint64_t sorted_outright = 0;  // lists too disordered for insertion
  std::uint64_t takeovers = 0;        // trees made in the background that replaced the one before
};

class ExtentNodes {
 public:
  static constexpr std::uint32_t kNone = 0xffffffffu;
  static constexpr std::uint32_t kMaxDepth = 64;
  // Nodes are no longer divided when parts in leaves and nodes to be made are more than so many times the
  // parts: intervals that overlap nearly all others would else be copied without end.
  static constexpr std::uint32_t kMaxCopies = 16;

  struct Node {
    std::uint32_t value = 0;     // key; the part's low <= value: left; high > value: right
    std::uint32_t axis = kNone;  // kNone: a leaf
    std::uint32_t left = kNone;  // the right child follows
    std::uint32_t active = 0;    // active parts in this node
  };

  // Begins a tree of so many parts. Nodes are made by makeSome().
  void begin(const ExtentTreeSettings& settings, std::uint32_t parts, std::size_t axes);
  // Makes up to so many nodes, or sorts the bounds of one axis. Whether the tree is whole. keys: the same at
  // each call. A tree that has just become whole must be rebalanced before it is asked.
  bool makeSome(const ExtentKeys& keys, std::uint32_t most, ExtentTreeWork& work);
  // Follows the parts to where they are now. All parts are active afterwards.
  void rebalance(const ExtentKeys& keys, const ExtentTable& table, ExtentTreeWork& work);

  // Adds 1 or -1 to the counts of the nodes in which the part is. keys: those of the last rebalance().
  void countActive(const ExtentKeys& keys, std::uint32_t part, std::uint32_t by);

  struct Query {
    OverlapTests tests;
    std::array<KeyInterval, kMaxExtentAxes> keys;
    std::uint32_t epoch = 0;
  };
  // Appends the parts that overlap and for which seen[part] < epoch, and sets that to epoch. Not sorted.
  // Returns how many parts the leaves held that it went to.
  std::uint64_t query(const Query& query, std::span<std::uint32_t> seen,
                      std::vector<std::uint32_t>& parts) const;

  // For tests: node 0 is the root.
  std::span<const Node> nodes() const { return nodes_; }
  std::span<const std::uint32_t> partsOfLeaf(std::uint32_t node) const;
  std::span<const Bound> lowsOf(std::uint32_t node) const;  // of inner nodes
  std::span<const Bound> highsOf(std::uint32_t node) const;

 private:
  // Where a node's lists are. Inner nodes: rows of bounds_, all lower ones and then all upper ones, which are
  // `rows` long each. Leaves: rows of leaf_parts_ and leaf_bounds_.
  struct List {
    std::uint32_t first = 0, count = 0, size_class = 0;
  };
  struct Pending {  // a node to be made: its bounds of all tree axes are in lists_, from `first`
    std::uint32_t node = 0, count = 0, depth = 0;
    std::size_t first = 0;
  };
  struct Handed {  // what a node is handed by its parent: parts in handed_, first the added ones
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
  std::vector<List> node_lists_;  // one a node
  std::size_t axes_ = 0;
  std::uint32_t parts_ = 0;

  RowBlocks inner_rows_, leaf_rows_;
  std::vector<Bound> bounds_;              // two a row
  std::vector<std::uint32_t> leaf_parts_;  // one a row
  std::vector<float> leaf_bounds_;  // 2 * axes_ a row; in a block, for each axis: all lows, then all highs

  // While building.
  std::vector<std::uint32_t> tree_axes_;
  std::uint32_t min_gain_ = 1;
  std::size_t sorted_axes_ = 0;
  std::uint64_t copies_ = 0;  // parts in leaves and pending nodes
  std::vector<Bound> lists_;  // a stack: of each pending node, for each tree axis: lower bounds, upper bounds
  std::vector<Bound> left_lists_;
  std::vector<Pending> pending_;
  std::vector<std::uint8_t> sides_;  // one a part: 1 left, 2 right

  // While rebalancing.
  std::vector<std::uint32_t> handed_;  // a stack of part numbers
  std::vector<std::uint32_t> dropped_left_, dropped_right_;
  std::vector<Bound> added_;
  std::vector<std::uint32_t> stamps_;  // one a part
  std::uint32_t stamp_ = 0;
};

}  // namespace sightline::comparison
