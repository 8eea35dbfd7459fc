#include <cmath>

#include "src/io/corner_order.h"
#include "src/io/gltf/gltf_model.h"

namespace sightline::io {
namespace {

bool allFinite(const Mat4& matrix) {
  for (const double element : matrix.m) {
    if (!std::isfinite(element)) {
      return false;
    }
  }
  return true;
}

Result<Mat4> parentFromNode(const Document& document, std::size_t number) {
  const GltfFile::Node& node = document.file.nodes[number];
  Mat4 matrix;
  if (node.matrix) {
    matrix.m = *node.matrix;
    if (matrix(3, 0) != 0.0 || matrix(3, 1) != 0.0 || matrix(3, 2) != 0.0 || matrix(3, 3) != 1.0) {
      return failure("{}: node {}: the last row of its matrix must be 0 0 0 1", document.name, number);
    }
  } else {
    matrix = matrixOf(node.pose);
  }
  if (!allFinite(matrix)) {
    return failure("{}: node {}: its transform is not finite (a rotation of length 0, or numbers too large)",
                   document.name, number);
  }
  return matrix;
}

// Children exist and have one parent each.
Status linkNodes(const Document& document, NodeTree& tree) {
  const auto& nodes = document.file.nodes;
  tree.parent.assign(nodes.size(), -1);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    for (const int child : nodes[i].children) {
      if (!isIndexInto(child, nodes.size())) {
        return failure("{}: node {}: child {} does not exist (the file has {} nodes)", document.name, i,
                       child, nodes.size());
      }
      int& parent = tree.parent[static_cast<std::size_t>(child)];
      if (parent >= 0) {
        return failure("{}: node {}: is a child of node {} and of node {}; nodes must form a tree",
                       document.name, child, parent, i);
      }
      parent = static_cast<int>(i);
    }
  }
  return Success{};
}

// Depth first from a node without parent; each node is reached at most once because it has one parent.
Status visitFrom(const Document& document, int root, NodeTree& tree) {
  std::vector<int> open{root};
  while (!open.empty()) {
    const auto node = static_cast<std::size_t>(open.back());
    open.pop_back();
    tree.visited.push_back(static_cast<int>(node));
    tree.in_scene[node] = true;
    const int parent = tree.parent[node];
    const bool below = parent >= 0;
    tree.moves[node] = document.moving.nodes[node] || (below && tree.moves[static_cast<std::size_t>(parent)]);
    tree.hidden[node] = (!document.file.nodes[node].visible && !document.moving.visibility[node]) ||
                        (below && tree.hidden[static_cast<std::size_t>(parent)]);
    tree.world_from_node[node] =
        parent < 0 ? tree.parent_from_node[node]
                   : tree.world_from_node[static_cast<std::size_t>(parent)] * tree.parent_from_node[node];
    if (!allFinite(tree.world_from_node[node])) {
      return failure("{}: node {}: its transform to world space is too large", document.name, node);
    }
    tree.flat[node] = cornerOrder(tree.world_from_node[node]) == CornerOrder::kUnknown ||
                      (below && tree.flat[static_cast<std::size_t>(parent)]);
    const auto& children = document.file.nodes[node].children;
    open.insert(open.end(), children.rbegin(), children.rend());
  }
  return Success{};
}

Status refuseCycles(const Document& document, const NodeTree& tree) {
  // Every node hangs below a root, or else below a cycle.
  std::vector<bool> reached(tree.parent.size(), false);
  std::vector<int> open;
  for (std::size_t i = 0; i < tree.parent.size(); ++i) {
    if (tree.parent[i] < 0) {
      open.push_back(static_cast<int>(i));
    }
  }
  while (!open.empty()) {
    const auto node = static_cast<std::size_t>(open.back());
    open.pop_back();
    reached[node] = true;
    const auto& children = document.file.nodes[node].children;
    open.insert(open.end(), children.begin(), children.end());
  }
  for (std::size_t i = 0; i < reached.size(); ++i) {
    if (!reached[i]) {
      return failure("{}: node {}: is its own ancestor, or hangs below such a node", document.name, i);
    }
  }
  return Success{};
}

// The default scene's roots; those of the first scene, or all nodes without parent, when the file does not
// say.
Result<std::vector<int>> rootsOf(const Document& document, const NodeTree& tree) {
  const GltfFile& file = document.file;
  std::vector<int> roots;
  if (file.scene >= 0 && !isIndexInto(file.scene, file.scenes.size())) {
    return failure("{}: scene {} does not exist (the file has {})", document.name, file.scene,
                   file.scenes.size());
  }
  if (file.scenes.empty()) {
    for (std::size_t i = 0; i < tree.parent.size(); ++i) {
      if (tree.parent[i] < 0) {
        roots.push_back(static_cast<int>(i));
      }
    }
    return roots;
  }
  const auto scene = static_cast<std::size_t>(std::max(file.scene, 0));
  std::vector<bool> named(tree.parent.size(), false);
  for (const int root : file.scenes[scene].nodes) {
    if (!isIndexInto(root, file.nodes.size())) {
      return failure("{}: scene {}: node {} does not exist (the file has {})", document.name, scene, root,
                     file.nodes.size());
    }
    const auto at = static_cast<std::size_t>(root);
    if (named[at] || tree.parent[at] >= 0) {
      return failure(
          "{}: scene {}: node {} is {}", document.name, scene, root,
          named[at] ? "named twice" : fmt::format("not a root but a child of node {}", tree.parent[at]));
    }
    named[at] = true;
    roots.push_back(root);
  }
  return roots;
}

}  // namespace

Mat4 matrixOf(const NodePose& pose) {
  const auto [qx, qy, qz, qw] = pose.rotation;
  const double norm = std::sqrt(qx * qx + qy * qy + qz * qz + qw * qw);
  // Of length 0: not a number, which the caller refuses.
  const double x = qx / norm, y = qy / norm, z = qz / norm, w = qw / norm;
  const Vec3d& s = pose.scale;
  Mat4 matrix;
  matrix.m = {(1 - 2 * (y * y + z * z)) * s.x,
              2 * (x * y + z * w) * s.x,
              2 * (x * z - y * w) * s.x,
              0,
              2 * (x * y - z * w) * s.y,
              (1 - 2 * (x * x + z * z)) * s.y,
              2 * (y * z + x * w) * s.y,
              0,
              2 * (x * z + y * w) * s.z,
              2 * (y * z - x * w) * s.z,
              (1 - 2 * (x * x + y * y)) * s.z,
              0,
              pose.translation.x,
              pose.translation.y,
              pose.translation.z,
              1};
  return matrix;
}

Result<NodeTree> buildNodeTree(const Document& document) {
  NodeTree tree;
  Status status = linkNodes(document, tree);
  if (status) {
    status = refuseCycles(document, tree);
  }
  if (!status) {
    return status.error();
  }
  const std::size_t count = document.file.nodes.size();
  tree.parent_from_node.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Result<Mat4> matrix = parentFromNode(document, i);
    if (!matrix) {
      return matrix.error();
    }
    tree.parent_from_node.push_back(*matrix);
  }
  tree.world_from_node.resize(count);
  tree.in_scene.resize(count);
  tree.moves.resize(count);
  tree.hidden.resize(count);
  tree.flat.resize(count);
  const Result<std::vector<int>> roots = rootsOf(document, tree);
  if (!roots) {
    return roots.error();
  }
  for (const int root : *roots) {
    status = visitFrom(document, root, tree);
    if (!status) {
      return status.error();
    }
  }
  return tree;
}

}  // namespace sightline::io
