#include "src/pvs/bake/file/flatten.h"

#include <algorithm>
#include <array>
#include <map>
#include <unordered_map>

#include "src/pvs/format/checksum.h"

namespace sightline::pvs {
namespace {

class Flattener {
 public:
  Flattener(const BakeScene& scene, BakedVisibility& baked)
      : scene_(scene), octree_(baked.octree), sets_(baked.sets), doors_(baked.doors) {
    for (const std::vector<ObjectId>& group : scene.doors.groups) {
      doors_.doors.insert(doors_.doors.end(), group.begin(), group.end());
      doors_.group_ends.push_back(static_cast<std::uint32_t>(doors_.doors.size()));
    }
  }

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
    leaf.set = setOf(cell.sets.whole, cell.sets.whole_doors);
    if (cell.sets.plane) {
      leaf.plane = planeOf(*cell.sets.plane);
      leaf.front_set = setOf(cell.sets.front, cell.sets.front_doors);
      leaf.back_set = setOf(cell.sets.back, cell.sets.back_doors);
    }
    octree_.leaves.push_back(leaf);
    octree_.viewers.push_back(cell.viewers);
    octree_.depths.push_back(cell.level);
    octree_.reasons.push_back(static_cast<std::uint8_t>(cell.reason));
  }

  // The set of what is seen while all doors are open, with what doors hide of it.
  std::uint32_t setOf(const Runs& seen, const DoorRuns& doors) {
    hidden_.clear();
    for (const HiddenByDoors& all : doors) {
      // What a group within this one hides is stored with that.
      Runs own = without(all.hidden, scene_.door_runs);
      for (const HiddenByDoors& part : doors) {
        if (part.group != all.group && scene_.doors.isWithin(part.group, all.group)) {
          own = without(own, part.hidden);
        }
      }
      if (!own.empty()) {
        hidden_.push_back({all.group, numberOf(own, {})});
      }
    }
    Runs with_doors;
    if (!seen.empty()) {  // otherwise there are no viewers
      unite(seen, scene_.door_runs, with_doors);
    }
    return numberOf(with_doors, hidden_);
  }

  static Runs without(const Runs& runs, const Runs& left_out) {
    Runs left;
    subtract(runs, left_out, left);
    return left;
  }

  std::uint32_t numberOf(const Runs& runs, std::span<const DoorSet> hidden) {
    nodes_.clear();
    appendNodes(scene_.boxes.view(), runs, nodes_);
    const std::uint64_t hash = pvs::checksumOf(std::as_bytes(std::span(nodes_)));
    const auto [first, last] = sets_by_hash_.equal_range(hash);
    for (auto known = first; known != last; ++known) {
      if (std::ranges::equal(sets_[known->second], nodes_) &&
          std::ranges::equal(doors_.view().hiddenOf(known->second), hidden)) {
        return known->second;
      }
    }
    const std::uint32_t set = sets_.count();
    sets_.nodes.insert(sets_.nodes.end(), nodes_.begin(), nodes_.end());
    sets_.first.push_back(sets_.nodes.size());
    sets_by_hash_.emplace(hash, set);
    if (!doors_.doors.empty()) {
      doors_.hidden.insert(doors_.hidden.end(), hidden.begin(), hidden.end());
      doors_.hidden_ends.push_back(static_cast<std::uint32_t>(doors_.hidden.size()));
    }
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

  const BakeScene& scene_;
  VisibilityOctree& octree_;
  NodeSets& sets_;
  BakedDoors& doors_;
  std::unordered_multimap<std::uint64_t, std::uint32_t> sets_by_hash_;
  std::map<std::array<double, 5>, std::uint32_t> planes_;
  std::vector<std::uint32_t> nodes_;
  std::vector<DoorSet> hidden_;
};

}  // namespace

void flatten(const BakedCell& root, const BakeScene& scene, BakedVisibility& baked) {
  baked.octree.nodes.assign(1, 0);
  Flattener(scene, baked).add(root, 0);
  if (std::ranges::all_of(baked.octree.viewers, [](const ViewerBounds& v) { return v == ViewerBounds{}; })) {
    baked.octree.viewers.clear();
  }
}

}  // namespace sightline::pvs
