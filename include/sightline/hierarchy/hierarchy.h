#pragma once

// A binary hierarchy over objects in one flat layout, shared by the kd-tree and the bounding-volume
// hierarchy.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sightline/base/ids.h"
#include "sightline/base/large_vector.h"
#include "sightline/base/parallel_for.h"
#include "sightline/base/result.h"
#include "sightline/math/box.h"

namespace sightline {

// Nodes are in depth-first order: the left child follows its parent. 32 bytes.
struct HierarchyNode {
  Box bounds{};  // encloses the parts of its objects that are in its region
  // Leaf: index of its first entry in Hierarchy::objects; Hierarchy::objectsBelow() finds the end. Inner
  // node: one past the last node below it.
  std::uint32_t link = 0;
  std::uint32_t cost : 31 = 0;  // triangles below, at most kMaxCost
  std::uint32_t is_leaf : 1 = 0;

  static constexpr std::uint32_t kMaxCost = 0x7fffffff;
  bool leaf() const { return is_leaf != 0; }
};
static_assert(sizeof(HierarchyNode) == 32);

enum class HierarchyKind : std::uint8_t { kKdTree, kBvh };

struct Hierarchy {
  HierarchyKind kind = HierarchyKind::kBvh;
  std::vector<HierarchyNode> nodes{};  // [0] is the root; empty if there are no objects
  // The objects of the leaves, leaf after leaf. A kd-tree may list an object several times.
  std::vector<ObjectId> objects{};
  std::uint32_t object_count = 0;  // number of distinct objects
  std::uint32_t depth = 0;         // number of levels

  NodeIndex left(NodeIndex n) const { return NodeIndex(n.value + 1); }
  NodeIndex right(NodeIndex n) const { return NodeIndex(end(left(n))); }
  // One past the last node of the subtree of n.
  std::uint32_t end(NodeIndex n) const {
    const HierarchyNode& node = nodes[n.value];
    return node.leaf() ? n.value + 1 : node.link;
  }
  // The entries of `objects` below n: one contiguous range, never empty. A leaf ends where the next leaf
  // begins, so this visits the few inner nodes between them.
  std::span<const ObjectId> objectsBelow(NodeIndex n) const;
  std::uint32_t duplicates() const { return static_cast<std::uint32_t>(objects.size()) - object_count; }
};

struct HierarchySettings {
  HierarchyKind kind = HierarchyKind::kBvh;
  std::uint32_t max_leaf_objects = 2;  // split until a node has at most this many ...
  std::uint32_t max_depth = 0;  // ... or the tree this many levels; 0: chosen from the number of objects
  // kd-tree: split planes are searched within this fraction of the extent around the spatial median.
  double median_window = 0.25;
};

// Builds either kind. Objects with an empty or non-finite box are in leaves with an infinite box, which no
// test calls hidden or outside. object_cost: triangles of each object, one per box, or empty for 1 each.
// kd-tree: Bittner et al. 1998, section 2.2; it also stops where a split would only duplicate objects.
// Bounding-volume hierarchy: binned surface-area heuristic (Wald 2007), with each object in one leaf.
Hierarchy buildHierarchy(std::span<const Box> object_bounds, std::span<const std::uint32_t> object_cost,
                         const HierarchySettings& settings = {});

// The hierarchy as bytes, to be read again instead of built: on a machine of the same kind, by a program of
// the same version. They say neither of which objects nor with which settings it was built.
LargeVector<std::byte> hierarchyBytes(const Hierarchy& hierarchy);
// Error if they are cut off, of another version, no tree, of more than 256 levels, or do not have all of so
// many objects. Whether they are those that were written, of these boxes, is for the caller to check, by a
// checksum: a hierarchy of other boxes hides what is visible.
Result<Hierarchy> hierarchyFrom(std::span<const std::byte> bytes, std::uint32_t object_count);

}  // namespace sightline
