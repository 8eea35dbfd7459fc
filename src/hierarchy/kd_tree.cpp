// Based on: Bittner, Havran, Slavik. Hierarchical Visibility Culling with Occlusion Trees. CGI 1998,
// section 2.2. Differs from the paper in: a node's box is shrunk to what its objects have in its region, so
// that empty space is never tested; where the largest axis separates nothing the others are tried; a split
// that would copy more than half of the objects is not made.

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "src/hierarchy/builder.h"

namespace sightline::hierarchy {
namespace {

struct Split {
  int axis = -1;
  float plane = 0.0f;
  std::size_t copied = 0;  // objects on both sides
  bool found() const { return axis >= 0; }
};

bool isLeft(const Box& box, const Split& split) {
  return box.min[split.axis] < split.plane;
}
bool isRight(const Box& box, const Split& split) {
  return box.max[split.axis] > split.plane;
}

class KdTreeBuilder {
 public:
  KdTreeBuilder(FlatWriter& writer, const BuildLimits& limits, std::vector<Item> items)
      : writer_(writer), limits_(limits), items_(std::move(items)) {}

  // Builds a node of the items from number `first` on, and removes them.
  void build(std::size_t first, std::uint32_t level);

 private:
  Split chooseSplit(std::span<const Item> items);
  Split bestPlane(std::span<const Item> items, const Box& bounds, int axis);

  FlatWriter& writer_;
  const BuildLimits limits_;
  std::vector<Item> items_;  // those of nodes that wait, and of the node at work behind them
  std::vector<Item> left_;
  std::vector<float> mins_, maxs_;
};

// The boundaries of boxes at which a node may be split along an axis.
struct Window {
  double low = 0.0, high = 0.0;  // of the node
  double median = 0.0, reach = 0.0;

  bool holds(float s) const { return std::abs(s - median) <= reach && s > low && s < high; }
  // Whether a boundary that it doesn't hold lies below all that it does.
  bool isAbove(float s) const { return s <= low || (s < high && s < median); }
  double offset(float s) const { return std::abs(s - median); }
};

// The boundaries of one kind, sorted.
struct Boundaries {
  std::vector<float>& inside;
  std::ptrdiff_t below = 0;

  Boundaries(std::vector<float>& storage, const Window& window) : inside(storage) {
    const auto end = std::partition(inside.begin(), inside.end(), [&](float s) { return window.holds(s); });
    below = std::count_if(end, inside.end(), [&](float s) { return window.isAbove(s); });
    inside.erase(end, inside.end());
    std::sort(inside.begin(), inside.end());
  }
  std::ptrdiff_t countBelow(float s) const {
    return below + (std::lower_bound(inside.begin(), inside.end(), s) - inside.begin());
  }
  std::ptrdiff_t countUpTo(float s) const {
    return below + (std::upper_bound(inside.begin(), inside.end(), s) - inside.begin());
  }
};

// Returns the first lower side of a box that is as good a boundary as the best one, or else the first upper
// side.
float firstOfTie(std::span<const Item> items, const Boundaries& mins, const Boundaries& maxs,
                 const Window& window, const Split& best) {
  const auto isAsGood = [&](float s) {
    if (!window.holds(s) || window.offset(s) != window.offset(best.plane)) {
      return false;
    }
    const std::ptrdiff_t before = mins.countBelow(s), ended = maxs.countUpTo(s);
    const auto count = static_cast<std::ptrdiff_t>(items.size());
    return before > 0 && ended > 0 && before < count && ended < count &&
           std::max<std::ptrdiff_t>(0, before - ended) == static_cast<std::ptrdiff_t>(best.copied);
  };
  for (const Item& item : items) {
    if (isAsGood(item.box.min[best.axis])) {
      return item.box.min[best.axis];
    }
  }
  for (const Item& item : items) {
    if (isAsGood(item.box.max[best.axis])) {
      return item.box.max[best.axis];
    }
  }
  return best.plane;
}

// The boundary of an object's box near the spatial median that cuts the fewest boxes; ties go to the one
// nearest to the median, then to the lower sides of boxes, then to the first box. Counting boundaries in
// sorted order makes it one sweep:
//   cut(s) = #(min < s) - #(max <= s).
Split KdTreeBuilder::bestPlane(std::span<const Item> items, const Box& bounds, int axis) {
  Window window{bounds.min[axis], bounds.max[axis]};
  window.median = 0.5 * (window.low + window.high);
  window.reach = limits_.median_window * (window.high - window.low);
  mins_.clear();
  maxs_.clear();
  for (const Item& item : items) {
    mins_.push_back(item.box.min[axis]);
    maxs_.push_back(item.box.max[axis]);
  }
  const Boundaries mins(mins_, window), maxs(maxs_, window);
  const auto count = static_cast<std::ptrdiff_t>(items.size());
  Split best;
  double best_offset = 0.0;
  bool tie = false;
  // before: boxes that begin before s; ended: those that end at s or before it.
  const auto consider = [&](float s, std::ptrdiff_t before, std::ptrdiff_t ended) {
    if (before == 0 || ended == 0 || before == count || ended == count) {
      return;
    }
    // Boxes that lie in the plane itself are in neither count; they go left.
    const auto copied = static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, before - ended));
    const double offset = window.offset(s);
    if (!best.found() || copied < best.copied || (copied == best.copied && offset < best_offset)) {
      best = {axis, s, copied};
      best_offset = offset;
      tie = false;
    } else if (copied == best.copied && offset == best_offset) {
      tie = true;
    }
  };
  if (mins.inside.empty() && maxs.inside.empty()) {
    const auto s = static_cast<float>(window.median);
    std::ptrdiff_t before = 0, ended = 0;
    for (const Item& item : items) {
      before += item.box.min[axis] < s ? 1 : 0;
      ended += item.box.max[axis] <= s ? 1 : 0;
    }
    consider(s, before, ended);
    return best;
  }
  std::size_t min = 0, max = 0;
  while (min < mins.inside.size() || max < maxs.inside.size()) {
    const float s = max == maxs.inside.size()   ? mins.inside[min]
                    : min == mins.inside.size() ? maxs.inside[max]
                                                : std::min(mins.inside[min], maxs.inside[max]);
    const std::ptrdiff_t before = mins.below + static_cast<std::ptrdiff_t>(min);
    for (; max < maxs.inside.size() && maxs.inside[max] == s; ++max) {
    }
    consider(s, before, maxs.below + static_cast<std::ptrdiff_t>(max));
    for (; min < mins.inside.size() && mins.inside[min] == s; ++min) {
    }
  }
  if (tie) {
    best.plane = firstOfTie(items, mins, maxs, window, best);
  }
  return best;
}

Split KdTreeBuilder::chooseSplit(std::span<const Item> items) {
  Box bounds;
  for (const Item& item : items) {
    bounds.extend(item.box);
  }
  std::array<int, 3> axes{0, 1, 2};
  const Vec3f extent = bounds.extent();
  std::stable_sort(axes.begin(), axes.end(), [&](int a, int b) { return extent[a] > extent[b]; });
  for (const int axis : axes) {
    const Split split = bestPlane(items, bounds, axis);
    if (split.found() && split.copied * 2 <= items.size()) {
      return split;
    }
  }
  return {};
}

void KdTreeBuilder::build(std::size_t first, std::uint32_t level) {
  const std::size_t end = items_.size();
  Split split;
  if (end - first > limits_.max_leaf_objects && level + 1 < limits_.max_depth) {
    split = chooseSplit(std::span(items_).subspan(first));
  }
  if (!split.found()) {
    writer_.leaf(std::span(items_).subspan(first), level);
    items_.resize(first);
    return;
  }
  const NodeIndex inner = writer_.beginInner(std::span(items_).subspan(first), level);
  // The left half takes the place of all, behind the right one, so that it is built and removed first.
  left_.clear();
  std::size_t right_end = first;
  for (std::size_t i = first; i < end; ++i) {
    const Item item = items_[i];
    const bool in_right = isRight(item.box, split);
    if (isLeft(item.box, split) || !in_right) {
      left_.push_back(item);
      left_.back().box.max[split.axis] = std::min(item.box.max[split.axis], split.plane);
    }
    if (in_right) {
      Item& right = items_[right_end++];
      right = item;
      right.box.min[split.axis] = std::max(item.box.min[split.axis], split.plane);
    }
  }
  items_.resize(right_end);
  items_.insert(items_.end(), left_.begin(), left_.end());
  build(right_end, level + 1);
  build(first, level + 1);
  writer_.finish(inner);
}

}  // namespace

void buildKdTree(FlatWriter& writer, std::vector<Item> items, const BuildLimits& limits,
                 std::uint32_t level) {
  KdTreeBuilder(writer, limits, std::move(items)).build(0, level);
}

}  // namespace sightline::hierarchy
