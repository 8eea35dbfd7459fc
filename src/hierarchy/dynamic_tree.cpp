#include "src/hierarchy/dynamic_tree.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <utility>

namespace sightline::hierarchy {
namespace {

constexpr std::uint32_t kStepsOfNode = 2;  // that tightening takes
constexpr std::uint32_t kStepsOfItem = 5;  // that building takes, for each item
constexpr double kWorn = 4.0;              // times the surface area that a node had when it was built

Box united(const Box& a, const Box& b) {
  Box box = a;
  box.extend(b);
  return box;
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
  insertOne(item);
  ++scattered_;
  noteChange(item.number);
}

void DynamicTree::insertOne(const Item& item) {
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
  scratch_.clear();
  if (root_ != kNone) {
    collect(root_);
  }
  build(std::vector<Item>(std::move(scratch_)));
}

void DynamicTree::insert(std::span<const Item> items) {
  constexpr std::size_t kMany = 8;  // building takes about so many times less for an item than inserting it
  if (items.size() * kMany < size_) {
    for (const Item& item : items) {
      insert(item);
    }
    return;
  }
  scratch_.clear();
  if (root_ != kNone) {
    collect(root_);
  }
  scratch_.insert(scratch_.end(), items.begin(), items.end());
  build(std::vector<Item>(std::move(scratch_)));
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
    std::sort(all.begin(), all.end(), AlongAxis{axis});
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
  removeOne(number);
  noteChange(number);
}

void DynamicTree::removeOne(std::uint32_t number) {
  assert(has(number));
  const std::uint32_t place = places_[number];
  places_[number] = kNone;
  --size_;
  measured_.changed = true;
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

void DynamicTree::move(const Item& item) {
  moveOne(item);
  noteChange(item.number);
}

// What leaves its node altogether is put where it belongs, unless it is alone there.
void DynamicTree::moveOne(const Item& item) {
  assert(has(item.number) && item.box.wellFormed());
  measured_.changed = true;
  const std::uint32_t place = places_[item.number], node = place / kChildren;
  const std::uint32_t parent = nodes_[node].parent;
  if (parent != kNone && !overlaps(boxes_[parent], item.box)) {
    removeOne(item.number);
    insertOne(item);
    return;
  }
  boxes_[place] = item.box;
  grow(node, item.box);
  loosen(node);
}

void DynamicTree::move(std::span<const Item> items) {
  constexpr std::size_t kMany = 4;
  const bool many = items.size() * kMany > size_;
  leaving_.clear();
  for (const Item& item : items) {
    if (item.number == kNone) {
      continue;
    }
    if (!many) {
      move(item);
      continue;
    }
    assert(has(item.number) && item.box.wellFormed());
    const std::uint32_t place = places_[item.number];
    const std::uint32_t parent = nodes_[place / kChildren].parent;
    if (parent != kNone && !overlaps(boxes_[parent], item.box)) {
      leaving_.push_back(item);
    } else {
      boxes_[place] = item.box;
      noteChange(item.number);
    }
  }
  if (many && root_ != kNone) {
    measured_.changed = true;
    refit(root_);
  }
  for (const Item& item : leaving_) {
    move(item);
  }
}

// Makes the boxes of all nodes below a node anew, and returns its own.
Box DynamicTree::refit(std::uint32_t node) {
  const NodeData& data = nodes_[node];
  Box bounds;
  for (std::uint32_t place = node * kChildren; place < node * kChildren + data.count; ++place) {
    if (data.height > 0) {
      boxes_[place] = refit(children_[place]);
    }
    bounds.extend(boxes_[place]);
  }
  if (data.parent != kNone && surfaceArea(bounds) > kWorn * data.built_area) {
    wear(data.parent / kChildren);
  }
  return bounds;
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

void DynamicTree::spend(std::uint32_t& steps, std::uint32_t spent) {
  steps -= std::min(steps, spent);
  steps_taken_ += spent;
}

// However many nodes wait, each kind of work gets its part of the steps. Otherwise a crowd that moves in
// every call would keep the nodes above the leaves from shrinking, and the other tree from being built.
std::uint32_t DynamicTree::tidy(std::uint32_t steps) {
  const std::uint32_t kept = steps / 4;
  steps -= kept;
  for (std::vector<std::uint32_t>& list : loose_) {
    std::uint32_t share = steps - steps / 2;
    steps -= share;
    const bool has_time_for_all = list.size() * kStepsOfNode <= share;
    while (!list.empty() && share > 0) {
      if (!has_time_for_all) {  // in turn, so that none waits for ever where many come in every call
        std::swap(list[next_loose_++ % list.size()], list.back());
      }
      const std::uint32_t node = list.back();
      list.pop_back();
      nodes_[node].loose = false;
      tighten(node);
      spend(share, kStepsOfNode);
    }
    steps += share;
  }
  while (!worn_.empty() && steps > 0) {
    const std::uint32_t node = worn_.back();
    worn_.pop_back();
    nodes_[node].worn = false;
    // Where it has no children or no grandchildren, it is gone, or is another node by now.
    if (nodes_[node].count > 0 && nodes_[node].height > 0) {
      spend(steps, divideAnew(node));
    }
  }
  steps += kept;
  proceedReplacement(steps);
  measureSome(steps);
  return steps;
}

// Goes on to measure nodes. After the last one, it is known whether the tree has worn.
void DynamicTree::measureSome(std::uint32_t& steps) {
  constexpr std::uint32_t kNodes = 128, kNodesInStep = 8;
  constexpr double kTooMuch = 1.5;
  if (steps == 0 || (measured_.next_node == 0 && !measured_.changed)) {
    return;
  }
  if (measured_.next_node == 0) {
    measured_.changed = false;
    measured_.area = 0.0;
  }
  const auto end =
      static_cast<std::uint32_t>(std::min<std::size_t>(measured_.next_node + kNodes, nodes_.size()));
  for (; measured_.next_node < end; ++measured_.next_node) {
    const std::uint32_t parent = nodes_[measured_.next_node].parent;
    measured_.area += parent != kNone ? surfaceArea(boxes_[parent]) : 0.0;
  }
  spend(steps, kNodes / kNodesInStep);
  if (measured_.next_node == nodes_.size()) {
    measured_.next_node = 0;
    const double for_item = size_ > 0 ? measured_.area / static_cast<double>(size_) : 0.0;
    measured_.worn = measured_.first > 0.0 && for_item > kTooMuch * measured_.first;
    measured_.first = measured_.first > 0.0 ? measured_.first : for_item;
  }
}

// Appends the items below a node to scratch_, and frees the node and all nodes below it.
void DynamicTree::collect(std::uint32_t number) {
  const Node children = node(number);
  for (std::size_t i = 0; i < children.boxes.size(); ++i) {
    if (children.leaf) {
      scratch_.push_back({children.children[i], children.boxes[i]});
    } else {
      collect(children.children[i]);
    }
  }
  freeNode(number);
}

// Divides the grandchildren of a node among new children. These are at most 256, however much is below them,
// so a worn part of any size is made good level by level. Returns how many steps that took.
std::uint32_t DynamicTree::divideAnew(std::uint32_t number) {
  scratch_.clear();
  for (const std::uint32_t child : node(number).children) {
    const Node grandchildren = node(child);
    for (std::size_t i = 0; i < grandchildren.boxes.size(); ++i) {
      scratch_.push_back({grandchildren.children[i], grandchildren.boxes[i]});
    }
    freeNode(child);
  }
  nodes_[number].count = 0;
  // The node itself goes on to be compared with what it was when the division of its parent made it.
  const double built_area = nodes_[number].built_area;
  const std::uint64_t taken = steps_taken_;
  const std::uint32_t bottom = nodes_[number].height - 1u;
  open(number, 0, scratch_.size(), bottom);
  std::uint32_t all = kNone;
  fill(all, bottom);
  steps_taken_ = taken;  // the caller counts all of it
  NodeData& divided = nodes_[number];
  divided.built_area = built_area;
  if (divided.parent != kNone) {
    loosen(divided.parent / kChildren);
    if (divided.count < kFew) {
      wear(divided.parent / kChildren);
    }
  }
  return kStepsOfItem * static_cast<std::uint32_t>(scratch_.size());
}

// Leaves room in each leaf for items to come.
std::uint32_t DynamicTree::heightFor(std::size_t items) const {
  std::uint32_t height = 0;
  for (std::size_t room = kChildren * 3 / 4; room < items; room *= kChildren) {
    ++height;
  }
  return height;
}

// Says that this part of scratch_ is to be divided among the children of an empty node, by medians. bottom:
// the height of those nodes whose children are in scratch_.
void DynamicTree::open(std::uint32_t node, std::size_t first, std::size_t count, std::uint32_t bottom) {
  shares_.push_back({node, 0, 0, 0});
  const std::uint32_t height = nodes_[node].height;
  if (height == bottom) {
    nodes_[node].count = static_cast<std::uint8_t>(count);
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t place = node * kChildren + i;
      children_[place] = scratch_[first + i].number;
      boxes_[place] = scratch_[first + i].box;
      setPlace(place, bottom == 0);
    }
    return;
  }
  std::size_t room = kChildren * 3 / 4;
  for (std::uint32_t h = bottom + 1; h < height; ++h) {
    room *= kChildren;
  }
  // Even shares, so that the divisions are in the middle.
  shares_.push_back({node, first, count, std::clamp<std::size_t>((count + room - 1) / room, 1, kChildren)});
}

// Fills all nodes that are open, as far as the steps go. Returns whether that is done. bottom: as in open().
bool DynamicTree::fill(std::uint32_t& steps, std::uint32_t bottom) {
  while (!shares_.empty() && steps > 0) {
    const Share share = shares_.back();
    if (share.children > 1) {
      const std::size_t left = share.children / 2, count = share.count * left / share.children;
      if (!dividing_) {
        division_.begin(share.first, share.count, count);
      }
      const std::uint32_t before = steps;
      dividing_ = !division_.proceed(scratch_, steps);
      steps_taken_ += before - steps;
      if (!dividing_) {
        shares_.back() = {share.node, share.first + count, share.count - count, share.children - left};
        shares_.push_back({share.node, share.first, count, left});
      }
      continue;
    }
    shares_.pop_back();
    NodeData& data = nodes_[share.node];
    if (share.children == 0) {
      const Box bounds = boundsOf(share.node);
      data.built_area = surfaceArea(bounds);
      if (data.parent != kNone) {
        boxes_[data.parent] = bounds;
      }
      spend(steps, data.height == bottom ? kStepsOfItem * data.count : 1);
    } else if (share.count > 0) {
      const std::uint32_t place = share.node * kChildren + data.count++;
      const std::uint32_t child = newNode(data.height - 1u);
      children_[place] = child;
      setPlace(place, false);
      open(child, share.first, share.count, bottom);
    }
  }
  return shares_.empty();
}

void DynamicTree::build(std::span<const Item> items) {
  clear();
  endReplacement();
  if (items.empty()) {
    return;
  }
  std::uint32_t bound = 0;
  for (const Item& item : items) {
    assert(item.box.wellFormed());
    bound = std::max(bound, item.number + 1);
  }
  places_.assign(bound, kNone);
  scratch_.assign(items.begin(), items.end());
  size_ = items.size();
  root_ = newNode(heightFor(items.size()));
  open(root_, 0, items.size(), 0);
  std::uint32_t all = kNone;
  while (!fill(all, 0)) {
    all = kNone;
  }
  scratch_.clear();
  steps_taken_ = 0;
}

void DynamicTree::reserve(std::size_t items) {
  const std::size_t nodes = items / kFew;  // leaves are mostly fuller, which leaves room for the nodes above
  nodes_.reserve(nodes);
  boxes_.reserve(nodes * kChildren);
  children_.reserve(nodes * kChildren);
  places_.reserve(items);
}

}  // namespace sightline::hierarchy
