#include "sightline/hierarchy/hierarchy.h"

#include <algorithm>
#include <bit>

#include "src/hierarchy/builder.h"
#include "src/math/infinite_box.h"

namespace sightline {
namespace hierarchy {

HierarchyNode FlatWriter::enclosing(std::span<const Item> items) const {
  HierarchyNode node;
  std::uint64_t cost = 0;
  for (const Item& item : items) {
    if (item.box.wellFormed()) {
      node.bounds.extend(item.box);
    } else {
      node.bounds = math::infiniteBox();
    }
    cost += object_cost_.empty() ? 1u : object_cost_[item.object.value];
  }
  node.cost = std::min<std::uint64_t>(cost, HierarchyNode::kMaxCost) & HierarchyNode::kMaxCost;
  return node;
}

void FlatWriter::leaf(std::span<const Item> items, std::uint32_t level) {
  HierarchyNode node = enclosing(items);
  node.link = static_cast<std::uint32_t>(hierarchy_.objects.size());
  node.is_leaf = 1;
  for (const Item& item : items) {
    hierarchy_.objects.push_back(item.object);
  }
  hierarchy_.nodes.push_back(node);
  hierarchy_.depth = std::max(hierarchy_.depth, level + 1);
}

NodeIndex FlatWriter::beginInner(std::span<const Item> items, std::uint32_t level) {
  hierarchy_.nodes.push_back(enclosing(items));
  hierarchy_.depth = std::max(hierarchy_.depth, level + 1);
  return NodeIndex(hierarchy_.nodes.size() - 1);
}

void FlatWriter::finish(NodeIndex inner) {
  hierarchy_.nodes[inner.value].link = static_cast<std::uint32_t>(hierarchy_.nodes.size());
}

}  // namespace hierarchy

std::span<const ObjectId> Hierarchy::objectsBelow(NodeIndex n) const {
  const auto firstObject = [this](std::uint32_t node) {
    while (!nodes[node].leaf()) {
      ++node;
    }
    return nodes[node].link;
  };
  const std::uint32_t first = firstObject(n.value);
  const std::uint32_t after = end(n);
  const std::uint32_t last =
      after < nodes.size() ? firstObject(after) : static_cast<std::uint32_t>(objects.size());
  return std::span(objects).subspan(first, last - first);
}

Hierarchy buildHierarchy(std::span<const Box> object_bounds, std::span<const std::uint32_t> object_cost,
                         const HierarchySettings& settings) {
  using namespace hierarchy;
  Hierarchy hierarchy;
  hierarchy.kind = settings.kind;
  hierarchy.object_count = static_cast<std::uint32_t>(object_bounds.size());

  std::vector<Item> good, bad;
  for (std::size_t i = 0; i < object_bounds.size(); ++i) {
    (object_bounds[i].wellFormed() ? good : bad).push_back({object_bounds[i], ObjectId(i)});
  }
  const auto levels = static_cast<std::uint32_t>(std::bit_width(good.size()));
  const bool kd = settings.kind == HierarchyKind::kKdTree;
  BuildLimits limits;
  limits.max_leaf_objects = std::max(settings.max_leaf_objects, 1u);
  limits.max_depth = settings.max_depth != 0 ? settings.max_depth : kd ? levels + 6 : 2 * levels + 16;
  limits.median_window = settings.median_window;

  FlatWriter writer(hierarchy, object_cost);
  const auto buildGood = [&](std::uint32_t level) {
    if (kd) {
      buildKdTree(writer, std::move(good), limits, level);
    } else {
      buildBvh(writer, good, limits, level);
    }
  };
  if (bad.empty()) {
    if (!good.empty()) {
      buildGood(0);
    }
  } else if (good.empty()) {
    writer.leaf(bad, 0);
  } else {
    std::vector<Item> all = good;
    all.insert(all.end(), bad.begin(), bad.end());
    const NodeIndex root = writer.beginInner(all, 0);
    buildGood(1);
    writer.leaf(bad, 1);
    writer.finish(root);
  }
  return hierarchy;
}

}  // namespace sightline
