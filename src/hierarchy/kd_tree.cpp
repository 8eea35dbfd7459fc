// Based on: Bittner, Havran, Slavik. Hierarchical Visibility Culling with Occlusion Trees. CGI 1998,
// section 2.2. Differs from the paper in: a node's box is shrunk to what its objects have in its region, so
// that empty space is never tested; where the largest axis separates nothing the others are tried; a split
// that would copy more than half of the objects is not made.

#include <algorithm>
#include <array>
#include <cmath>

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

// The boundary of an object's box near the spatial median that cuts the fewest boxes; ties go to the one
// nearest to the median. Counting boundaries in sorted order makes it one sweep:
//   cut(s) = #(min < s) - #(max <= s).
Split bestPlane(std::span<const Item> items, const Box& bounds, int axis, double window) {
  const double low = bounds.min[axis], high = bounds.max[axis];
  const double median = 0.5 * (low + high), reach = window * (high - low);
  std::vector<float> mins, maxs, candidates;
  for (const Item& item : items) {
    mins.push_back(item.box.min[axis]);
    maxs.push_back(item.box.max[axis]);
  }
  for (const std::vector<float>* boundaries : {&mins, &maxs}) {
    for (const float s : *boundaries) {
      if (std::abs(s - median) <= reach && s > low && s < high) {
        candidates.push_back(s);
      }
    }
  }
  if (candidates.empty()) {
    candidates.push_back(static_cast<float>(median));
  }
  std::sort(mins.begin(), mins.end());
  std::sort(maxs.begin(), maxs.end());
  Split best;
  double best_offset = 0.0;
  for (const float s : candidates) {
    const auto left = std::lower_bound(mins.begin(), mins.end(), s) - mins.begin();
    const auto not_right = std::upper_bound(maxs.begin(), maxs.end(), s) - maxs.begin();
    const auto right = static_cast<std::ptrdiff_t>(items.size()) - not_right;
    // Boxes that lie in the plane itself are in neither count; they go left.
    const std::ptrdiff_t both = std::max<std::ptrdiff_t>(0, left - not_right);
    if (left == 0 || right == 0 || std::max(left, right) == static_cast<std::ptrdiff_t>(items.size())) {
      continue;
    }
    const double offset = std::abs(s - median);
    const auto copied = static_cast<std::size_t>(both);
    if (!best.found() || copied < best.copied || (copied == best.copied && offset < best_offset)) {
      best = {axis, s, copied};
      best_offset = offset;
    }
  }
  return best;
}

Split chooseSplit(std::span<const Item> items, const BuildLimits& limits) {
  Box bounds;
  for (const Item& item : items) {
    bounds.extend(item.box);
  }
  std::array<int, 3> axes{0, 1, 2};
  const Vec3f extent = bounds.extent();
  std::stable_sort(axes.begin(), axes.end(), [&](int a, int b) { return extent[a] > extent[b]; });
  for (const int axis : axes) {
    const Split split = bestPlane(items, bounds, axis, limits.median_window);
    if (split.found() && split.copied * 2 <= items.size()) {
      return split;
    }
  }
  return {};
}

}  // namespace

void buildKdTree(FlatWriter& writer, std::vector<Item> items, const BuildLimits& limits,
                 std::uint32_t level) {
  Split split;
  if (items.size() > limits.max_leaf_objects && level + 1 < limits.max_depth) {
    split = chooseSplit(items, limits);
  }
  if (!split.found()) {
    writer.leaf(items, level);
    return;
  }
  std::vector<Item> left, right;
  for (const Item& item : items) {
    const bool in_right = isRight(item.box, split);
    const bool in_left = isLeft(item.box, split) || !in_right;
    if (in_left) {
      left.push_back(item);
      left.back().box.max[split.axis] = std::min(item.box.max[split.axis], split.plane);
    }
    if (in_right) {
      right.push_back(item);
      right.back().box.min[split.axis] = std::max(item.box.min[split.axis], split.plane);
    }
  }
  const NodeIndex inner = writer.beginInner(items, level);
  items = {};
  buildKdTree(writer, std::move(left), limits, level + 1);
  buildKdTree(writer, std::move(right), limits, level + 1);
  writer.finish(inner);
}

}  // namespace sightline::hierarchy
