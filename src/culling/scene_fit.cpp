#include "src/culling/scene_fit.h"

#include <algorithm>

namespace sightline::culling {

bool isOf(const Hierarchy& hierarchy, std::span<const Box> object_bounds) {
  const auto hasABox = [&](ObjectId object) { return object.value < object_bounds.size(); };
  if (!std::all_of(hierarchy.objects.begin(), hierarchy.objects.end(), hasABox)) {
    return false;
  }
  std::vector<Box> around(object_bounds.size());  // by object: the leaves that name it
  // From the last leaf to the first: a leaf's entries end where those of the next one begin.
  std::size_t end = hierarchy.objects.size();
  for (std::size_t n = hierarchy.nodes.size(); n-- > 0;) {
    const HierarchyNode& node = hierarchy.nodes[n];
    if (!node.leaf()) {
      continue;
    }
    if (node.link >= end) {
      return false;
    }
    for (std::size_t i = node.link; i < end; ++i) {
      around[hierarchy.objects[i].value].extend(node.bounds);
    }
    end = node.link;
  }
  if (end != 0) {
    return false;
  }
  return std::equal(
      object_bounds.begin(), object_bounds.end(), around.begin(), [](const Box& box, const Box& leaves) {
        return !leaves.empty() && (box.wellFormed() ? contains(leaves, box) : !leaves.wellFormed());
      });
}

bool isOf(const BoxTreeView& tree, std::span<const Box> object_bounds) {
  if (tree.objects.size() != object_bounds.size()) {
    return false;
  }
  std::vector<bool> found(object_bounds.size(), false);
  std::size_t leaves = 0;
  for (std::uint32_t n = 0; n < tree.nodes.size(); ++n) {
    if (!tree.leaf(n)) {
      continue;
    }
    const std::span<const ObjectId> below = tree.objectsBelow(n);
    if (below.size() != 1 || below[0].value >= object_bounds.size() || found[below[0].value]) {
      return false;
    }
    const Box& leaf = tree.nodes[n].bounds;
    const Box& box = object_bounds[below[0].value];
    if (box.wellFormed() ? leaf != box : leaf.wellFormed()) {
      return false;
    }
    found[below[0].value] = true;
    ++leaves;
  }
  return leaves == object_bounds.size();
}

void appendAll(const Hierarchy& hierarchy, std::size_t box_count, std::vector<ObjectId>& out) {
  for (std::size_t i = 0; i < box_count; ++i) {
    out.push_back(ObjectId(i));
  }
  const auto first = static_cast<std::ptrdiff_t>(out.size());
  for (const ObjectId object : hierarchy.objects) {
    if (object.valid() && object.value >= box_count) {
      out.push_back(object);
    }
  }
  std::sort(out.begin() + first, out.end());
  out.erase(std::unique(out.begin() + first, out.end()), out.end());
}

}  // namespace sightline::culling
