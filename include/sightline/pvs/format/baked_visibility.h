#pragma once

// The contents of a .sight file in memory.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sightline/hierarchy/box_tree.h"
#include "sightline/pvs/format/doors.h"
#include "sightline/pvs/format/scene_id.h"
#include "sightline/pvs/format/visibility_octree.h"

namespace sightline {

// How a file was made.
struct BakeRecord {
  double near_distance = 0.0;  // metres, BakeSettings::near_distance
  std::uint64_t triangle_budget = 0;
  std::uint32_t max_depth = 0;
  // The caller's text, SightExtras::settings. The tool stores its settings here, as one line of JSON.
  std::string settings{};

  friend bool operator==(const BakeRecord&, const BakeRecord&) = default;
};

// Sets of nodes of a BoxTree, each distinct set once. Nodes are ascending, and none is below another.
struct NodeSets {
  // The index of each set's first node in nodes; one more than there are sets.
  std::vector<std::uint64_t> first{0};
  std::vector<std::uint32_t> nodes{};

  std::uint32_t count() const { return static_cast<std::uint32_t>(first.size() - 1); }
  std::span<const std::uint32_t> operator[](std::uint32_t set) const {
    return std::span(nodes).subspan(first[set], first[set + 1] - first[set]);
  }
};

// The bytes of OccluderDatabase::save or ViewpointDatabase::save.
struct DatabaseBlob {
  std::string name{};         // "area-angle", "detail", "minimum-sets", "first-hit", "projected-size"
  std::uint64_t occluders{};  // hash of the OccluderSet that its ids refer to
  std::vector<std::byte> bytes{};
};

struct BakedVisibility {
  SceneId scene{};
  BakeRecord record{};
  BoxTree boxes{};
  VisibilityOctree octree{};
  NodeSets sets{};  // the sets that the octree's leaves, and doors, refer to
  BakedDoors doors{};
  std::vector<DatabaseBlob> databases{};
};

}  // namespace sightline
