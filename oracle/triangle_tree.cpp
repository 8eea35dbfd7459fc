#include "oracle/triangle_tree.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "src/math/longest_axis.h"

namespace sightline {

// Widened by far more than the rounding of this test and of a direction in double precision, which over the
// distance from the origin to the box moves a ray by a fraction of the coordinates of both.
bool TriangleTree::mayIntersect(const Vec3d& origin, const Vec3d& direction, double slack, const Box& box) {
  slack += 1e-9 * (maxComponent(abs(origin)) + maxComponent(max(abs(Vec3d(box.min)), abs(Vec3d(box.max))))) +
           1e-39;
  double enter = -std::numeric_limits<double>::infinity(), leave = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const double low = box.min[axis] - slack - origin[axis], high = box.max[axis] + slack - origin[axis];
    if (std::abs(direction[axis]) < 1e-300) {
      if (low > 0.0 || high < 0.0) {
        return false;
      }
      continue;
    }
    const double a = low / direction[axis], b = high / direction[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter <= leave * (1.0 + 1e-12) + 1e-300 && leave >= 0.0;
}

TriangleTree::TriangleTree(const SceneView& scene) {
  nodes_.reserve(2 * scene.indices.size() / 3);
  std::vector<std::uint32_t> leaves;
  for (std::uint32_t o = 0; o < scene.objects.size(); ++o) {
    leaves.clear();
    const std::span<const std::uint32_t> indices = scene.indicesOf(scene.objects[o]);
    for (std::uint32_t i = 0; i + 2 < indices.size(); i += 3) {
      Node leaf;
      leaf.first_index = scene.objects[o].first_index + i;
      leaf.object = ObjectId(o);
      bool finite = true;
      for (const std::uint32_t corner : indices.subspan(i, 3)) {
        leaf.box.extend(scene.positions[corner]);
        finite = finite && isFinite(scene.positions[corner]);
      }
      if (finite) {
        leaves.push_back(static_cast<std::uint32_t>(nodes_.size()));
        nodes_.push_back(leaf);
      }
    }
    object_roots_.push_back(join(leaves));
  }
  std::vector<std::uint32_t> roots;
  std::copy_if(object_roots_.begin(), object_roots_.end(), std::back_inserter(roots),
               [](std::uint32_t root) { return root != kNoNode; });
  root_ = join(roots);
}

// Makes one tree of several, divided at the median along the longest axis; returns its root.
std::uint32_t TriangleTree::join(std::vector<std::uint32_t>& parts) {
  if (parts.empty()) {
    return kNoNode;
  }
  const auto joinRange = [&](const auto& self, std::size_t begin, std::size_t end) -> std::uint32_t {
    if (end - begin == 1) {
      return parts[begin];
    }
    Node node;
    for (std::size_t i = begin; i < end; ++i) {
      node.box.extend(nodes_[parts[i]].box);
    }
    const int axis = math::longestAxis(node.box.extent());
    const std::size_t middle = (begin + end) / 2;
    const auto at = [&](std::size_t i) { return parts.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(middle), at(end), [&](std::uint32_t a, std::uint32_t b) {
      const double x = center(nodes_[a].box)[axis], y = center(nodes_[b].box)[axis];
      return x < y || (x == y && a < b);
    });
    node.left = self(self, begin, middle);
    node.right = self(self, middle, end);
    nodes_.push_back(node);
    return static_cast<std::uint32_t>(nodes_.size() - 1);
  };
  return joinRange(joinRange, 0, parts.size());
}

}  // namespace sightline
