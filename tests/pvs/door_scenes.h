#pragma once

// Rooms with doors, and what a baked file says of them while some doors are closed.

#include <algorithm>
#include <cstdint>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "tests/pvs/bake_scenes.h"

namespace sightline::test {

struct DoorScene {
  Scene scene;
  std::vector<ObjectId> doors;
};

// Builds closed rooms of blocks in a row along x. Each room is 6 m long, 6 m wide and 3 m high.
class RoomBuilder {
 public:
  static constexpr float kLong = 6.0f, kWide = 6.0f, kHigh = 3.0f, kThick = 0.25f;

  explicit RoomBuilder(int rooms) {
    const float end = kLong * static_cast<float>(rooms);
    solids_.push_back(block({-kThick, -kThick, -kThick}, {end + kThick, 0, kWide + kThick}));
    solids_.push_back(block({-kThick, kHigh, -kThick}, {end + kThick, kHigh + kThick, kWide + kThick}));
    solids_.push_back(block({-kThick, 0, -kThick}, {end + kThick, kHigh, 0}));
    solids_.push_back(block({-kThick, 0, kWide}, {end + kThick, kHigh, kWide + kThick}));
    solids_.push_back(block({-kThick, 0, 0}, {0, kHigh, kWide}));
    solids_.push_back(block({end, 0, 0}, {end + kThick, kHigh, kWide}));
  }

  // Adds the wall at the end of a room, with doorways that begin at these places along z, 1 m wide and 2 m
  // high. A door fills each doorway.
  void addWall(int room, const std::vector<float>& doorways) {
    const float x = kLong * static_cast<float>(room + 1);
    float from = 0.0f;
    for (const float z : doorways) {
      addWallPart(x, {from, 0}, {z, kHigh});
      addWallPart(x, {z, 2}, {z + 1, kHigh});
      doors_.push_back(ObjectId(solids_.size()));
      solids_.push_back(block({x, 0, z}, {x + kThick, 2, z + 1}));
      from = z + 1;
    }
    addWallPart(x, {from, 0}, {kWide, kHigh});
  }

  // Adds a door that is all of the wall at the end of a room.
  void addShutter(int room) {
    const float x = kLong * static_cast<float>(room + 1);
    doors_.push_back(ObjectId(solids_.size()));
    solids_.push_back(block({x, 0, 0}, {x + kThick, kHigh, kWide}));
  }

  // Adds a crate on the floor of a room; the corner is given from the room's.
  ObjectId addCrate(int room, float x, float z) {
    const Vec3f at(kLong * static_cast<float>(room) + x, 0, z);
    solids_.push_back(block(at, at + Vec3f(0.5f, 0.75f, 0.5f)));
    return ObjectId(solids_.size() - 1);
  }

  DoorScene build() const { return {sceneOf(solids_), doors_}; }

 private:
  // From and to: z and y.
  void addWallPart(float x, const std::pair<float, float>& from, const std::pair<float, float>& to) {
    if (from.first < to.first) {
      solids_.push_back(block({x, from.second, from.first}, {x + kThick, to.second, to.first}));
    }
  }

  std::vector<Solid> solids_;
  std::vector<ObjectId> doors_;
};

// Each door as a group by itself.
inline std::vector<std::vector<ObjectId>> alone(const std::vector<ObjectId>& doors) {
  std::vector<std::vector<ObjectId>> groups;
  for (const ObjectId door : doors) {
    groups.push_back({door});
  }
  return groups;
}

// All sets of closed doors, each ascending.
inline std::vector<std::vector<ObjectId>> combinationsOf(const std::vector<ObjectId>& doors) {
  std::vector<std::vector<ObjectId>> all;
  for (std::uint32_t bits = 0; bits < 1u << doors.size(); ++bits) {
    all.emplace_back();
    for (std::size_t i = 0; i < doors.size(); ++i) {
      if ((bits >> i & 1) != 0) {
        all.back().push_back(doors[i]);
      }
    }
  }
  return all;
}

// The sets of closed doors that a baked file says something of by itself: none, and each group, all doors
// last. For any other one it says what the groups within it hide. Whatever a ray reaches although one of them
// hides it, the same ray reaches while only that group is closed.
inline std::vector<std::vector<ObjectId>> closedSetsOf(const BakedVisibility& baked) {
  std::vector<std::vector<ObjectId>> all(1);
  const DoorsView doors = baked.doors.view();
  for (std::uint32_t group = 0; group < doors.groupCount(); ++group) {
    const std::span<const ObjectId> closed = doors.doorsOf(group);
    all.emplace_back(closed.begin(), closed.end());
  }
  return all;
}

// The scene in which these doors are closed. The others hide nothing, as if they were not there.
inline Scene withDoors(const DoorScene& rooms, const std::vector<ObjectId>& closed) {
  Scene scene = rooms.scene;
  for (const ObjectId door : rooms.doors) {
    if (std::find(closed.begin(), closed.end(), door) == closed.end()) {
      scene.objects[door.value].mark = OccluderMark::kNever;
    }
  }
  return scene;
}

// Indexed by ObjectId: what a set keeps while these doors are closed, ascending. Works with objects one by
// one, as SetQuery does not.
inline std::vector<bool> membersWith(const BakedVisibility& baked, std::uint32_t set,
                                     const std::vector<ObjectId>& closed) {
  std::vector<bool> members = membersOf(baked, set);
  const DoorsView doors = baked.doors.view();
  for (const DoorSet& door : doors.hiddenOf(set)) {
    const auto isOne = [&](ObjectId one) { return std::count(closed.begin(), closed.end(), one) > 0; };
    const std::span<const ObjectId> group = doors.doorsOf(door.group);
    if (std::all_of(group.begin(), group.end(), isOne)) {
      const std::vector<bool> hidden = membersOf(baked, door.hidden);
      for (std::size_t i = 0; i < members.size(); ++i) {
        members[i] = members[i] && !hidden[i];
      }
    }
  }
  return members;
}

// The file as one without doors, of which each set is what is left while these doors are closed.
inline BakedVisibility leftWith(const BakedVisibility& baked, const std::vector<ObjectId>& closed) {
  BakedVisibility left = baked;
  left.sets = {};
  left.doors = {};
  const BoxTreeView boxes = baked.boxes.view();
  for (std::uint32_t set = 0; set < baked.sets.count(); ++set) {
    const std::vector<bool> members = membersWith(baked, set, closed);
    for (std::uint32_t node = 0; node < boxes.nodes.size(); ++node) {
      if (boxes.leaf(node) && members[boxes.objectsBelow(node)[0].value]) {
        left.sets.nodes.push_back(node);
      }
    }
    left.sets.first.push_back(left.sets.nodes.size());
  }
  return left;
}

// Rooms in a row with one or two doors in each wall at random places, and crates.
inline DoorScene randomRooms(std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto half = [&](int low, int high) {
    return 0.5f * static_cast<float>(std::uniform_int_distribution<int>(low, high)(random));
  };
  constexpr int kRooms = 3;
  RoomBuilder builder(kRooms);
  for (int room = 0; room + 1 < kRooms; ++room) {
    const float first = half(1, 4);
    builder.addWall(room, random() % 2 != 0 ? std::vector<float>{first}
                                            : std::vector<float>{first, first + 1.0f + half(1, 3)});
  }
  for (int room = 0; room < kRooms; ++room) {
    for (int i = 0; i < 5; ++i) {
      builder.addCrate(room, half(1, 10), half(1, 10));
    }
  }
  return builder.build();
}

}  // namespace sightline::test
