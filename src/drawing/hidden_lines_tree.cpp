#include "src/drawing/hidden_lines_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sightline::drawing {

HidingBox HidingBox::none() {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  return {kInfinity, kInfinity, -kInfinity, -kInfinity, -kInfinity};
}

void HidingBox::extend(const ScreenPoint& point) {
  extend(HidingBox{point.x, point.y, point.x, point.y, point.reciprocal_depth});
}

void HidingBox::extend(const HidingBox& box) {
  min_x = std::min(min_x, box.min_x);
  min_y = std::min(min_y, box.min_y);
  max_x = std::max(max_x, box.max_x);
  max_y = std::max(max_y, box.max_y);
  reciprocal_depth = std::max(reciprocal_depth, box.reciprocal_depth);
}

void HidingBox::widen(double reach) {
  constexpr double kWider = 0x1p-40;
  const double wider =
      kWider * (std::abs(min_x) + std::abs(min_y) + std::abs(max_x) + std::abs(max_y) + reach);
  min_x -= wider;
  min_y -= wider;
  max_x += wider;
  max_y += wider;
  reciprocal_depth += kWider * std::abs(reciprocal_depth);
}

bool ScreenLine::mayBeHiddenBy(const HidingBox& box, double& first, double& last) const {
  first = 0.0;
  last = 1.0;
  if (!narrow(from.x - box.min_x, to.x - box.min_x, first, last) ||
      !narrow(box.max_x - from.x, box.max_x - to.x, first, last) ||
      !narrow(from.y - box.min_y, to.y - box.min_y, first, last) ||
      !narrow(box.max_y - from.y, box.max_y - to.y, first, last)) {
    return false;
  }
  const double slope = to.reciprocal_depth - from.reciprocal_depth;
  return from.reciprocal_depth + slope * (slope > 0.0 ? first : last) <= box.reciprocal_depth;
}

void HidingTrees::clear() {
  nodes_.clear();
  ids_.clear();
}

std::uint32_t HidingTrees::add(std::span<Item> items) {
  if (items.empty()) {
    return kNoTree;
  }
  const auto index = static_cast<std::uint32_t>(nodes_.size());
  Node node{HidingBox::none(), 0, 0};
  for (const Item& item : items) {
    node.box.extend(item.box);
  }
  nodes_.push_back(node);
  if (items.size() <= kLeaf) {
    nodes_[index].first = static_cast<std::uint32_t>(ids_.size());
    nodes_[index].count = static_cast<std::uint32_t>(items.size());
    for (const Item& item : items) {
      ids_.push_back(item.id);
    }
    return index;
  }
  const bool along_x = node.box.max_x - node.box.min_x > node.box.max_y - node.box.min_y;
  const auto middle = [along_x](const HidingBox& b) {
    return along_x ? b.min_x + b.max_x : b.min_y + b.max_y;
  };
  const std::size_t half = items.size() / 2;
  std::nth_element(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(half), items.end(),
                   [&](const Item& a, const Item& b) {
                     const double x = middle(a.box);
                     const double y = middle(b.box);
                     return x < y || (x == y && a.id < b.id);
                   });
  add(items.first(half));
  const std::uint32_t second = add(items.subspan(half));
  nodes_[index].first = second;
  return index;
}

}  // namespace sightline::drawing
