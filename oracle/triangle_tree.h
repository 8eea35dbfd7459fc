#pragma once

// A binary tree of boxes over the triangles of a scene, in which each object has a tree of its own.

#include <cstdint>
#include <limits>
#include <vector>

#include "sightline/scene/scene.h"

namespace sightline {

// Tells an object's triangle from all others of the scene, also where several objects have the same indices.
inline std::uint64_t triangleKey(ObjectId object, std::uint32_t first_index) {
  return std::uint64_t{object.value} << 32 | first_index;
}

class TriangleTree {
 public:
  static constexpr std::uint32_t kNoNode = std::numeric_limits<std::uint32_t>::max();

  struct Node {
    Box box;
    std::uint32_t left = kNoNode, right = kNoNode;  // kNoNode in a leaf
    std::uint32_t first_index = 0;                  // of the triangle in a leaf
    ObjectId object;                                // of the triangle in a leaf

    bool isLeaf() const { return left == kNoNode; }
  };

  // Leaves out triangles with coordinates that are not finite.
  explicit TriangleTree(const SceneView& scene);

  const Node& node(std::uint32_t index) const { return nodes_[index]; }
  // kNoNode if there are no triangles.
  std::uint32_t root() const { return root_; }
  std::uint32_t rootOf(ObjectId object) const { return object_roots_[object.value]; }

  // Calls visit(leaf) for all triangles whose boxes the ray from `origin` may intersect, beyond rounding.
  // slack: how far the origin may be off, metres, besides the rounding of its coordinates.
  template <typename Visit>
  void alongRay(const Vec3d& origin, const Vec3d& direction, double slack, Visit&& visit) const {
    std::vector<std::uint32_t> open;
    if (root_ != kNoNode) {
      open.push_back(root_);
    }
    while (!open.empty()) {
      const Node& node = nodes_[open.back()];
      open.pop_back();
      if (!mayIntersect(origin, direction, slack, node.box)) {
        continue;
      }
      if (node.isLeaf()) {
        visit(node);
      } else {
        open.insert(open.end(), {node.right, node.left});
      }
    }
  }

 private:
  static bool mayIntersect(const Vec3d& origin, const Vec3d& direction, double slack, const Box& box);
  std::uint32_t join(std::vector<std::uint32_t>& parts);

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> object_roots_;
  std::uint32_t root_ = kNoNode;
};

}  // namespace sightline
