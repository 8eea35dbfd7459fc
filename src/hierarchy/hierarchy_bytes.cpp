#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "sightline/hierarchy/hierarchy.h"
#include "src/base/array_bytes.h"

namespace sightline {
namespace {

// The last two letters: raise them with every change of the arrays or of buildHierarchy().
constexpr base::ArraysHead kHierarchyHead{{'S', 'L', 'h', 'i', 'e', 'r', '0', '1'}, sizeof(HierarchyNode)};

constexpr const char* kName = "nodes of the hierarchy";

using Numbers = std::array<std::uint32_t, 4>;  // kind, object_count, depth, 0

// Whether nodes are in depth-first order, links of inner nodes end where their subtrees do, those of leaves
// ascend within `objects`, and there are so many levels.
bool isTree(const Hierarchy& hierarchy) {
  struct Open {
    std::uint32_t end = 0;       // of the subtree
    std::uint32_t children = 0;  // that have not ended
  };
  std::vector<Open> open;  // inner nodes, from the root down
  std::size_t depth = 0;
  std::uint64_t least_link = 0;  // of the next leaf
  const auto size = static_cast<std::uint32_t>(hierarchy.nodes.size());
  for (std::uint32_t n = 0; n < size; ++n) {
    const HierarchyNode& node = hierarchy.nodes[n];
    if ((n > 0 && open.empty()) || open.size() >= hierarchy.depth) {
      return false;
    }
    depth = std::max(depth, open.size() + 1);
    if (!node.leaf()) {
      open.push_back({node.link, 2});
      continue;
    }
    if (node.link < least_link || node.link >= hierarchy.objects.size() ||
        (least_link == 0 && node.link != 0)) {
      return false;
    }
    least_link = std::uint64_t{node.link} + 1;
    while (!open.empty() && --open.back().children == 0) {
      if (open.back().end != n + 1) {
        return false;
      }
      open.pop_back();
    }
  }
  return open.empty() && depth == hierarchy.depth && (size > 0 || hierarchy.objects.empty());
}

// More levels than any hierarchy has that is of use: what is linear in them stays short.
constexpr std::uint32_t kMostLevels = 256;

// What is wrong with the nodes of a hierarchy; empty if nothing is.
std::string flawOf(const Hierarchy& hierarchy, std::uint32_t objects) {
  if (hierarchy.depth > kMostLevels) {
    return "they have too many levels";
  }
  if (!isTree(hierarchy)) {
    return "they are no tree";
  }
  const auto ordered = [](const Box& b) {
    return b.min.x <= b.max.x && b.min.y <= b.max.y && b.min.z <= b.max.z;
  };
  if (!std::all_of(hierarchy.nodes.begin(), hierarchy.nodes.end(),
                   [&](const HierarchyNode& node) { return ordered(node.bounds); })) {
    return "some of their boxes are none";
  }
  std::vector<bool> listed(objects);
  std::uint32_t count = 0;
  for (const ObjectId object : hierarchy.objects) {
    if (object.value >= objects) {
      return "they name objects that there are not";
    }
    count += listed[object.value] ? 0 : 1;
    listed[object.value] = true;
  }
  return count == objects && hierarchy.object_count == objects ? "" : "they do not have all objects";
}

}  // namespace

LargeVector<std::byte> hierarchyBytes(const Hierarchy& hierarchy) {
  const Numbers numbers{static_cast<std::uint32_t>(hierarchy.kind), hierarchy.object_count, hierarchy.depth};
  return base::arrayBytes(kHierarchyHead, [&](auto&& visit) {
    visit(numbers);
    visit(hierarchy.nodes);
    visit(hierarchy.objects);
  });
}

Result<Hierarchy> hierarchyFrom(std::span<const std::byte> bytes, std::uint32_t object_count) {
  Hierarchy hierarchy;
  Numbers numbers{};
  const Status read = base::readArrays({bytes}, kHierarchyHead, kName, [&](auto&& visit) {
    visit(numbers);
    visit(hierarchy.nodes);
    visit(hierarchy.objects);
  });
  if (!read) {
    return read.error();
  }
  if (numbers[0] > static_cast<std::uint32_t>(HierarchyKind::kBvh)) {
    return base::unsoundArrays(kName, "there is no such hierarchy");
  }
  hierarchy.kind = static_cast<HierarchyKind>(numbers[0]);
  hierarchy.object_count = numbers[1];
  hierarchy.depth = numbers[2];
  if (const std::string flaw = flawOf(hierarchy, object_count); !flaw.empty()) {
    return base::unsoundArrays(kName, flaw);
  }
  return hierarchy;
}

}  // namespace sightline
