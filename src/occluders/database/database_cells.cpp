#include "src/occluders/database/database_cells.h"

#include <algorithm>
#include <limits>
#include <queue>

namespace sightline::occluders {
namespace {

// A cell that may still be split.
struct OpenCell {
  double squared_diagonal = 0.0;
  std::uint32_t cell = 0;  // index of its CellNode
  NodeIndex node;          // of the kd-tree
  Box region;

  friend bool operator<(const OpenCell& a, const OpenCell& b) {
    return a.squared_diagonal < b.squared_diagonal ||
           (a.squared_diagonal == b.squared_diagonal && a.cell > b.cell);
  }
};

struct Split {
  int axis = -1;
  float plane = 0.0f;
  bool found() const { return axis >= 0; }
};

// Objects with a broken box lie in leaves of their own with an infinite box, which say nothing of where they
// are: such a child is passed over.
NodeIndex withoutBrokenBoxes(const Hierarchy& tree, NodeIndex n) {
  while (!tree.nodes[n.value].leaf()) {
    if (!tree.nodes[tree.right(n).value].bounds.wellFormed()) {
      n = tree.left(n);
    } else if (!tree.nodes[tree.left(n).value].bounds.wellFormed()) {
      n = tree.right(n);
    } else {
      break;
    }
  }
  return n;
}

// The builder cuts boxes at its plane, so that left.max <= plane <= right.min on its axis. Of all such axes
// the one with the widest gap; the plane in its middle.
Split splitOf(const Hierarchy& tree, NodeIndex n) {
  Split split;
  if (tree.nodes[n.value].leaf()) {
    return split;
  }
  const Box& left = tree.nodes[tree.left(n).value].bounds;
  const Box& right = tree.nodes[tree.right(n).value].bounds;
  double widest = -1.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = left.max[axis], high = right.min[axis];
    if (high - low >= 0.0 && high - low > widest) {
      widest = high - low;
      split = {axis, static_cast<float>(0.5 * (low + high))};
    }
  }
  return split;
}

// Splits the region at the first node below n that really divides it; moves n there. Where all of one child
// is flat in the region's border, the other child has the whole region.
Split splitRegion(const Hierarchy& tree, const Box& region, NodeIndex& n) {
  for (;;) {
    n = withoutBrokenBoxes(tree, n);
    const Split split = splitOf(tree, n);
    if (split.found() && split.plane <= region.min[split.axis]) {
      n = tree.right(n);
    } else if (split.found() && split.plane >= region.max[split.axis]) {
      n = tree.left(n);
    } else {
      return split;
    }
  }
}

double squaredDiagonal(const Box& box) {
  const Vec3d extent = Vec3d(box.max) - Vec3d(box.min);
  return dot(extent, extent);
}

// By 1/256 of its diagonal on every side: so that a flat scene has cells with a volume, and viewpoints just
// outside are in the region of theirs.
Box enlarged(const Box& box) {
  constexpr double kLargest = std::numeric_limits<float>::max();
  const double by = std::sqrt(squaredDiagonal(box)) / 256.0;
  Box result;
  for (int axis = 0; axis < 3; ++axis) {
    result.min[axis] = static_cast<float>(std::max(box.min[axis] - by, -kLargest));
    result.max[axis] = static_cast<float>(std::min(box.max[axis] + by, kLargest));
  }
  return result;
}

Box regionOfAll(const Hierarchy& tree, const Box& default_bounds) {
  if (!tree.nodes.empty()) {
    const Box& bounds = tree.nodes[withoutBrokenBoxes(tree, NodeIndex(0u)).value].bounds;
    if (bounds.wellFormed()) {
      return enlarged(bounds);
    }
  }
  return default_bounds.wellFormed() ? enlarged(default_bounds) : Box{{0, 0, 0}, {0, 0, 0}};
}

}  // namespace

std::uint32_t CellTree::cellOf(const Vec3d& point) const {
  const CellNode* node = nodes.data();
  while (node->axis != CellNode::kCell) {
    const bool left = point[static_cast<int>(node->axis)] < node->plane;
    node = &nodes[node->link + (left ? 0u : 1u)];
  }
  return node->link;
}

std::size_t CellTree::bytes() const {
  return nodes.capacity() * sizeof(CellNode) + regions.capacity() * sizeof(Box);
}

CellTree buildCells(const Hierarchy& kd_tree, const Box& default_bounds, std::uint32_t max_cells) {
  CellTree cells;
  std::vector<Box> region_of_node{regionOfAll(kd_tree, default_bounds)};
  cells.nodes.emplace_back();
  std::priority_queue<OpenCell> open;
  if (kd_tree.kind == HierarchyKind::kKdTree && !kd_tree.nodes.empty()) {
    open.push({squaredDiagonal(region_of_node[0]), 0, NodeIndex(0u), region_of_node[0]});
  }
  for (std::uint32_t count = 1; count < max_cells && !open.empty();) {
    OpenCell cell = open.top();
    open.pop();
    const Split split = splitRegion(kd_tree, cell.region, cell.node);
    if (!split.found()) {
      continue;
    }
    const auto first_child = static_cast<std::uint32_t>(cells.nodes.size());
    cells.nodes[cell.cell] = {split.plane, static_cast<std::uint32_t>(split.axis), first_child};
    Box left = cell.region, right = cell.region;
    left.max[split.axis] = right.min[split.axis] = split.plane;
    open.push({squaredDiagonal(left), first_child, kd_tree.left(cell.node), left});
    open.push({squaredDiagonal(right), first_child + 1, kd_tree.right(cell.node), right});
    for (const Box& region : {left, right}) {
      cells.nodes.emplace_back();
      region_of_node.push_back(region);
    }
    ++count;
  }
  for (std::size_t i = 0; i < cells.nodes.size(); ++i) {
    if (cells.nodes[i].axis == CellNode::kCell) {
      cells.nodes[i].link = cells.count();
      cells.regions.push_back(region_of_node[i]);
    }
  }
  cells.nodes.shrink_to_fit();
  cells.regions.shrink_to_fit();
  return cells;
}

void CellTree::save(base::ByteWriter& writer) const {
  Box all;
  for (const Box& region : regions) {
    all.extend(region);
  }
  for (const Vec3f& corner : {all.min, all.max}) {
    for (int axis = 0; axis < 3; ++axis) {
      writer.add(corner[axis]);
    }
  }
  for (const CellNode& node : nodes) {
    writer.add(static_cast<std::uint8_t>(node.axis));
    if (node.axis != CellNode::kCell) {
      writer.add(node.plane);
      writer.add(node.link);
    }
  }
}

Result<CellTree> CellTree::load(base::ByteReader& reader, std::uint32_t cells) {
  const std::uint32_t count = 2 * cells - 1;
  CellTree tree;
  tree.nodes.resize(count);
  tree.regions.reserve(cells);
  std::vector<Box> region_of_node(count);  // empty: no parent was found
  for (Vec3f* corner : {&region_of_node[0].min, &region_of_node[0].max}) {
    for (int axis = 0; axis < 3; ++axis) {
      (*corner)[axis] = reader.read<float>();
    }
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    CellNode& node = tree.nodes[i];
    const Box& region = region_of_node[i];
    node.axis = reader.read<std::uint8_t>();
    if (!region.wellFormed() || node.axis > CellNode::kCell) {
      return Error{"has cells that are not a tree of finite boxes"};
    }
    if (node.axis == CellNode::kCell) {
      node.link = tree.count();
      tree.regions.push_back(region);
      continue;
    }
    node.plane = reader.read<float>();
    node.link = reader.read<std::uint32_t>();
    const auto axis = static_cast<int>(node.axis);
    // Up to this one all have a region by now. So children have greater numbers than their parent and one
    // parent: all of it is one tree.
    if (node.link >= count - 1 || !region_of_node[node.link].empty() ||
        !region_of_node[node.link + 1].empty() || !(node.plane > region.min[axis]) ||
        !(node.plane < region.max[axis])) {
      return Error{"has a cell that is not divided into two"};
    }
    Box &left = region_of_node[node.link], &right = region_of_node[node.link + 1];
    left = right = region;
    left.max[axis] = right.min[axis] = node.plane;
  }
  return tree;
}

}  // namespace sightline::occluders
