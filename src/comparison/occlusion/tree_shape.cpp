// Based on: Bittner, Havran, Slavik. Hierarchical Visibility Culling with Occlusion Trees. CGI 1998, section
// 6.2.

#include "sightline/comparison/tree_shape.h"

#include <optional>

#include "src/occlusion/tree/tree_build.h"

namespace sightline {

using namespace occlusion;

namespace {

TreeBranch branchOf(Link link) {
  if (link.isNode()) {
    return {TreeBranch::Kind::kNode, static_cast<std::uint32_t>(link.nodeIndex())};
  }
  if (link.isOut() || link.isOutside()) {
    return {link.isOut() ? TreeBranch::Kind::kLit : TreeBranch::Kind::kOutside};
  }
  return {TreeBranch::Kind::kShadow, static_cast<std::uint32_t>(link.leafIndex())};
}

// The sides of a plane that a box reaches.
struct Across {
  bool front = false, back = false;
};
Across acrossOf(const Plane& plane, const Vec3d& center, const Vec3d& half) {
  const double distance = plane.evaluate(center);
  const double radius = dot(abs(plane.normal), half);
  return {distance + radius > 0.0, distance - radius < 0.0};
}

}  // namespace

TreeShape shapeOfTree(const View& view, const OccluderSet& set, std::span<const OccluderId> chosen,
                      bool modified) {
  const ChosenOccluders only{&set, chosen};
  TreeBuilder builder;
  TreeData data;
  if (!builder.build(view, {&only, 1}, {.modified = modified}, data)) {
    return {};
  }
  TreeShape shape;
  shape.root = branchOf(data.root);
  shape.frustum_nodes = data.frustum_nodes;
  for (const TreeNode& node : data.nodes) {
    shape.nodes.push_back({node.plane, node.repeated, branchOf(node.front), branchOf(node.back)});
  }
  for (const ShadowLeaf& leaf : data.leaves) {
    const OcclusionVolume& volume = data.volumes.volumes[leaf.volume];
    const auto first = data.corners.begin() + leaf.first_corner;
    shape.leaves.push_back({volume.occluder, volume.support, {first, first + leaf.corner_count}});
  }
  return shape;
}

Visibility classifyUncut(const TreeShape& tree, const Vec3d& eye, const Box& box,
                         std::vector<TreePlace>* leaves) {
  const Vec3d middle = center(box) - eye, half = Vec3d(box.extent()) * 0.5;
  std::vector<TreePlace> waiting{TreePlace{}};
  std::optional<Visibility> state;
  while (!waiting.empty()) {
    const TreePlace place = waiting.back();
    waiting.pop_back();
    const TreeBranch next = tree.at(place);
    if (next.kind == TreeBranch::Kind::kNode) {
      const Across across = acrossOf(tree.nodes[next.index].plane, middle, half);
      if (across.front) {
        waiting.push_back({next.index, true});
      }
      if (across.back || !across.front) {
        waiting.push_back({next.index, false});
      }
      continue;
    }
    if (leaves != nullptr) {
      leaves->push_back(place);
    }
    if (next.kind == TreeBranch::Kind::kOutside) {
      continue;
    }
    Visibility of_leaf = Visibility::kVisible;
    if (next.kind == TreeBranch::Kind::kShadow) {
      const Across across = acrossOf(tree.leaves[next.index].support, middle, half);
      of_leaf = !across.front  ? Visibility::kHidden
                : !across.back ? Visibility::kVisible
                               : Visibility::kPartial;
    }
    state = state ? combine(*state, of_leaf) : of_leaf;
  }
  return state.value_or(Visibility::kHidden);
}

}  // namespace sightline
