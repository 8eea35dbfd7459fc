#pragma once

// What a baked file holds, so that tests can write it with changes.

#include <gtest/gtest.h>

#include "sightline/pvs/format/baked_visibility.h"
#include "sightline/pvs/query/sight_file.h"

namespace sightline::tool_test {

// All that an opened file holds, but for its databases.
inline BakedVisibility contentsOf(const SightFile& file) {
  BakedVisibility baked;
  baked.scene = file.scene();
  baked.record = file.record();
  baked.boxes.nodes.assign(file.boxes().nodes.begin(), file.boxes().nodes.end());
  baked.boxes.objects.assign(file.boxes().objects.begin(), file.boxes().objects.end());
  const OctreeView octree = file.octree();
  baked.octree.min = octree.min, baked.octree.max = octree.max;
  baked.octree.nodes.assign(octree.nodes.begin(), octree.nodes.end());
  baked.octree.leaves.assign(octree.leaves.begin(), octree.leaves.end());
  baked.octree.depths.assign(octree.depths.begin(), octree.depths.end());
  baked.octree.reasons.assign(octree.reasons.begin(), octree.reasons.end());
  baked.octree.planes.assign(octree.planes.begin(), octree.planes.end());
  baked.octree.viewers.assign(octree.viewers.begin(), octree.viewers.end());
  const Status whole = file.forEachSet([&](std::uint32_t, std::span<const std::uint32_t> nodes) {
    baked.sets.nodes.insert(baked.sets.nodes.end(), nodes.begin(), nodes.end());
    baked.sets.first.push_back(baked.sets.nodes.size());
  });
  EXPECT_TRUE(whole);
  const DoorsView doors = file.doors();
  baked.doors = {{doors.doors.begin(), doors.doors.end()},
                 {doors.group_ends.begin(), doors.group_ends.end()},
                 {doors.hidden.begin(), doors.hidden.end()},
                 {doors.hidden_ends.begin(), doors.hidden_ends.end()}};
  return baked;
}

}  // namespace sightline::tool_test
