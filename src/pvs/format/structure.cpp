#include "src/pvs/format/structure.h"

#include <cmath>
#include <string>
#include <vector>

namespace sightline::pvs {
namespace {

Error inNode(const char* what, std::size_t node) {
  return Error{std::string(what) + " (node " + std::to_string(node) + ")"};
}

Status checkObjects(std::span<const ObjectId> objects) {
  std::vector<bool> seen(objects.size());
  for (const ObjectId object : objects) {
    if (object.value >= objects.size() || seen[object.value]) {
      return Error{"the hierarchy does not hold each object once (object " + std::to_string(object.value) +
                   ")"};
    }
    seen[object.value] = true;
  }
  return Success{};
}

// An inner node whose children are being read.
struct OpenNode {
  std::uint32_t node;
  std::uint32_t next_object;  // the first object of its next child

  std::uint64_t objectEnd(std::span<const BoxNode> nodes) const {
    return std::uint64_t{nodes[node].first_object} + nodes[node].object_count;
  }
};

Status checkChild(std::span<const BoxNode> nodes, std::uint32_t child, OpenNode& parent) {
  const BoxNode& node = nodes[child];
  const BoxNode& above = nodes[parent.node];
  if (node.end <= child || node.end > above.end) {
    return inNode("subtrees of the hierarchy do not nest", child);
  }
  // The comparisons also fail for NaN.
  if (node.bounds.empty() || !contains(above.bounds, node.bounds)) {
    return inNode("a box of the hierarchy does not lie in that of its parent", child);
  }
  if (node.object_count == 0 || node.first_object != parent.next_object ||
      std::uint64_t{node.first_object} + node.object_count > parent.objectEnd(nodes)) {
    return inNode("the objects of the hierarchy's nodes do not follow each other", child);
  }
  parent.next_object += node.object_count;
  return Success{};
}

Status checkPlane(const CellPlane& plane) {
  const double square = dot(plane.normal, plane.normal);
  const bool sound = std::abs(square - 1.0) <= 1e-4 && std::isfinite(plane.front) &&
                     std::isfinite(plane.back) && plane.back <= plane.front;
  return sound ? Status(Success{}) : Status(Error{"a plane of the octree is not sound"});
}

Status checkRootBox(const Vec3d& min, const Vec3d& max) {
  for (int axis = 0; axis < 3; ++axis) {
    if (!(min[axis] < max[axis]) || !std::isfinite(min[axis]) || !std::isfinite(max[axis]) ||
        !std::isfinite(max[axis] - min[axis])) {
      return Error{"the octree's box is empty or not finite"};
    }
  }
  return Success{};
}

Status checkLeaf(const OctreeView& octree, const OctreeLeaf& leaf, std::uint64_t set_count) {
  const bool has_plane = leaf.plane != OctreeLeaf::kNoPlane;
  if (leaf.set >= set_count || (has_plane && (leaf.front_set >= set_count || leaf.back_set >= set_count))) {
    return Error{"a cell of the octree names a set that is not there"};
  }
  if (has_plane && leaf.plane >= octree.planes.size()) {
    return Error{"a cell of the octree names a plane that is not there"};
  }
  return Success{};
}

Status checkViewers(const OctreeView& octree) {
  if (!octree.viewers.empty() && octree.viewers.size() != octree.leaves.size()) {
    return Error{"the octree does not say of each cell where its viewers are"};
  }
  for (const ViewerBounds& viewers : octree.viewers) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (viewers.first[axis] > viewers.last[axis]) {
        return Error{"a cell of the octree has its viewers in no part of it"};
      }
    }
  }
  return Success{};
}

// Checks that each leaf and each node except the root has exactly one parent, and that the depths are right.
Status checkLinks(const OctreeView& octree) {
  constexpr std::uint8_t kNone = 0xff;
  std::vector<std::uint8_t> depth(octree.nodes.size(), kNone);
  std::vector<bool> named(octree.leaves.size());
  std::size_t leaf_count = 0;
  depth[0] = 0;
  for (std::size_t i = 0; i < octree.nodes.size(); ++i) {
    const OctreeLink link = octree.nodes[i];
    if (depth[i] == kNone) {
      return inNode("a node of the octree has no parent before it", i);
    }
    if ((link & kOctreeLeaf) != 0) {
      const std::uint32_t leaf = link & ~kOctreeLeaf;
      if (leaf >= octree.leaves.size() || named[leaf] || octree.depths[leaf] != depth[i]) {
        return inNode("a cell of the octree is not there, there twice, or not as deep as it says", i);
      }
      named[leaf] = true;
      ++leaf_count;
      continue;
    }
    if (link <= i || std::uint64_t{link} + 8 > octree.nodes.size() || depth[i] >= kMaxOctreeDepth) {
      return inNode("children of the octree are not there, or too deep", i);
    }
    for (std::size_t child = link; child < std::size_t{link} + 8; ++child) {
      if (depth[child] != kNone) {
        return inNode("a node of the octree has two parents", child);
      }
      depth[child] = static_cast<std::uint8_t>(depth[i] + 1);
    }
  }
  return leaf_count == octree.leaves.size() ? Status(Success{})
                                            : Status(Error{"a cell of the octree is in no node"});
}

}  // namespace

Status checkBoxTree(const BoxTreeView& tree) {
  const std::span<const BoxNode> nodes = tree.nodes;
  if (nodes.empty() || nodes.size() > 0x7fffffffu) {
    return Error{"the hierarchy has no node, or too many"};
  }
  if (nodes[0].bounds.empty() || nodes[0].end != nodes.size() || nodes[0].first_object != 0 ||
      nodes[0].object_count != tree.objects.size() || tree.objects.empty()) {
    return Error{"the root of the hierarchy does not hold all of it"};
  }
  std::vector<OpenNode> open;
  if (nodes.size() > 1) {
    open.push_back({0, 0});
  }
  for (std::uint32_t i = 1; i <= nodes.size(); ++i) {
    while (!open.empty() && nodes[open.back().node].end == i) {
      if (open.back().next_object != open.back().objectEnd(nodes)) {
        return inNode("the objects of the hierarchy's nodes do not follow each other", open.back().node);
      }
      open.pop_back();
    }
    if (i == nodes.size()) {
      break;
    }
    if (const Status child = checkChild(nodes, i, open.back()); !child) {
      return child;
    }
    if (nodes[i].end > i + 1) {
      open.push_back({i, nodes[i].first_object});
    }
  }
  return checkObjects(tree.objects);
}

Status checkOctree(const OctreeView& octree, std::uint64_t set_count) {
  if (octree.nodes.empty() || octree.depths.size() != octree.leaves.size() ||
      octree.reasons.size() != octree.leaves.size()) {
    return Error{"the octree has no node, or its parts are not of one length"};
  }
  if (Status box = checkRootBox(octree.min, octree.max); !box) {
    return box;
  }
  for (const CellPlane& plane : octree.planes) {
    if (Status sound = checkPlane(plane); !sound) {
      return sound;
    }
  }
  for (const OctreeLeaf& leaf : octree.leaves) {
    if (Status sound = checkLeaf(octree, leaf, set_count); !sound) {
      return sound;
    }
  }
  for (const std::uint8_t reason : octree.reasons) {
    if (reason >= kStopReasons) {
      return Error{"a cell of the octree ends for an unknown reason"};
    }
  }
  if (Status viewers = checkViewers(octree); !viewers) {
    return viewers;
  }
  return checkLinks(octree);
}

}  // namespace sightline::pvs
