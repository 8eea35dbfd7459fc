// Orthographic views of the occlusion tree, with distances of all sizes.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "sightline/occlusion/occlusion_tree.h"
#include "tests/occlusion/small_scenes.h"

namespace sightline {
namespace {

using namespace test;

View parallelView(double height) {
  View view = viewFrom({0, 0, 0}, {0, 0, -1});
  view.orthographic = true;
  view.ortho_height = height;
  view.z_near = 0.0;
  view.z_far = 1e9;
  return view;
}

// The edges of a small wall move inwards by a fraction of its own size, even with large objects in the view.
TEST(OrthographicTree, AThingThatShowsPastASmallWallIsKeptWhateverElseThereIs) {
  for (const double scale : {30.0, 1e3, 1e6}) {
    const auto far_away = static_cast<float>(-scale);
    const std::vector<OraclePolygon> walls{
        wall(-0.5f, 0.0f, -0.5f, 0.5f, -1.0f), wall(-0.5f, 0.5f, 0.3f, 0.6f, -0.5f),
        wall(far_away, 0.5f * far_away, far_away, 0.5f * far_away, far_away)};
    const OccluderSet set = setOf(walls);
    const std::vector<OccluderId> chosen = all(set);
    for (const OcclusionTreeVariant variant : kTreeVariants) {
      OcclusionTree tree({.variant = variant});
      tree.build(parallelView(4.0 * scale), set, chosen);
      for (const double gap : {1e-11, 1e-10, 2.4e-7, 1e-3}) {
        const Box box{{-0.2f, -0.2f, -3.0f}, {static_cast<float>(gap), 0.5f, -2.0f}};
        EXPECT_NE(tree.classify(box), Visibility::kHidden) << scale << " m, gap of " << gap << " m";
      }
      EXPECT_EQ(tree.classify({{-0.3f, -0.3f, -3.0f}, {-0.1f, 0.2f, -2.0f}}), Visibility::kHidden) << scale;
    }
  }
}

TEST(OrthographicTree, AThingBetweenTheEyesPlaneAndASlantedOccluderIsKeptWithAForwardOfSinglePrecision) {
  const std::vector<OraclePolygon> walls{
      {{{0.5f, -20, -0.5f}, {40, -20, -40}, {40, 20, -40}, {0.5f, 20, -0.5f}}, true}};
  const OccluderSet set = setOf(walls);
  const std::vector<OccluderId> chosen = all(set);
  View view = parallelView(38.0);
  view.eye = {20, 0, 0};
  view.aspect = 1.0;
  view.forward = {0, 0, -(1.0 - 0x1p-24)};
  for (const OcclusionTreeVariant variant : kTreeVariants) {
    OcclusionTree tree({.variant = variant});
    tree.build(view, set, chosen);
    EXPECT_NE(tree.classify({{-3, -1, -1e-8f}, {30, 1, -0.5e-8f}}), Visibility::kHidden);
  }
}

}  // namespace
}  // namespace sightline
