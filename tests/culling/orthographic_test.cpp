// Every structure hides in orthographic views too; exactness_test.cpp judges what it hides there.

#include <gtest/gtest.h>

#include <vector>

#include "tests/culling/demo_frames.h"
#include "tests/occlusion/small_scenes.h"

namespace sightline {
namespace {

using namespace demo_frames;

TEST(OrthographicCulling, HidesABoxBehindAWall) {
  const std::vector<Box> bounds{
      {{-4, -4, -5}, {4, 4, -5}}, {{-1, -1, -12}, {1, 1, -10}}, {{3, 3, -12}, {5, 5, -10}}};
  const OccluderSet occluders = test::setOf(std::vector{test::wall(-4, 4, -4, 4, -5)});
  View view;
  setOrientation(view, {0, 0, -1}, {0, 1, 0});
  view.orthographic = true;
  view.ortho_height = 20.0;
  const std::vector<ObjectId> expected{ObjectId(0u), ObjectId(2u)};
  for (const HierarchyKind kind : kKinds) {
    const Hierarchy hierarchy = buildHierarchy(bounds, {}, {.kind = kind, .max_leaf_objects = 1});
    for (const auto& [name, settings, stands_for_method] : kStructures) {
      AnyCuller culler(hierarchy, bounds, occluders, settings);
      culler.cull(view);
      EXPECT_EQ(std::vector<ObjectId>(culler.visible().begin(), culler.visible().end()), expected) << name;
    }
  }
}

}  // namespace
}  // namespace sightline
