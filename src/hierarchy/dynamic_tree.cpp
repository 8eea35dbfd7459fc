#include "src/hierarchy/dynamic_tree.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <utility>

#include "src/math/longest_axis.h"

namespace sightline::hierarchy {
namespace {

constexpr std::uint32_t kStepsOfItem = 5;  // that building takes, for each item
constexpr double kWorn = 4.0;              // times the surface area that a node had when it was built

Box united(const Box& a, const Box& b) {
  Box box = a;
  box.extend(b);
  return box;
}

// The axis along which the centres of boxes are spread most.
int axisOfSpread(std::span<const DynamicTree::Item> items) {
  Vec3d low = center(items[0].box), high = low;
  for (const DynamicTree::Item& item : items) {
    low = min(low, center(item.box));
    high = max(high, center(item.box));
  }
  return math::longestAxis(high - low);
}

void sortAlong(std::span<DynamicTree::Item> items, int axis) {
  std::sort(items.begin(), items.end(), [axis](const DynamicTree::Item& a, const DynamicTree::Item& b) {
    const float x = a.box.min[axis] + a.box.max[axis], y = b.box.min[axis] + b.box.max[axis];
    return x != y ? x < y : a.number < b.number;
  });
}

}  // namespace

std::uint32_t DynamicTree::newNode(std::uint32_t height) {
  std::uint32_t node;
  if (!free_.empty()) {
    node = free_.back();
    free_.pop_back();
  } else {
    node = static_cast<std::uint32_t>(nodes_.size());
    nodes_.emplace_back();
    boxes_.resize(boxes_.size() + kChildren);
    children_.resize(children_.size() + kChildren);
  }
  NodeData& data = nodes_[node];
  // It may still be listed as loose or worn from its earlier use.
  data = {.height = static_cast<std::uint8_t>(height), .loose = data.loose, .worn = data.worn};
  return node;
}

void DynamicTree::freeNode(std::uint32_t node) {
  nodes_[node].count = 0;
  nodes_[node].parent = kNone;
  free_.push_back(node);
}

Box DynamicTree::boundsOf(std::uint32_t node) const {
  Box box;
  for (const Box& child : this->node(node).boxes) {
    box.extend(child);
  }
  return box;
}

// Writes down where the child at this place is.
void DynamicTree::setPlace(std::uint32_t place, bool leaf) {
  if (leaf) {
    places_[children_[place]] = place;
  } else {
    nodes_[children_[place]].parent = place;
  }
}

// The leaf whose box grows least, level by level.
std::uint32_t DynamicTree::leafFor(const Box& box) const {
  std::uint32_t at = root_;
  while (nodes_[at].height > 0) {
    const Node children = node(at);
    double least = std::numeric_limits<double>::infinity(), least_area = least;
    std::size_t best = 0;
    for (std::size_t i = 0; i < children.boxes.size(); ++i) {
      const double area = surfaceArea(children.boxes[i]);
      const double growth = surfaceArea(united(children.boxes[i], box)) - area;
      if (growth < least || (growth == least && area < least_area)) {
        least = growth;
        least_area = area;
        best = i;
      }
    }
    at = children.children[best];
  }
  return at;
}

void DynamicTree::insert(const Item& item) {
  assert(item.box.wellFormed() && !has(item.number));
  if (places_.size() <= item.number) {
    places_.resize(std::size_t{item.number} + 1, kNone);
  }
  if (root_ == kNone) {
    root_ = newNode(0);
  }
  ++size_;
  addChild(leafFor(item.box), item.number, item.box);
}

void DynamicTree::rebuild() {
  collected_.clear();
  if (root_ != kNone) {
    collect(root_, false);
  }
  build(std::vector<Item>(std::move(collected_)));
}

void DynamicTree::insert(std::span<const Item> items) {
  constexpr std::size_t kMany = 8;  // building takes about so many times less for an item than inserting it
  if (items.size() * kMany < size_) {
    for (const Item& item : items) {
      insert(item);
    }
    return;
  }
  collected_.clear();
  if (root_ != kNone) {
    collect(root_, false);
  }
  collected_.insert(collected_.end(), items.begin(), items.end());
  build(std::vector<Item>(std::move(collected_)));
}

void DynamicTree::addChild(std::uint32_t node, std::uint32_t child, const Box& box) {
  NodeData& data = nodes_[node];
  if (data.count == kChildren) {
    split(node, child, box);
    return;
  }
  const std::uint32_t place = node * kChildren + data.count++;
  boxes_[place] = box;
  children_[place] = child;
  setPlace(place, data.height == 0);
  grow(node, box);
}

// Makes the boxes of a node and of those above contain this one.
void DynamicTree::grow(std::uint32_t node, const Box& box) {
  for (std::uint32_t at = nodes_[node].parent; at != kNone && !contains(boxes_[at], box);
       at = nodes_[at / kChildren].parent) {
    boxes_[at].extend(box);
  }
}

// Divides a full node, with one more child, in two: where the sum of surface areas, each by its number of
// children, is least.
void DynamicTree::split(std::uint32_t node, std::uint32_t child, const Box& box) {
  std::array<Item, kChildren + 1> all;
  for (std::uint32_t i = 0; i < kChildren; ++i) {
    all[i] = {children_[node * kChildren + i], boxes_[node * kChildren + i]};
  }
  all[kChildren] = {child, box};
  double least = std::numeric_limits<double>::infinity();
  std::array<Item, kChildren + 1> best = all;
  std::size_t first_count = (kChildren + 1) / 2;
  for (int axis = 0; axis < 3; ++axis) {
    sortAlong(all, axis);
    std::array<double, kChildren + 1> behind{};
    Box bounds;
    for (std::size_t i = kChildren + 1; i-- > 0;) {
      bounds.extend(all[i].box);
      behind[i] = surfaceArea(bounds);
    }
    bounds = {};
    for (std::size_t i = 1; i + kFew <= kChildren + 1; ++i) {
      bounds.extend(all[i - 1].box);
      const double cost =
          surfaceArea(bounds) * static_cast<double>(i) + behind[i] * static_cast<double>(kChildren + 1 - i);
      if (i >= kFew && cost < least) {
        least = cost;
        best = all;
        first_count = i;
      }
    }
  }
  const std::uint32_t height = nodes_[node].height;
  const std::uint32_t other = newNode(height);
  const auto take = [&](std::uint32_t to, std::span<const Item> items) {
    nodes_[to].count = static_cast<std::uint8_t>(items.size());
    for (std::uint32_t i = 0; i < items.size(); ++i) {
      const std::uint32_t place = to * kChildren + i;
      children_[place] = items[i].number;
      boxes_[place] = items[i].box;
      setPlace(place, height == 0);
    }
    const Box bounds = boundsOf(to);
    nodes_[to].built_area = surfaceArea(bounds);
    return bounds;
  };
  const Box first = take(node, std::span(best).first(first_count)),
            second = take(other, std::span(best).subspan(first_count));
  if (node == root_) {
    assert(height + 1 < kMaxHeight);
    root_ = newNode(height + 1);
    addChild(root_, node, first);
  } else {
    boxes_[nodes_[node].parent] = first;
    grow(nodes_[node].parent / kChildren, first);
    loosen(nodes_[node].parent / kChildren);
  }
  addChild(nodes_[node].parent / kChildren, other, second);
}

void DynamicTree::remove(std::uint32_t number) {
  assert(has(number));
  const std::uint32_t place = places_[number];
  places_[number] = kNone;
  --size_;
  removeChild(place);
}

void DynamicTree::removeChild(std::uint32_t place) {
  const std::uint32_t node = place / kChildren;
  NodeData& data = nodes_[node];
  const std::uint32_t last = node * kChildren + --data.count;
  if (place != last) {
    boxes_[place] = boxes_[last];
    children_[place] = children_[last];
    setPlace(place, data.height == 0);
  }
  if (data.count == 0) {
    if (data.parent == kNone) {
      root_ = kNone;
    } else {
      removeChild(data.parent);
    }
    freeNode(node);
    return;
  }
  loosen(node);
  if (data.count < kFew && data.parent != kNone) {
    wear(data.parent / kChildren);
  }
}

// What leaves its node altogether is put where it belongs, unless it is alone there.
void DynamicTree::move(const Item& item) {
  assert(has(item.number) && item.box.wellFormed());
  const std::uint32_t place = places_[item.number], node = place / kChildren;
  const std::uint32_t parent = nodes_[node].parent;
  if (parent != kNone && !overlaps(boxes_[parent], item.box)) {
    remove(item.number);
    insert(item);
    return;
  }
  boxes_[place] = item.box;
  grow(node, item.box);
  loosen(node);
}

void DynamicTree::loosen(std::uint32_t node) {
  NodeData& data = nodes_[node];
  if (!data.loose) {
    data.loose = true;
    loose_[data.height].push_back(node);
  }
}

void DynamicTree::wear(std::uint32_t node) {
  NodeData& data = nodes_[node];
  if (!data.worn) {
    data.worn = true;
    worn_.push_back(node);
  }
}

// Sets the box of a node to that of its children.
void DynamicTree::tighten(std::uint32_t node) {
  const NodeData& data = nodes_[node];
  if (data.count == 0 || data.parent == kNone) {
    return;
  }
  const Box bounds = boundsOf(node);
  const std::uint32_t above = data.parent / kChildren;
  if (!(bounds == boxes_[data.parent])) {
    boxes_[data.parent] = bounds;
    loosen(above);
  }
  if (surfaceArea(bounds) > kWorn * data.built_area) {
    wear(above);
  }
}

std::uint32_t DynamicTree::tidy(std::uint32_t steps) {
  for (std::vector<std::uint32_t>& list : loose_) {
    while (!list.empty() && steps > 0) {
      const std::uint32_t node = list.back();
      list.pop_back();
      nodes_[node].loose = false;
      tighten(node);
      --steps;
    }
  }
  while (!worn_.empty() && steps > 0) {
    const std::uint32_t node = worn_.back();
    worn_.pop_back();
    nodes_[node].worn = false;
    if (nodes_[node].count == 0 || nodes_[node].height == 0) {
      continue;  // it is gone, or is another node by now
    }
    const std::uint32_t items = itemsBelow(node);
    if (items <= kMaxRebuilt) {
      rebuild(node);
      steps -= std::min(kStepsOfItem * items, steps);
    }
  }
  return steps;
}

std::uint32_t DynamicTree::itemsBelow(std::uint32_t number) const {
  const Node children = node(number);
  if (children.leaf) {
    return static_cast<std::uint32_t>(children.boxes.size());
  }
  std::uint32_t items = 0;
  for (const std::uint32_t child : children.children) {
    items += itemsBelow(child);
  }
  return items;
}

// Appends the items below a node to collected_ and frees all nodes below it, and the node unless it is kept.
void DynamicTree::collect(std::uint32_t number, bool keep) {
  const Node children = node(number);
  for (std::size_t i = 0; i < children.boxes.size(); ++i) {
    if (children.leaf) {
      collected_.push_back({children.children[i], children.boxes[i]});
    } else {
      collect(children.children[i], false);
    }
  }
  if (!keep) {
    freeNode(number);
  }
}

void DynamicTree::rebuild(std::uint32_t node) {
  collected_.clear();
  collect(node, true);
  nodes_[node].count = 0;
  fill(node, collected_);
  loosen(node);
  if (nodes_[node].count < kFew && nodes_[node].parent != kNone) {
    wear(nodes_[node].parent / kChildren);
  }
}

// Leaves room in each leaf for items to come.
std::uint32_t DynamicTree::heightFor(std::size_t items) const {
  std::uint32_t height = 0;
  for (std::size_t room = kChildren * 3 / 4; room < items; room *= kChildren) {
    ++height;
  }
  return height;
}

// Divides items among the children of an empty node, by medians.
void DynamicTree::fill(std::uint32_t node, std::span<Item> items) {
  const std::uint32_t height = nodes_[node].height;
  if (height == 0) {
    nodes_[node].count = static_cast<std::uint8_t>(items.size());
    for (std::uint32_t i = 0; i < items.size(); ++i) {
      const std::uint32_t place = node * kChildren + i;
      children_[place] = items[i].number;
      boxes_[place] = items[i].box;
      setPlace(place, true);
    }
  } else {
    std::size_t room = kChildren * 3 / 4;
    for (std::uint32_t h = 1; h < height; ++h) {
      room *= kChildren;
    }
    // Even shares, so that the divisions are in the middle.
    const std::size_t shares = std::clamp<std::size_t>((items.size() + room - 1) / room, 1, kChildren);
    struct Share {
      std::size_t first, count, shares;
    };
    std::array<Share, kChildren> open;
    std::size_t opened = 0;
    open[opened++] = {0, items.size(), shares};
    while (opened > 0) {
      const Share share = open[--opened];
      if (share.shares > 1) {
        const std::size_t left = share.shares / 2, count = share.count * left / share.shares;
        const std::span<Item> part = items.subspan(share.first, share.count);
        const int axis = axisOfSpread(part);
        std::nth_element(part.begin(), part.begin() + static_cast<std::ptrdiff_t>(count), part.end(),
                         [axis](const Item& a, const Item& b) {
                           const float x = a.box.min[axis] + a.box.max[axis],
                                       y = b.box.min[axis] + b.box.max[axis];
                           return x != y ? x < y : a.number < b.number;
                         });
        open[opened++] = {share.first + count, share.count - count, share.shares - left};
        open[opened++] = {share.first, count, left};
        continue;
      }
      if (share.count == 0) {
        continue;
      }
      const std::uint32_t child = newNode(height - 1);
      const std::uint32_t place = node * kChildren + nodes_[node].count++;
      children_[place] = child;
      setPlace(place, false);
      fill(child, items.subspan(share.first, share.count));
      boxes_[place] = boundsOf(child);
    }
  }
  nodes_[node].built_area = surfaceArea(boundsOf(node));
}

void DynamicTree::build(std::span<const Item> items) {
  *this = DynamicTree();
  if (items.empty()) {
    return;
  }
  std::uint32_t bound = 0;
  for (const Item& item : items) {
    assert(item.box.wellFormed());
    bound = std::max(bound, item.number + 1);
  }
  places_.assign(bound, kNone);
  collected_.assign(items.begin(), items.end());
  size_ = items.size();
  root_ = newNode(heightFor(items.size()));
  fill(root_, collected_);
  collected_ = {};
}

}  // namespace sightline::hierarchy
