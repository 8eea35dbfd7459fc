#include "src/pvs/bake/file/flatten.h"

#include <algorithm>

#include "src/base/hash_slots.h"
#include "src/pvs/format/checksum.h"

namespace sightline::pvs {
namespace {

Runs without(const Runs& runs, const Runs& left_out) {
  Runs left;
  subtract(runs, left_out, left);
  return left;
}

// Sets that stay in memory.
class KeptSets final : public SetStore {
 public:
  explicit KeptSets(NodeSets& sets) : sets_(sets) {}

  std::uint32_t count() const override { return sets_.count(); }
  bool same(std::uint32_t set, std::span<const std::uint32_t> nodes) override {
    return std::ranges::equal(sets_[set], nodes);
  }
  void add(std::span<const std::uint32_t> nodes) override {
    sets_.nodes.insert(sets_.nodes.end(), nodes.begin(), nodes.end());
    sets_.first.push_back(sets_.nodes.size());
  }

 private:
  NodeSets& sets_;
};

}  // namespace

void HashIndex::grow() {
  slots_.assign(2 * slots_.size(), 0);
  for (std::uint32_t key = 0; key < hashes_.size(); ++key) {
    const std::size_t slot =
        base::probeSlots(slots_, base::mixBits(hashes_[key]), [](std::uint32_t other) { return other == 0; });
    slots_[slot] = key + 1;
  }
}

Flattener::Flattener(const BakeScene& scene, VisibilityOctree& octree, BakedDoors& doors, SetStore& sets)
    : scene_(scene), octree_(octree), doors_(doors), sets_(sets) {
  octree_.nodes.assign(1, 0);
  for (const std::vector<ObjectId>& group : scene.doors.groups) {
    doors_.doors.insert(doors_.doors.end(), group.begin(), group.end());
    doors_.group_ends.push_back(static_cast<std::uint32_t>(doors_.doors.size()));
  }
}

void Flattener::add(const BakedCell& cell, std::uint32_t node) {
  if (cell.leaf()) {
    octree_.nodes[node] = kOctreeLeaf | static_cast<std::uint32_t>(octree_.leaves.size());
    addLeaf(cell);
    return;
  }
  const std::uint32_t first = divide(node);
  for (std::uint32_t i = 0; i < 8; ++i) {
    add(cell.children[i], first + i);
  }
}

std::uint32_t Flattener::divide(std::uint32_t node) {
  const auto first = static_cast<std::uint32_t>(octree_.nodes.size());
  octree_.nodes[node] = first;
  octree_.nodes.resize(first + 8);
  return first;
}

void Flattener::finish() {
  if (std::ranges::all_of(octree_.viewers, [](const ViewerBounds& v) { return v == ViewerBounds{}; })) {
    octree_.viewers.clear();
  }
}

void Flattener::addLeaf(const BakedCell& cell) {
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
std::uint32_t Flattener::setOf(const Runs& seen, const DoorRuns& doors) {
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

std::uint32_t Flattener::numberOf(const Runs& runs, std::span<const DoorSet> hidden) {
  nodes_.clear();
  appendNodes(scene_.boxes.view(), runs, nodes_);
  const std::uint64_t hash = checksumOf(std::as_bytes(std::span(nodes_)));
  const std::uint32_t set = index_.findOrAdd(hash, [&](std::uint32_t known) {
    return std::ranges::equal(doors_.view().hiddenOf(known), hidden) && sets_.same(known, nodes_);
  });
  if (set == sets_.count()) {
    sets_.add(nodes_);
    if (!doors_.doors.empty()) {
      doors_.hidden.insert(doors_.hidden.end(), hidden.begin(), hidden.end());
      doors_.hidden_ends.push_back(static_cast<std::uint32_t>(doors_.hidden.size()));
    }
  }
  return set;
}

std::uint32_t Flattener::planeOf(const CellPlane& plane) {
  const std::array<double, 5> key{plane.normal.x, plane.normal.y, plane.normal.z, plane.front, plane.back};
  const auto [place, is_new] = planes_.try_emplace(key, static_cast<std::uint32_t>(octree_.planes.size()));
  if (is_new) {
    octree_.planes.push_back(plane);
  }
  return place->second;
}

void flatten(const BakedCell& root, const BakeScene& scene, BakedVisibility& baked) {
  KeptSets sets(baked.sets);
  Flattener flattener(scene, baked.octree, baked.doors, sets);
  flattener.add(root, 0);
  flattener.finish();
}

}  // namespace sightline::pvs
