#include "src/pvs/bake/flatten.h"

#include <algorithm>
#include <array>
#include <map>
#include <unordered_map>

#include "src/pvs/format/checksum.h"

namespace sightline::pvs {
namespace {

class Flattener {
 public:
  Flattener(const BoxTreeView& boxes, VisibilityOctree& octree, NodeSets& sets)
      : boxes_(boxes), octree_(octree), sets_(sets) {}

  // Writes the cell to octree.nodes[node], which must exist.
  void add(const BakedCell& cell, std::uint32_t node) {
    if (cell.leaf()) {
      octree_.nodes[node] = kOctreeLeaf | static_cast<std::uint32_t>(octree_.leaves.size());
      addLeaf(cell);
      return;
    }
    const auto first = static_cast<std::uint32_t>(octree_.nodes.size());
    octree_.nodes[node] = first;
    octree_.nodes.resize(first + 8);
    for (std::uint32_t i = 0; i < 8; ++i) {
      add(cell.children[i], first + i);
    }
  }

 private:
  void addLeaf(const BakedCell& cell) {
    OctreeLeaf leaf;
    leaf.set = setOf(cell.sets.whole);
    if (cell.sets.plane) {
      leaf.plane = planeOf(*cell.sets.plane);
      leaf.front_set = setOf(cell.sets.front);
      leaf.back_set = setOf(cell.sets.back);
    }
    octree_.leaves.push_back(leaf);
    octree_.viewers.push_back(cell.viewers);
    octree_.depths.push_back(cell.level);
    octree_.reasons.push_back(static_cast<std::uint8_t>(cell.reason));
  }

  std::uint32_t setOf(const Runs& runs) {
    nodes_.clear();
    appendNodes(boxes_, runs, nodes_);
    const std::uint64_t hash = pvs::checksumOf(std::as_bytes(std::span(nodes_)));
    const auto [first, last] = sets_by_hash_.equal_range(hash);
    for (auto known = first; known != last; ++known) {
      if (std::ranges::equal(sets_[known->second], nodes_)) {
        return known->second;
      }
    }
    const std::uint32_t set = sets_.count();
    sets_.nodes.insert(sets_.nodes.end(), nodes_.begin(), nodes_.end());
    sets_.first.push_back(sets_.nodes.size());
    sets_by_hash_.emplace(hash, set);
    return set;
  }

  std::uint32_t planeOf(const CellPlane& plane) {
    const std::array<double, 5> key{plane.normal.x, plane.normal.y, plane.normal.z, plane.front, plane.back};
    const auto [place, is_new] = planes_.try_emplace(key, static_cast<std::uint32_t>(octree_.planes.size()));
    if (is_new) {
      octree_.planes.push_back(plane);
    }
    return place->second;
  }

  BoxTreeView boxes_;
  VisibilityOctree& octree_;
  NodeSets& sets_;
  std::unordered_multimap<std::uint64_t, std::uint32_t> sets_by_hash_;
  std::map<std::array<double, 5>, std::uint32_t> planes_;
  std::vector<std::uint32_t> nodes_;
};

}  // namespace

void flatten(const BakedCell& root, const BoxTreeView& boxes, VisibilityOctree& octree, NodeSets& sets) {
  octree.nodes.assign(1, 0);
  Flattener(boxes, octree, sets).add(root, 0);
  if (std::ranges::all_of(octree.viewers, [](const ViewerBounds& v) { return v == ViewerBounds{}; })) {
    octree.viewers.clear();
  }
}

}  // namespace sightline::pvs
