#pragma once

// Sets of nodes as bytes; the form is described in sight.fbs.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sightline/hierarchy/box_tree.h"

namespace sightline::pvs {

// nodes: a soundSet of the tree.
void appendSet(std::vector<std::byte>& bytes, std::span<const std::uint32_t> nodes,
               std::span<const BoxNode> tree);

// At most so many bytes: a set of that many nodes.
constexpr std::uint64_t maxSetBytes(std::uint64_t node_count) {
  return 5 * (node_count + 1);
}

// BoxNode::end of all nodes, close together: decoding waits for one of them after each node.
std::vector<std::uint32_t> endsOf(std::span<const BoxNode> tree);

// Appends the nodes of a set. false, with nothing appended: the bytes are not exactly one set, or a node is
// not in the tree or lies below another one of the set. ends: endsOf the nodes of a sound BoxTree.
bool decodeSet(std::span<const std::byte> bytes, std::span<const std::uint32_t> ends,
               std::vector<std::uint32_t>& nodes);

// Whether a set is ascending, in the tree, and none of it is below another.
bool soundSet(std::span<const std::uint32_t> nodes, std::span<const BoxNode> tree);

}  // namespace sightline::pvs
