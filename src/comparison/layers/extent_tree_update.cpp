// Rebalancing: a node keeps its axis, and its value follows the parts.
//
// Based on: Snyder, Lengyel. MSR-TR-97-11, section 5.2.3.

#include <algorithm>

#include "src/comparison/layers/extent_nodes.h"

namespace sightline::comparison {
namespace {

constexpr Bound kMark = 1;

// Average number of places by which insertion moves a bound before the list is sorted outright.
constexpr std::uint64_t kMaxPlacesEach = 48;

// Returns the bound with its current key.
inline Bound refreshed(Bound bound, const std::uint32_t* keys) {
  return (Bound{keys[partOf(bound)]} << 32) | (bound & 0xffffffffu);
}

// Returns false if the list was too disordered and was sorted outright; the order is total, so the result is
// the same.
bool sortByInsertion(Bound* bounds, std::uint32_t count) {
  std::uint64_t places_left = kMaxPlacesEach * count + 64;
  for (std::uint32_t i = 1; i < count; ++i) {
    const Bound bound = bounds[i];
    std::uint32_t to = i;
    while (to > 0 && bounds[to - 1] > bound) {
      bounds[to] = bounds[to - 1];
      --to;
    }
    bounds[to] = bound;
    if (i - to > places_left) {
      std::sort(bounds, bounds + count);
      return false;
    }
    places_left -= i - to;
  }
  return true;
}

}  // namespace

struct ExtentNodes::Frame {
  const ExtentKeys& keys;
  const ExtentTable& table;
  ExtentTreeWork& work;
};

void ExtentNodes::rebalance(const ExtentKeys& keys, const ExtentTable& table, ExtentTreeWork& work) {
  Frame frame{keys, table, work};
  handed_.clear();
  visit(0, {}, frame);
}

void ExtentNodes::visit(std::uint32_t node, const Handed& handed, Frame& frame) {
  if (nodes_[node].axis == kNone) {
    visitLeaf(node, handed, frame);
    return;
  }
  ++frame.work.nodes_visited;
  List& list = node_lists_[node];
  const std::uint32_t axis = nodes_[node].axis;
  dropped_left_.clear();
  dropped_right_.clear();
  if (handed.removed > 0) {
    stampRemoved(handed);
  }
  const bool low_moved = refresh(lows(list), list.count, frame.keys.lows[axis], handed, dropped_left_, frame);
  const bool high_moved =
      refresh(highs(list), list.count, frame.keys.highs[axis], handed, dropped_right_, frame);
  list.count -= static_cast<std::uint32_t>(handed.removed);
  if (handed.added > 0) {
    const std::uint32_t old = list.count;
    growInner(list, old + static_cast<std::uint32_t>(handed.added));
    merge(handed, frame.keys.lows[axis], lows(list), old);
    merge(handed, frame.keys.highs[axis], highs(list), old);
  }
  nodes_[node].active = list.count;
  Handed left, right;
  if (low_moved || high_moved || handed.added + handed.removed > 0) {
    const Division division = minCost({lows(list), list.count}, {highs(list), list.count});
    nodes_[node].value = division.value;
    left = handLeft(list, division.left);
    right = handRight(list, division.right);
    ++frame.work.nodes_divided;
    frame.work.parts_moved += left.added + left.removed + right.added + right.removed;
  }
  const std::uint32_t child = nodes_[node].left;
  const std::size_t before = handed_.size() - left.added - left.removed - right.added - right.removed;
  visit(child, left, frame);
  visit(child + 1, right, frame);
  handed_.resize(before);
}

void ExtentNodes::stampRemoved(const Handed& handed) {
  if (++stamp_ == 0) {
    std::fill(stamps_.begin(), stamps_.end(), 0u);
    stamp_ = 1;
  }
  for (std::size_t i = 0; i < handed.removed; ++i) {
    stamps_[handed_[handed.first + handed.added + i]] = stamp_;
  }
}

// Removes parts from a list, recording those that were in the child, and reads and sorts the new keys of the
// others. Returns whether a key has changed. Reading is a pass of its own, so that mispredicted branches of
// the sort do not delay it.
bool ExtentNodes::refresh(Bound* bounds, std::uint32_t count, std::span<const std::uint32_t> keys,
                          const Handed& handed, std::vector<std::uint32_t>& dropped, Frame& frame) const {
  Bound moved = 0;
  if (handed.removed == 0) {
    for (std::uint32_t i = 0; i < count; ++i) {
      const Bound bound = refreshed(bounds[i], keys.data());
      moved |= bound ^ bounds[i];
      bounds[i] = bound;
    }
  } else {
    std::uint32_t kept = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      const Bound bound = refreshed(bounds[i], keys.data());
      const bool is_dropped = stamps_[partOf(bound)] == stamp_;
      if (is_dropped && (bound & kMark) != 0) {
        dropped.push_back(partOf(bound));
      }
      moved |= bound ^ bounds[i];
      bounds[kept] = bound;
      kept += is_dropped ? 0u : 1u;
    }
    count = kept;
  }
  if (moved != 0 && !sortByInsertion(bounds, count)) {
    ++frame.work.sorted_outright;
  }
  return moved != 0;
}

// Sorts the added parts and merges them from the end.
void ExtentNodes::merge(const Handed& handed, std::span<const std::uint32_t> keys, Bound* bounds,
                        std::uint32_t count) {
  added_.clear();
  for (std::size_t i = 0; i < handed.added; ++i) {
    const std::uint32_t part = handed_[handed.first + i];
    added_.push_back(makeBound(keys[part], part));
  }
  std::sort(added_.begin(), added_.end());
  std::size_t from = count, added = added_.size();
  while (added > 0) {
    if (from > 0 && bounds[from - 1] > added_[added - 1]) {
      bounds[from + added - 1] = bounds[from - 1];
      --from;
    } else {
      bounds[from + added - 1] = added_[added - 1];
      --added;
    }
  }
}

// Grows the lists, into a larger block if needed, where the upper bounds begin at another row.
void ExtentNodes::growInner(List& list, std::uint32_t count) {
  if (count > RowBlocks::rowsOf(list.size_class)) {
    const List old = list;
    takeInner(list, count);
    std::copy_n(lows(old), old.count, lows(list));
    std::copy_n(highs(old), old.count, highs(list));
    inner_rows_.give(old.first, old.size_class);
  }
  list.count = count;
}

void ExtentNodes::growLeaf(List& list, std::uint32_t count) {
  if (count > RowBlocks::rowsOf(list.size_class)) {
    const List old = list;
    takeLeaf(list, count);
    std::copy_n(leaf_parts_.begin() + old.first, old.count, leaf_parts_.begin() + list.first);
    leaf_rows_.give(old.first, old.size_class);
  }
  list.count = count;
}

// Hands the left child the parts whose mark and place disagree: they enter or leave the child.
ExtentNodes::Handed ExtentNodes::handLeft(const List& list, std::uint32_t in_left) {
  Bound* const bounds = lows(list);
  Handed handed;
  handed.first = handed_.size();
  for (std::uint32_t i = 0; i < in_left; ++i) {
    if ((bounds[i] & kMark) == 0) {
      bounds[i] |= kMark;
      handed_.push_back(partOf(bounds[i]));
    }
  }
  handed.added = handed_.size() - handed.first;
  for (std::uint32_t i = in_left; i < list.count; ++i) {
    if ((bounds[i] & kMark) != 0) {
      bounds[i] &= ~kMark;
      handed_.push_back(partOf(bounds[i]));
    }
  }
  handed_.insert(handed_.end(), dropped_left_.begin(), dropped_left_.end());
  handed.removed = handed_.size() - handed.first - handed.added;
  return handed;
}

ExtentNodes::Handed ExtentNodes::handRight(const List& list, std::uint32_t in_right) {
  Bound* const bounds = highs(list);
  const std::uint32_t not_right = list.count - in_right;
  Handed handed;
  handed.first = handed_.size();
  for (std::uint32_t i = not_right; i < list.count; ++i) {
    if ((bounds[i] & kMark) == 0) {
      bounds[i] |= kMark;
      handed_.push_back(partOf(bounds[i]));
    }
  }
  handed.added = handed_.size() - handed.first;
  for (std::uint32_t i = 0; i < not_right; ++i) {
    if ((bounds[i] & kMark) != 0) {
      bounds[i] &= ~kMark;
      handed_.push_back(partOf(bounds[i]));
    }
  }
  handed_.insert(handed_.end(), dropped_right_.begin(), dropped_right_.end());
  handed.removed = handed_.size() - handed.first - handed.added;
  return handed;
}

void ExtentNodes::visitLeaf(std::uint32_t node, const Handed& handed, Frame& frame) {
  ++frame.work.nodes_visited;
  List& list = node_lists_[node];
  if (handed.removed > 0) {
    stampRemoved(handed);
    std::uint32_t* const parts = leaf_parts_.data() + list.first;
    std::uint32_t kept = 0;
    for (std::uint32_t i = 0; i < list.count; ++i) {
      const std::uint32_t part = parts[i];
      parts[kept] = part;
      kept += stamps_[part] == stamp_ ? 0u : 1u;
    }
    list.count = kept;
  }
  if (handed.added > 0) {
    const std::uint32_t old = list.count;
    growLeaf(list, old + static_cast<std::uint32_t>(handed.added));
    std::copy_n(handed_.begin() + static_cast<std::ptrdiff_t>(handed.first), handed.added,
                leaf_parts_.begin() + list.first + old);
  }
  fillLeaf(list, frame.table);
  nodes_[node].active = list.count;
}

void ExtentNodes::fillLeaf(const List& list, const ExtentTable& table) {
  const std::uint32_t* const parts = leaf_parts_.data() + list.first;
  const std::uint32_t rows = RowBlocks::rowsOf(list.size_class);
  float* to = leafBounds(list);
  for (std::size_t axis = 0; axis < axes_; ++axis, to += 2 * std::size_t{rows}) {
    const float* const all_lows = table.lows[axis].data();
    const float* const all_highs = table.highs[axis].data();
    for (std::uint32_t i = 0; i < list.count; ++i) {
      to[i] = all_lows[parts[i]];
      to[rows + i] = all_highs[parts[i]];
    }
  }
}

}  // namespace sightline::comparison
