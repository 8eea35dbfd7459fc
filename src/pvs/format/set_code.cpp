#include "src/pvs/format/set_code.h"

#include <algorithm>

namespace sightline::pvs {
namespace {

void appendNumber(std::vector<std::byte>& bytes, std::uint32_t value) {
  for (; value >= 0x80; value >>= 7) {
    bytes.push_back(static_cast<std::byte>((value & 0x7f) | 0x80));
  }
  bytes.push_back(static_cast<std::byte>(value));
}

// Reads a number and moves `at` past it. Returns false if the number does not end or has more than 32 bits.
bool readLongNumber(const std::byte*& at, const std::byte* end, std::uint32_t& value) {
  std::uint64_t number = 0;
  for (std::uint32_t shift = 0; shift < 35 && at != end; shift += 7) {
    const auto byte = static_cast<std::uint64_t>(*at++);
    number |= (byte & 0x7f) << shift;
    if (byte < 0x80) {
      value = static_cast<std::uint32_t>(number);
      return number <= 0xffffffffu;
    }
  }
  return false;
}

// Fast path: most numbers take one byte.
bool readNumber(const std::byte*& at, const std::byte* end, std::uint32_t& value) {
  if (at != end && static_cast<std::uint8_t>(*at) < 0x80) {
    value = static_cast<std::uint8_t>(*at++);
    return true;
  }
  return readLongNumber(at, end, value);
}

// Reads nodes from their distances. Each distance counts from the end of the node before, so no node can be
// below another.
bool readNodes(const std::byte* at, const std::byte* end, std::span<const std::uint32_t> ends,
               std::span<std::uint32_t> nodes) {
  std::uint64_t next = 0;  // minimum of the next node's index
  for (std::uint32_t& node : nodes) {
    std::uint32_t distance = 0;
    if (!readNumber(at, end, distance)) {
      return false;
    }
    next += distance;
    if (next >= ends.size()) {
      return false;
    }
    node = static_cast<std::uint32_t>(next);
    next = ends[node];
  }
  return at == end;
}

}  // namespace

void appendSet(std::vector<std::byte>& bytes, std::span<const std::uint32_t> nodes,
               std::span<const BoxNode> tree) {
  appendNumber(bytes, static_cast<std::uint32_t>(nodes.size()));
  std::uint32_t next = 0;
  for (const std::uint32_t node : nodes) {
    appendNumber(bytes, node - next);
    next = tree[node].end;
  }
}

bool soundSet(std::span<const std::uint32_t> nodes, std::span<const BoxNode> tree) {
  bool sound = nodes.empty() || nodes.back() < tree.size();
  for (std::size_t i = 0; sound && i + 1 < nodes.size(); ++i) {
    sound = nodes[i] < nodes[i + 1];
  }
  for (std::size_t i = 0; sound && i + 1 < nodes.size(); ++i) {
    sound = tree[nodes[i]].end <= nodes[i + 1];
  }
  return sound;
}

std::vector<std::uint32_t> endsOf(std::span<const BoxNode> tree) {
  std::vector<std::uint32_t> ends(tree.size());
  std::transform(tree.begin(), tree.end(), ends.begin(), [](const BoxNode& node) { return node.end; });
  return ends;
}

bool decodeSet(std::span<const std::byte> bytes, std::span<const std::uint32_t> ends,
               std::vector<std::uint32_t>& nodes) {
  const std::byte* at = bytes.data();
  const std::byte* end = at + bytes.size();
  std::uint32_t count = 0;
  // Each node takes at least one byte, so no count can request more memory than the bytes justify.
  if (!readNumber(at, end, count) || count > static_cast<std::size_t>(end - at)) {
    return false;
  }
  const std::size_t before = nodes.size();
  nodes.resize(before + count);
  const std::span<std::uint32_t> added = std::span(nodes).subspan(before);
  if (!readNodes(at, end, ends, added)) {
    nodes.resize(before);
    return false;
  }
  return true;
}

}  // namespace sightline::pvs
