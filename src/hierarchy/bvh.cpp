// Based on: Wald. On fast Construction of SAH-based Bounding Volume Hierarchies. IEEE Symposium on
// Interactive Ray Tracing 2007. Binned surface-area heuristic over box centres.

#include <algorithm>
#include <array>

#include "src/hierarchy/builder.h"

namespace sightline::hierarchy {
namespace {

constexpr int kBins = 16;

struct Bin {
  Box box;
  std::size_t count = 0;
};

struct Split {
  int axis = -1;
  int bin = 0;  // items in bins below this go left
  double low = 0.0, scale = 0.0;
};

int binOf(const Item& item, const Split& split) {
  const double at = (center(item.box)[split.axis] - split.low) * split.scale;
  return std::clamp(static_cast<int>(at), 0, kBins - 1);
}

// The cheapest of the kBins - 1 cuts of one axis by area x count of both sides; updates best.
void tryAxis(std::span<const Item> items, Split candidate, double& best_cost, Split& best) {
  std::array<Bin, kBins> bins;
  for (const Item& item : items) {
    Bin& bin = bins[static_cast<std::size_t>(binOf(item, candidate))];
    bin.box.extend(item.box);
    ++bin.count;
  }
  std::array<double, kBins> right_cost{};
  Bin right;
  for (int i = kBins - 1; i > 0; --i) {
    const Bin& bin = bins[static_cast<std::size_t>(i)];
    right.box.extend(bin.box);
    right.count += bin.count;
    right_cost[static_cast<std::size_t>(i)] = surfaceArea(right.box) * static_cast<double>(right.count);
  }
  Bin left;
  for (int i = 1; i < kBins; ++i) {
    const Bin& bin = bins[static_cast<std::size_t>(i - 1)];
    left.box.extend(bin.box);
    left.count += bin.count;
    const double cost =
        surfaceArea(left.box) * static_cast<double>(left.count) + right_cost[static_cast<std::size_t>(i)];
    if (left.count > 0 && left.count < items.size() && (best.axis < 0 || cost < best_cost)) {
      best_cost = cost;
      best = candidate;
      best.bin = i;
    }
  }
}

Split chooseSplit(std::span<const Item> items) {
  Vec3d low(center(items.front().box)), high = low;
  for (const Item& item : items) {
    low = min(low, center(item.box));
    high = max(high, center(item.box));
  }
  Split best;
  double best_cost = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double extent = high[axis] - low[axis];
    if (extent > 0.0) {
      tryAxis(items, {axis, 0, low[axis], kBins / extent}, best_cost, best);
    }
  }
  return best;
}

}  // namespace

void buildBvh(FlatWriter& writer, std::span<Item> items, const BuildLimits& limits, std::uint32_t level) {
  if (items.size() <= limits.max_leaf_objects || level + 1 >= limits.max_depth) {
    writer.leaf(items, level);
    return;
  }
  const Split split = chooseSplit(items);
  // Boxes with one common centre can't be told apart by any cut: halves are as good as anything.
  std::size_t left_count = items.size() / 2;
  if (split.axis >= 0) {
    const auto middle = std::stable_partition(
        items.begin(), items.end(), [&](const Item& item) { return binOf(item, split) < split.bin; });
    left_count = static_cast<std::size_t>(middle - items.begin());
  }
  const NodeIndex inner = writer.beginInner(items, level);
  buildBvh(writer, items.first(left_count), limits, level + 1);
  buildBvh(writer, items.subspan(left_count), limits, level + 1);
  writer.finish(inner);
}

}  // namespace sightline::hierarchy
