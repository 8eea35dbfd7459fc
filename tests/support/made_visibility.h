#pragma once

// Synthetic baked data for tests, benchmarks and fuzzing: valid, seeded, of any size, and not about any real
// scene.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "sightline/pvs/format/baked_visibility.h"

namespace sightline::made {

struct Visibility {
  std::uint32_t seed = 1;
  std::uint32_t objects = 40;
  std::uint32_t leaves = 60;  // minimum number of leaves of the octree
  std::uint32_t depth = 4;    // maximum depth of the octree
  std::uint32_t sets = 30;
  std::uint32_t set_nodes = 6;  // approximate number of nodes per set
  // One cell in this many has a plane; 0: none.
  std::uint32_t plane_every = 3;
  // One cell in this many expects viewers in a part of it; 0: none.
  std::uint32_t partly_every = 0;
  std::vector<std::size_t> database_bytes{300, 0};
};

class Random {
 public:
  explicit Random(std::uint32_t seed) : engine_(seed) {}
  std::uint32_t operator()() { return static_cast<std::uint32_t>(engine_()); }

 private:
  std::mt19937 engine_;
};

inline double number(Random& random, double from, double to) {
  return from + (to - from) * (static_cast<double>(random()) / 4294967295.0);
}

inline Vec3d point(Random& random, const Vec3d& min, const Vec3d& max) {
  const double x = number(random, min.x, max.x);
  const double y = number(random, min.y, max.y);
  const double z = number(random, min.z, max.z);
  return {x, y, z};
}

// Appends a node with `count` objects and everything below it.
inline void appendNode(BoxTree& tree, std::uint32_t count, Random& random) {
  const auto node = static_cast<std::uint32_t>(tree.nodes.size());
  const auto first_object = static_cast<std::uint32_t>(tree.objects.size());
  tree.nodes.emplace_back();
  Box bounds;
  if (count == 1) {
    tree.objects.emplace_back(first_object);
    const Vec3f corner(point(random, {-100, -10, -100}, {100, 10, 100}));
    bounds = {corner, corner + Vec3f(point(random, {}, {5, 5, 5}))};
  }
  for (std::uint32_t rest = count; count > 1 && rest > 0;) {
    const std::uint32_t share = std::min(rest, std::max(1u, count / (2 + random() % 6)));
    const std::size_t child = tree.nodes.size();
    appendNode(tree, share, random);
    bounds.extend(tree.nodes[child].bounds);
    rest -= share;
  }
  tree.nodes[node] = {bounds, static_cast<std::uint32_t>(tree.nodes.size()), first_object, count, count * 12};
}

inline BoxTree boxTree(std::uint32_t objects, Random& random) {
  BoxTree tree;
  appendNode(tree, objects, random);
  for (std::size_t i = tree.objects.size(); i > 1; --i) {
    std::swap(tree.objects[i - 1], tree.objects[random() % i]);
  }
  return tree;
}

// Adds nodes to the set until it has `count`, or no more are found that are neither below nor above another.
inline void fillSet(std::set<std::uint32_t>& set, std::size_t count, const BoxTree& tree, Random& random) {
  for (int tries = 0; tries < 1000 && set.size() < count;) {
    // Some nodes that are close to each other.
    const auto around = static_cast<std::uint32_t>(random() % tree.nodes.size());
    for (std::uint32_t i = 0; i < 10 && set.size() < count; ++i, ++tries) {
      const auto node = static_cast<std::uint32_t>((around + random() % 60) % tree.nodes.size());
      const auto next = set.lower_bound(node);
      const bool above = next != set.end() && *next < tree.nodes[node].end;
      const bool below = next != set.begin() && tree.nodes[*std::prev(next)].end > node;
      if (!above && !below) {
        set.insert(node);
      }
    }
  }
}

// Each set is similar to the one before, except every 64th. The second one is empty.
inline NodeSets nodeSets(const Visibility& settings, const BoxTree& tree, Random& random) {
  NodeSets sets;
  std::set<std::uint32_t> set;
  for (std::uint32_t i = 0; i < settings.sets; ++i) {
    for (std::size_t drop = i % 64 == 0 ? set.size() : set.size() / 7 + 1; drop > 0 && !set.empty(); --drop) {
      const auto at = set.lower_bound(static_cast<std::uint32_t>(random() % tree.nodes.size()));
      set.erase(at == set.end() ? set.begin() : at);
    }
    fillSet(set, settings.set_nodes, tree, random);
    if (i != 1) {
      sets.nodes.insert(sets.nodes.end(), set.begin(), set.end());
    }
    sets.first.push_back(sets.nodes.size());
  }
  return sets;
}

// Divides random cells.
inline void divideCells(VisibilityOctree& octree, const Visibility& settings, Random& random) {
  struct Cell {
    std::uint32_t node, depth;
  };
  std::vector<Cell> cells{{0, 0}};
  octree.nodes = {kOctreeLeaf};
  for (int tries = 0; tries < 1'000'000 && cells.size() < settings.leaves; ++tries) {
    const std::size_t which = random() % cells.size();
    const Cell cell = cells[which];
    if (cell.depth == settings.depth) {
      continue;
    }
    const auto first = static_cast<std::uint32_t>(octree.nodes.size());
    octree.nodes[cell.node] = first;
    octree.nodes.resize(octree.nodes.size() + 8, kOctreeLeaf);
    cells[which] = {first, cell.depth + 1};
    for (std::uint32_t i = 1; i < 8; ++i) {
      cells.push_back({first + i, cell.depth + 1});
    }
  }
}

// Numbers the leaves below a node depth first, and sets their depths.
inline void numberLeaves(VisibilityOctree& octree, std::uint32_t node, std::uint32_t depth) {
  if ((octree.nodes[node] & kOctreeLeaf) != 0) {
    octree.nodes[node] = kOctreeLeaf | static_cast<std::uint32_t>(octree.leaves.size());
    octree.leaves.emplace_back();
    octree.depths.push_back(static_cast<std::uint8_t>(depth));
    octree.reasons.push_back(static_cast<std::uint8_t>(octree.leaves.size() % kStopReasons));
    return;
  }
  for (std::uint32_t i = 0; i < 8; ++i) {
    numberLeaves(octree, octree.nodes[node] + i, depth + 1);
  }
}

inline ViewerBounds viewerBounds(Random& random) {
  ViewerBounds viewers;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::uint32_t a = random() % 256, b = random() % 256;
    viewers.first[axis] = static_cast<std::uint8_t>(std::min(a, b));
    viewers.last[axis] = static_cast<std::uint8_t>(std::max(a, b));
  }
  return viewers;
}

inline VisibilityOctree octree(const Visibility& settings, Random& random) {
  VisibilityOctree octree;
  octree.min = {-101.5, -12.25, -99.0};
  octree.max = {103.125, 17.5, 110.0};
  divideCells(octree, settings, random);
  numberLeaves(octree, 0, 0);
  for (std::size_t i = 0; i < octree.leaves.size(); ++i) {
    const auto set = static_cast<std::uint32_t>(i * settings.sets / octree.leaves.size());
    octree.leaves[i].set = set;
    if (settings.plane_every != 0 && i % settings.plane_every == 0) {
      octree.leaves[i].plane = static_cast<std::uint32_t>(octree.planes.size());
      octree.leaves[i].front_set = (set + 1) % settings.sets;
      octree.leaves[i].back_set = (set + 2) % settings.sets;
      const Vec3d normal = normalized(point(random, {-1, -1, -1}, {1, 1, 0.99}) + Vec3d(0, 0, 0.005));
      const double front = dot(normal, point(random, octree.min, octree.max));
      octree.planes.push_back({normal, front, front - number(random, 0.0, 10.0)});
    }
    if (settings.partly_every != 0) {
      octree.viewers.push_back(i % settings.partly_every == 0 ? viewerBounds(random) : ViewerBounds{});
    }
  }
  return octree;
}

inline BakedVisibility visibility(const Visibility& settings = {}) {
  Random random(settings.seed);
  BakedVisibility baked;
  baked.boxes = boxTree(settings.objects, random);
  baked.octree = octree(settings, random);
  baked.sets = nodeSets(settings, baked.boxes, random);
  baked.scene = {0x123456789abcdef0u + settings.seed, settings.objects, settings.objects * 12};
  baked.record = {0.25, 1000, settings.depth, R"({"made":true})"};
  for (std::size_t i = 0; i < settings.database_bytes.size(); ++i) {
    DatabaseBlob blob{"database-" + std::to_string(i), random(), {}};
    blob.bytes.resize(settings.database_bytes[i]);
    for (std::size_t byte = 0; byte < blob.bytes.size(); ++byte) {
      blob.bytes[byte] = static_cast<std::byte>(byte / 7 + random() % 4);
    }
    baked.databases.push_back(std::move(blob));
  }
  return baked;
}

// Adds groups of doors. Each hides a random set of most sets.
inline void addDoors(BakedVisibility& baked, const std::vector<std::vector<ObjectId>>& groups,
                     Random& random) {
  BakedDoors& doors = baked.doors;
  for (const std::vector<ObjectId>& group : groups) {
    doors.doors.insert(doors.doors.end(), group.begin(), group.end());
    doors.group_ends.push_back(static_cast<std::uint32_t>(doors.doors.size()));
  }
  for (std::uint32_t set = 0; set < baked.sets.count(); ++set) {
    for (std::uint32_t group = 0; group < groups.size(); ++group) {
      if (random() % 4 != 0) {
        doors.hidden.push_back({group, random() % baked.sets.count()});
      }
    }
    doors.hidden_ends.push_back(static_cast<std::uint32_t>(doors.hidden.size()));
  }
}

}  // namespace sightline::made
