#pragma once

#include <cstdint>
#include <vector>

#include "sightline/comparison/kept_planes.h"
#include "sightline/hierarchy/hierarchy.h"

#include "src/culling/hierarchical_traversal.h"

namespace sightline::comparison {

// Kept planes as the traversal asks them: the relations of what lies below a node are dropped when the
// traversal ends at it. They stay while the node is merely outside the frustum.
struct KeptPlanesTraversal {
  KeptPlanes& planes;
  const Hierarchy& hierarchy;
  std::vector<bool>&
      entered;                // by node: the traversal went on below it, and what is there may have relations
  std::uint64_t& node_pairs;  // increased by the pairs of an occluder and a node that are compared

  OccluderList start() const { return planes.all(); }
  Visibility classify(const culling::TraversalBox& asked, OccluderList among, OccluderList& touching) {
    const std::uint32_t before = planes.compared();
    const Visibility state = planes.classify(asked.box, asked.item, among, touching);
    if (asked.item < entered.size()) {
      node_pairs += planes.compared() - before;
      entered[asked.item] = entered[asked.item] || state == Visibility::kPartial;
    }
    return state;
  }
  void settled(NodeIndex node) {
    if (!entered[node.value]) {
      return;
    }
    entered[node.value] = false;
    const HierarchyNode& n = hierarchy.nodes[node.value];
    if (n.leaf()) {
      const std::size_t entries = hierarchy.objectsBelow(node).size();
      for (std::uint32_t i = 0; i < entries; ++i) {
        planes.forget(static_cast<std::uint32_t>(hierarchy.nodes.size()) + n.link + i);
      }
    } else {
      for (const NodeIndex child : {hierarchy.left(node), hierarchy.right(node)}) {
        planes.forget(child.value);
        settled(child);
      }
    }
  }
};

}  // namespace sightline::comparison
