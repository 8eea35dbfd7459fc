// Instances that a baked scene knows as its objects.

#include <bit>
#include <cmath>

#include "sightline/world/world.h"
#include "src/base/hash_slots.h"
#include "src/world/world_data.h"

namespace sightline {

using namespace world;

namespace world {
namespace {

// Whether the box of an instance, in the space of a baked scene, is the baked one, up to what rounding may
// have made of it. Each axis is compared by the terms of its own coordinate, which do not depend on the
// world.
bool standsWhereBaked(const MeshExtent& extent, const Mat4& baked_from_mesh, const Box& baked) {
  constexpr double kRounding = 0x1p-20;
  for (int row = 0; row < 3; ++row) {
    double at = baked_from_mesh(row, 3), reach = 0.0, terms = std::abs(at);
    for (int axis = 0; axis < 3; ++axis) {
      const double factor = baked_from_mesh(row, axis);
      at += factor * extent.middle[axis];
      reach += std::abs(factor) * extent.half[axis];
      terms += std::abs(factor) * extent.farthest[axis];
    }
    const auto near = [&](double now, double then) { return std::abs(now - then) <= kRounding * terms; };
    if (!near(at - reach, baked.min[row]) || !near(at + reach, baked.max[row])) {  // so if one is not finite
      return false;
    }
  }
  return true;
}

}  // namespace

std::uint64_t hashOfBoxes(const BoxTreeView& boxes) {
  std::uint64_t sum = boxes.objects.size();
  for (std::uint32_t node = 0; node < boxes.nodes.size(); ++node) {
    if (!boxes.leaf(node)) {
      continue;
    }
    const Box& box = boxes.nodes[node].bounds;
    for (const ObjectId object : boxes.objectsBelow(node)) {
      std::uint64_t hash = object.value;
      for (int axis = 0; axis < 3; ++axis) {
        const std::uint64_t min = std::bit_cast<std::uint32_t>(box.min[axis]),
                            max = std::bit_cast<std::uint32_t>(box.max[axis]);
        hash = base::mixBits(hash ^ (min << 32 | max));
      }
      sum += hash;
    }
  }
  return sum;
}

// Makes an instance a tombstone of the sets that it belongs to.
void WorldData::leaveSets(std::uint32_t id) {
  if (!instances[id].baked) {
    return;
  }
  const InstanceExtra& own = extras[id];
  BakedObjects& left = sets[own.sets];
  left.instances[own.object] = InstanceId();
  left.tombstones.emplace_back(own.object);
  left.version = ++version;
  instances[id].baked = false;
}

}  // namespace world

SetsId World::addSets(std::span<const InstanceId> objects, BoxTreeView boxes, const Vec3d& baked_origin,
                      std::span<const ObjectId> doors) {
  WorldData& own = *data_;
  // A number is never used again: a culler may not have been told that its sets were removed.
  const auto number = static_cast<std::uint32_t>(own.sets.size());
  own.sets.emplace_back();
  own.sets[number] = {
      .there = true, .boxes = hashOfBoxes(boxes), .origin = baked_origin, .groups = 0xffffffffu};
  own.sets[number].instances.resize(boxes.objects.size());
  std::vector<bool> is_door(boxes.objects.size(), false);
  for (const ObjectId door : doors) {
    if (door.value < is_door.size()) {
      is_door[door.value] = true;
    }
  }
  for (std::uint32_t node = 0; node < boxes.nodes.size(); ++node) {
    if (!boxes.leaf(node)) {
      continue;
    }
    for (const ObjectId object : boxes.objectsBelow(node)) {
      if (is_door[object.value]) {
        continue;
      }
      const InstanceId id = object.value < objects.size() ? objects[object.value] : InstanceId();
      if (!has(id) || !own.mayBeBaked(id.value) ||
          !standsWhereBaked(own.meshes[own.instances[id.value].mesh].extent,
                            relativeTo(baked_origin, own.world_from_mesh[id.value]),
                            boxes.nodes[node].bounds)) {
        own.sets[number].tombstones.push_back(object);
        continue;
      }
      own.leaveSets(id.value);
      own.instances[id.value].baked = true;
      own.extras[id.value].sets = number;
      own.extras[id.value].object = object.value;
      own.sets[number].instances[object.value] = id;
      own.sets[number].groups &= own.instances[id.value].groups;
    }
  }
  own.sets[number].version = ++own.version;
  return SetsId(number);
}

void World::removeSets(SetsId sets) {
  WorldData& own = *data_;
  if (sets.value >= own.sets.size() || !own.sets[sets.value].there) {
    return;
  }
  for (const InstanceId id : own.sets[sets.value].instances) {
    if (id.valid()) {
      own.instances[id.value].baked = false;
    }
  }
  own.sets[sets.value] = {};
}

std::size_t World::tombstones(SetsId sets) const {
  return sets.value < data_->sets.size() ? data_->sets[sets.value].tombstones.size() : 0;
}

}  // namespace sightline
