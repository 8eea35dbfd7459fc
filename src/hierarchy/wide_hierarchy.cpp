// Based on: Wald, Benthin, Boulos. Getting Rid of Packets: Efficient SIMD Single-Ray Traversal using
// Multi-branching BVHs. Symposium on Interactive Ray Tracing 2008.
// Differs from the paper in: children are opened by surface area alone, and objects are children too.

#include "src/hierarchy/wide_hierarchy.h"

#include <algorithm>

namespace sightline::hierarchy {
namespace {

class Collapser {
 public:
  Collapser(const Hierarchy& hierarchy, std::span<const Box> object_bounds)
      : hierarchy_(hierarchy), object_bounds_(object_bounds) {}

  WideHierarchy run() {
    if (!hierarchy_.nodes.empty()) {
      append(0);
    }
    // Nodes are appended while the list is gone through: children follow each other.
    for (std::uint32_t node = 0; node < wide_.nodes.size(); ++node) {
      fill(node);
    }
    wide_.nodes.shrink_to_fit();
    wide_.boxes.shrink_to_fit();
    wide_.object.shrink_to_fit();
    return std::move(wide_);
  }

 private:
  std::size_t objectsBelow(std::uint32_t node) const {
    return hierarchy_.objectsBelow(NodeIndex(node)).size();
  }

  void append(std::uint32_t source) {
    const std::span<const ObjectId> below = hierarchy_.objectsBelow(NodeIndex(source));
    WideNode node;
    node.first_object = static_cast<std::uint32_t>(below.data() - hierarchy_.objects.data());
    node.object_end = node.first_object + static_cast<std::uint32_t>(below.size());
    node.cost = hierarchy_.nodes[source].cost;
    wide_.nodes.push_back(node);
    sources_.push_back(source);
  }

  void fill(std::uint32_t wide) {
    children_.clear();
    opened_.clear();
    const std::uint32_t source = sources_[wide];
    if (hierarchy_.nodes[source].leaf() || objectsBelow(source) <= kWideChildren) {
      opened_.push_back(source);
    } else {
      children_ = {source + 1, hierarchy_.right(NodeIndex(source)).value};
      openLarge();
      openSmall();
    }
    std::stable_sort(children_.begin(), children_.end(), [this](std::uint32_t a, std::uint32_t b) {
      return hierarchy_.nodes[a].cost > hierarchy_.nodes[b].cost;
    });
    write(wide);
  }

  // The node with the largest surface among those that may be opened, or the end.
  template <typename May>
  std::vector<std::uint32_t>::iterator largest(May may) {
    auto best = children_.end();
    double best_area = -1.0;
    for (auto i = children_.begin(); i != children_.end(); ++i) {
      const double area = surfaceArea(hierarchy_.nodes[*i].bounds);
      if (may(*i) && (best == children_.end() || area > best_area)) {
        best = i;
        best_area = area;
      }
    }
    return best;
  }

  void openLarge() {
    while (children_.size() < kWideChildren) {
      const auto node = largest(
          [this](std::uint32_t n) { return !hierarchy_.nodes[n].leaf() && objectsBelow(n) > kWideChildren; });
      if (node == children_.end()) {
        return;
      }
      const std::uint32_t right = hierarchy_.right(NodeIndex(*node)).value;
      *node += 1;
      children_.push_back(right);
    }
  }

  // Subtrees of few objects give their place to these.
  void openSmall() {
    std::size_t objects = 0;
    for (;;) {
      const auto node = largest(
          [&](std::uint32_t n) { return children_.size() - 1 + objects + objectsBelow(n) <= kWideChildren; });
      if (node == children_.end()) {
        return;
      }
      objects += objectsBelow(*node);
      opened_.push_back(*node);
      children_.erase(node);
    }
  }

  void write(std::uint32_t wide) {
    const auto first_child = static_cast<std::uint32_t>(wide_.boxes.size());
    const auto first_node = static_cast<std::uint32_t>(wide_.nodes.size());
    for (const std::uint32_t child : children_) {
      addChild(hierarchy_.nodes[child].bounds, ObjectId());
      append(child);
    }
    for (const std::uint32_t source : opened_) {
      for (const ObjectId object : hierarchy_.objectsBelow(NodeIndex(source))) {
        addChild(object_bounds_[object.value], object);
      }
    }
    WideNode& node = wide_.nodes[wide];
    node.first_child = first_child;
    node.child_end = static_cast<std::uint32_t>(wide_.boxes.size());
    node.first_node = first_node;
    node.node_count = static_cast<std::uint32_t>(children_.size());
  }

  void addChild(const Box& box, ObjectId object) {
    wide_.boxes.push_back(box);
    wide_.object.push_back(object);
  }

  const Hierarchy& hierarchy_;
  std::span<const Box> object_bounds_;
  WideHierarchy wide_;
  std::vector<std::uint32_t> sources_;            // nodes of the binary hierarchy, by wide node
  std::vector<std::uint32_t> children_, opened_;  // of one wide node: to be nodes; whose objects are children
};

}  // namespace

WideHierarchy collapse(const Hierarchy& hierarchy, std::span<const Box> object_bounds) {
  return Collapser(hierarchy, object_bounds).run();
}

}  // namespace sightline::hierarchy
