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

// What is wrong with the numbers of a hierarchy; empty if nothing is.
std::string flawOf(const Hierarchy& hierarchy, std::uint32_t objects) {
  if (hierarchy.depth > kMostLevels) {
    return "it has too many levels";
  }
  if (!isTree(hierarchy)) {
    return "its nodes are no tree";
  }
  const auto ordered = [](const Box& b) {
    return b.min.x <= b.max.x && b.min.y <= b.max.y && b.min.z <= b.max.z;
  };
  if (!std::all_of(hierarchy.nodes.begin(), hierarchy.nodes.end(),
                   [&](const HierarchyNode& node) { return ordered(node.bounds); })) {
    return "some of its boxes are none";
  }
  std::vector<bool> listed(objects);
  std::uint32_t count = 0;
  for (const ObjectId object : hierarchy.objects) {
    if (object.value >= objects) {
      return "it names objects that there are not";
    }
    count += listed[object.value] ? 0 : 1;
    listed[object.value] = true;
  }
  return count == objects && hierarchy.object_count == objects ? "" : "it does not have all objects";
}

}  // namespace

LargeVector<std::byte> hierarchyBytes(const Hierarchy& hierarchy) {
  const Numbers numbers{static_cast<std::uint32_t>(hierarchy.kind), hierarchy.object_count, hierarchy.depth};
  base::ArrayWriter writer(sizeof(kHierarchyHead) + sizeof(numbers) +
                           base::ArrayWriter::sizeOf(hierarchy.nodes) +
                           base::ArrayWriter::sizeOf(hierarchy.objects));
  writer.value(kHierarchyHead);
  writer.value(numbers);
  writer.array(hierarchy.nodes);
  writer.array(hierarchy.objects);
  return writer.take();
}

Result<Hierarchy> hierarchyFrom(std::span<const std::byte> bytes, std::uint32_t object_count) {
  const SharedBytes shared{bytes};
  base::ArrayReader reader(shared);
  base::ArraysHead head{};
  Numbers numbers{};
  reader.value(head);
  reader.value(numbers);
  if (head != kHierarchyHead || numbers[0] > static_cast<std::uint32_t>(HierarchyKind::kBvh)) {
    return Error{"this is no hierarchy, or one of another version or machine: build it again"};
  }
  Hierarchy hierarchy;
  hierarchy.kind = static_cast<HierarchyKind>(numbers[0]);
  hierarchy.object_count = numbers[1];
  hierarchy.depth = numbers[2];
  reader.array(hierarchy.nodes);
  reader.array(hierarchy.objects);
  if (!reader.complete()) {
    return Error{"the hierarchy is cut off, or something follows it: build it again"};
  }
  if (const std::string flaw = flawOf(hierarchy, object_count); !flaw.empty()) {
    return Error{"the hierarchy is not sound, " + flaw + ": build it again"};
  }
  return hierarchy;
}

}  // namespace sightline
