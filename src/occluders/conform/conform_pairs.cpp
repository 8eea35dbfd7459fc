#include "src/occluders/conform/conform_pairs.h"

#include <algorithm>
#include <cmath>

#include "sightline/base/large_vector.h"
#include "src/base/sort_keys.h"

namespace sightline::occluders {
namespace {

// The lowest 19 bits, with two zeros after each.
std::uint64_t spread(std::uint64_t bits) {
  bits = (bits | bits << 32) & 0x1f00000000ffffull;
  bits = (bits | bits << 16) & 0x1f0000ff0000ffull;
  bits = (bits | bits << 8) & 0x100f00f00f00f00full;
  bits = (bits | bits << 4) & 0x10c30c30c30c30c3ull;
  return (bits | bits << 2) & 0x1249249249249249ull;
}

// Seven bits of size, the largest first, then 57 of the place.
std::uint64_t keyOf(const Box& box, const Vec3d& corner, double size) {
  const Vec3d extent = Vec3d(box.max) - Vec3d(box.min);
  int smaller = 0;
  std::frexp(size / std::max(maxComponent(extent), size * 0x1p-60), &smaller);
  std::uint64_t key = static_cast<std::uint64_t>(std::clamp(smaller, 0, 127)) << 57;
  for (int axis = 0; axis < 3; ++axis) {
    const double place = (0.5 * (double{box.min[axis]} + double{box.max[axis]}) - corner[axis]) / size;
    key |= spread(static_cast<std::uint64_t>(std::clamp(place, 0.0, 1.0) * 0x7ffff)) << axis;
  }
  return key;
}

}  // namespace

BoxPairs::BoxPairs(std::span<const Box> boxes, std::span<const std::uint32_t> numbers) {
  Box bounds;
  for (const Box& box : boxes) {
    bounds.extend(box);
  }
  const Vec3d corner(bounds.min);
  // Not zero, so that places are finite.
  const double size = boxes.empty() ? 1.0 : std::max(maxComponent(Vec3d(bounds.max) - corner), 1e-30);
  LargeVector<base::SortKey> order;  // and the number of the box
  order.reserve(boxes.size());
  for (std::uint32_t i = 0; i < boxes.size(); ++i) {
    order.push_back({keyOf(boxes[i], corner, size), i});
  }
  base::KeySorter().sort(order);
  boxes_.reserve(boxes.size());
  numbers_.reserve(boxes.size());
  for (const base::SortKey& key : order) {
    boxes_.push_back(boxes[key.second]);
    numbers_.push_back(numbers[key.second]);
  }
  for (const std::vector<Box>* below = &boxes_; below->size() > 1 || (levels_.empty() && !below->empty());) {
    std::vector<Box> level((below->size() + kWidth - 1) / kWidth);
    for (std::size_t i = 0; i < below->size(); ++i) {
      level[i / kWidth].extend((*below)[i]);
    }
    levels_.push_back(std::move(level));
    below = &levels_.back();
  }
}

std::uint32_t BoxPairs::partCount() const {
  return levels_.empty()
             ? 0
             : (static_cast<std::uint32_t>(levels_[0].size()) + kLeavesOfPart - 1) / kLeavesOfPart;
}

}  // namespace sightline::occluders
