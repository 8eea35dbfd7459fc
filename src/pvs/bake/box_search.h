#pragma once

// Searches of a BoxTree that leave out whatever lies below a box of no interest.

#include <cstdint>

#include "sightline/hierarchy/box_tree.h"

namespace sightline::pvs {

// True if test(leaf) holds for one of the leaves that are left when nodes for whose box misses(box) holds are
// left out, with all below them. Asks leaves in the order of the tree, and stops at the first.
template <typename Misses, typename Test>
bool anyLeaf(const BoxTreeView& tree, const Misses& misses, const Test& test) {
  for (std::uint32_t n = 0; n < tree.nodes.size();) {
    const BoxNode& node = tree.nodes[n];
    if (misses(node.bounds)) {
      n = node.end;
      continue;
    }
    if (tree.leaf(n) && test(node)) {
      return true;
    }
    n += 1;
  }
  return false;
}

// Calls visit(leaf) for all of these leaves.
template <typename Misses, typename Visit>
void forEachLeaf(const BoxTreeView& tree, const Misses& misses, const Visit& visit) {
  anyLeaf(tree, misses, [&](const BoxNode& leaf) {
    visit(leaf);
    return false;
  });
}

}  // namespace sightline::pvs
