// A few objects without a usable box must not cost the culling of all others.

#include <gtest/gtest.h>

#include <vector>

#include "tests/culling/demo_frames.h"
#include "tests/support/any_culler.h"

namespace sightline {
namespace {

TEST(Culler, OneBadBoxDoesNotStopTheCullingOfTheOthers) {
  // A wall, two boxes behind it, and an object with an empty box.
  const std::vector<Box> bounds{
      {{-4, -4, -5}, {4, 4, -5}}, {{-1, -1, -12}, {1, 1, -10}}, Box{}, {{-1, -1, -12}, {1, 1, -11}}};
  const std::vector<Vec3f> corners{{-4, -4, -5}, {4, -4, -5}, {4, 4, -5}, {-4, 4, -5}};
  const OccluderPolygon wall[] = {{corners, false, ObjectId(0u)}};
  const OccluderSet occluders = makeOccluders(wall);
  View view;
  setOrientation(view, {0, 0, -1}, {0, 1, 0});
  const std::vector<ObjectId> expected{ObjectId(0u), ObjectId(2u)};
  for (const HierarchyKind kind : demo_frames::kKinds) {
    const Hierarchy hierarchy = buildHierarchy(bounds, {}, {.kind = kind, .max_leaf_objects = 1});
    for (const auto& [name, settings, stands_for_method] : demo_frames::kStructures) {
      AnyCuller culler(hierarchy, bounds, occluders, settings);
      for (int frame = 0; frame < 3; ++frame) {
        culler.cull(view);
        EXPECT_EQ(std::vector<ObjectId>(culler.visible().begin(), culler.visible().end()), expected)
            << "frame " << frame << " " << demo_frames::nameOf(kind) << " " << name;
      }
    }
  }
}

}  // namespace
}  // namespace sightline
