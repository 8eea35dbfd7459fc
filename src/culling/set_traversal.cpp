#include "src/culling/set_traversal.h"

#include <algorithm>

namespace sightline::culling {

void SetTraversal::run(const Frustum& frustum, const BoxTreeView& tree, std::span<const std::uint32_t> set,
                       CullStats& stats, std::vector<ObjectId>& out) {
  stack_.clear();
  if (!set.empty()) {
    stack_.push_back({0, 0, static_cast<std::uint32_t>(set.size()), kAllFrustumPlanes});
  }
  while (!stack_.empty()) {
    const Entry entry = stack_.back();
    stack_.pop_back();
    visit(entry, frustum, tree, set, stats);
  }
  visible_.drainInto(out);
}

void SetTraversal::visit(const Entry& entry, const Frustum& frustum, const BoxTreeView& tree,
                         std::span<const std::uint32_t> set, CullStats& stats) {
  std::uint8_t planes = entry.planes;
  ++stats.nodes_visited;
  if (classify(frustum, tree.nodes[entry.node].bounds, planes) == FrustumSide::kOutside) {
    return;
  }
  Entry inner = entry;
  if (entry.begin < entry.end && set[entry.begin] == entry.node) {
    inner.begin = inner.end = 0;
  }
  const bool whole = inner.begin == inner.end;
  if (planes != 0 && !tree.leaf(entry.node)) {
    pushChildren(inner, planes, tree, set);
  } else if (whole) {
    keep(tree.objectsBelow(entry.node));
  } else {
    for (std::uint32_t i = inner.begin; i < inner.end; ++i) {
      keep(tree.objectsBelow(set[i]));
    }
  }
}

void SetTraversal::keep(std::span<const ObjectId> objects) {
  for (const ObjectId object : objects) {
    visible_.insert(object);
  }
}

void SetTraversal::pushChildren(const Entry& parent, std::uint8_t planes, const BoxTreeView& tree,
                                std::span<const std::uint32_t> set) {
  const std::uint32_t last = tree.nodes[parent.node].end;
  if (parent.begin == parent.end) {
    for (std::uint32_t child = parent.node + 1; child < last; child = tree.nodes[child].end) {
      stack_.push_back({child, 0, 0, planes});
    }
    return;
  }
  // The nodes of the set lie in the order of the tree, child after child.
  std::uint32_t begin = parent.begin;
  for (std::uint32_t child = parent.node + 1; child < last && begin < parent.end;
       child = tree.nodes[child].end) {
    const auto first = set.begin() + begin, after = set.begin() + parent.end;
    const auto end =
        static_cast<std::uint32_t>(std::lower_bound(first, after, tree.nodes[child].end) - set.begin());
    if (end > begin) {
      stack_.push_back({child, begin, end, planes});
    }
    begin = end;
  }
}

}  // namespace sightline::culling
