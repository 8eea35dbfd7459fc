#pragma once

// Encodes sets of nodes as bytes; sight.fbs describes the encoding.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sightline/hierarchy/box_tree.h"

namespace sightline::pvs {

// nodes: must be a soundSet of the tree.
void appendSet(std::vector<std::byte>& bytes, std::span<const std::uint32_t> nodes,
               std::span<const BoxNode> tree);

// Maximum number of bytes of a set with this many nodes.
constexpr std::uint64_t maxSetBytes(std::uint64_t node_count) {
  return 5 * (node_count + 1);
}

// BoxNode::end of all nodes as a dense array, because decoding reads one of them after each node.
std::vector<std::uint32_t> endsOf(std::span<const BoxNode> tree);

// Appends the nodes of a set. Returns false and appends nothing if the bytes are not exactly one set, or if a
// node is not in the tree or is below another node of the set. ends: endsOf() the nodes of a sound BoxTree.
bool decodeSet(std::span<const std::byte> bytes, std::span<const std::uint32_t> ends,
               std::vector<std::uint32_t>& nodes);

// True if the nodes are ascending, in the tree, and none is below another.
bool soundSet(std::span<const std::uint32_t> nodes, std::span<const BoxNode> tree);

}  // namespace sightline::pvs
