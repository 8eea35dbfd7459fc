// Building the tree. Each node is divided along the axis of minimum cost, and one pass over its lists makes
// those of its children without sorting again.
//
// Based on: Snyder, Lengyel. MSR-TR-97-11, section 5.2.2.

#include <algorithm>

#include "src/comparison/layers/extent_nodes.h"

namespace sightline::comparison {

void ExtentNodes::begin(const ExtentTreeSettings& settings, std::uint32_t parts, std::size_t axes) {
  axes_ = axes;
  parts_ = parts;
  min_gain_ = std::max(settings.min_gain, 1u);
  tree_axes_.clear();
  for (std::uint32_t axis = 0; axis < axes; ++axis) {
    if ((settings.tree_axes >> axis & 1u) != 0) {
      tree_axes_.push_back(axis);
    }
  }
  nodes_.assign(1, Node{});
  node_lists_.assign(1, List{});
  inner_rows_.clear();
  leaf_rows_.clear();
  sides_.assign(parts, 0);
  stamps_.assign(parts, 0);
  stamp_ = 0;
  sorted_axes_ = 0;
  copies_ = parts;
  lists_.resize(2 * tree_axes_.size() * parts);
  pending_.assign(1, Pending{0, parts, 0, 0});
}

bool ExtentNodes::makeSome(const ExtentKeys& keys, std::uint32_t max_nodes, ExtentTreeWork& work) {
  if (sorted_axes_ < tree_axes_.size()) {
    sortAxis(keys);
    return false;
  }
  for (; max_nodes > 0 && !pending_.empty(); --max_nodes) {
    makeNode();
    ++work.nodes_made;
  }
  if (pending_.empty()) {
    reserve();
  }
  return pending_.empty();
}

void ExtentNodes::sortAxis(const ExtentKeys& keys) {
  const std::uint32_t axis = tree_axes_[sorted_axes_];
  Bound* const lows = lists_.data() + 2 * sorted_axes_ * parts_;
  Bound* const highs = lows + parts_;
  for (std::uint32_t part = 0; part < parts_; ++part) {
    lows[part] = makeBound(keys.lows[axis][part], part);
    highs[part] = makeBound(keys.highs[axis][part], part);
  }
  std::sort(lows, highs);
  std::sort(highs, highs + parts_);
  ++sorted_axes_;
}

std::span<const Bound> ExtentNodes::listOf(const Pending& pending, std::size_t list) const {
  return {lists_.data() + pending.first + list * pending.count, pending.count};
}

void ExtentNodes::makeNode() {
  const Pending pending = pending_.back();
  Choice choice;
  if (choose(pending, choice)) {
    makeInner(pending, choice);
    shareOut(pending, choice);
    return;
  }
  pending_.pop_back();
  if (tree_axes_.empty()) {  // a single leaf
    left_lists_.resize(parts_);
    for (std::uint32_t part = 0; part < parts_; ++part) {
      left_lists_[part] = makeBound(0, part);
    }
    makeLeaf(pending.node, left_lists_);
  } else {
    makeLeaf(pending.node, listOf(pending, 0));
  }
  lists_.resize(pending.first);
}

// Chooses a division. Returns false if the node becomes a leaf.
bool ExtentNodes::choose(const Pending& pending, Choice& choice) const {
  if (tree_axes_.empty() || pending.count < min_gain_ || pending.depth >= kMaxDepth) {
    return false;
  }
  for (std::size_t list = 0; list < tree_axes_.size(); ++list) {
    const Division division = minCost(listOf(pending, 2 * list), listOf(pending, 2 * list + 1));
    if (list == 0 || division.betterThan(choice.division)) {
      choice = {list, division};
    }
  }
  return pending.count - choice.division.longer() >= min_gain_ &&
         copies_ + choice.division.shared <= std::uint64_t{kMaxCopies} * parts_;
}

void ExtentNodes::makeInner(const Pending& pending, const Choice& choice) {
  const auto left = static_cast<std::uint32_t>(nodes_.size());
  nodes_.resize(nodes_.size() + 2);
  node_lists_.resize(nodes_.size());
  nodes_[pending.node] = {choice.division.value, tree_axes_[choice.list], left, 0};
  List& list = node_lists_[pending.node];
  takeInner(list, pending.count);
  const std::span<const Bound> all_lows = listOf(pending, 2 * choice.list);
  const std::span<const Bound> all_highs = listOf(pending, 2 * choice.list + 1);
  Bound* const own_lows = lows(list);
  Bound* const own_highs = highs(list);
  const std::uint32_t not_right = pending.count - choice.division.right;
  for (std::uint32_t i = 0; i < pending.count; ++i) {
    const bool is_left = i < choice.division.left, is_right = i >= not_right;
    own_lows[i] = all_lows[i] | static_cast<Bound>(is_left);
    own_highs[i] = all_highs[i] | static_cast<Bound>(is_right);
    sides_[partOf(all_lows[i])] = 0;
  }
  for (std::uint32_t i = 0; i < choice.division.left; ++i) {
    sides_[partOf(all_lows[i])] = 1;
  }
  for (std::uint32_t i = not_right; i < pending.count; ++i) {
    sides_[partOf(all_highs[i])] |= 2;
  }
}

// Replaces the parent's lists at the top of the stack by those of the right child and, above them, those of
// the left child. The right child's lists overwrite what has been read.
void ExtentNodes::shareOut(const Pending& pending, const Choice& choice) {
  const std::size_t lists = 2 * tree_axes_.size();
  left_lists_.clear();
  Bound* to = lists_.data() + pending.first;
  const Bound* const all = to;
  for (std::size_t i = 0; i < lists * pending.count; ++i) {
    const Bound bound = all[i];
    const std::uint8_t side = sides_[partOf(bound)];
    if ((side & 1) != 0) {
      left_lists_.push_back(bound);
    }
    if ((side & 2) != 0) {
      *to++ = bound;
    }
  }
  const std::uint32_t left = nodes_[pending.node].left, depth = pending.depth + 1;
  const std::size_t left_first = pending.first + lists * choice.division.right;
  lists_.resize(left_first);
  lists_.insert(lists_.end(), left_lists_.begin(), left_lists_.end());
  pending_.back() = {left + 1, choice.division.right, depth, pending.first};
  pending_.push_back({left, choice.division.left, depth, left_first});
  copies_ += choice.division.shared;
}

void ExtentNodes::makeLeaf(std::uint32_t node, std::span<const Bound> bounds) {
  List& list = node_lists_[node];
  takeLeaf(list, static_cast<std::uint32_t>(bounds.size()));
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    leaf_parts_[list.first + i] = partOf(bounds[i]);
  }
}

// Blocks have room for an eighth more rows, so that few nodes need a larger block when parts move.
void ExtentNodes::takeInner(List& list, std::uint32_t count) {
  list.count = count;
  list.size_class = RowBlocks::classFor(count + count / 8);
  list.first = inner_rows_.take(list.size_class);
  if (bounds_.size() < 2 * std::size_t{inner_rows_.rows()}) {
    bounds_.resize(2 * std::size_t{inner_rows_.rows()});
  }
}

void ExtentNodes::takeLeaf(List& list, std::uint32_t count) {
  list.count = count;
  list.size_class = RowBlocks::classFor(count + count / 8);
  list.first = leaf_rows_.take(list.size_class);
  if (leaf_parts_.size() < leaf_rows_.rows()) {
    leaf_parts_.resize(leaf_rows_.rows());
    leaf_bounds_.resize(2 * axes_ * leaf_rows_.rows());
  }
}

// Reserves memory for moving parts, so that frames do not allocate. Other trees of the same parts differ a
// little in size, so more is reserved than is needed.
void ExtentNodes::reserve() {
  const auto reserveFor = [](auto& list, std::size_t size) {
    if (list.capacity() < size) {
      list.reserve(size + size / 2);
    }
  };
  const std::uint32_t inner = inner_rows_.rows() + inner_rows_.rows() / 2;
  const std::uint32_t leaf = leaf_rows_.rows() + leaf_rows_.rows() / 2;
  inner_rows_.reserve(inner);
  leaf_rows_.reserve(leaf);
  reserveFor(bounds_, 2 * std::size_t{inner});
  reserveFor(leaf_parts_, leaf);
  reserveFor(leaf_bounds_, 2 * axes_ * leaf);
  reserveFor(handed_, std::size_t{4} * parts_);
  reserveFor(dropped_left_, parts_);
  reserveFor(dropped_right_, parts_);
  reserveFor(added_, parts_);
}

}  // namespace sightline::comparison
