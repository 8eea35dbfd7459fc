#include "sightline/render/plan_view.h"

#include "tests/render/test_scene.h"

namespace sightline {
namespace {

class PlanViewTest : public RenderTest {
 protected:
  // Three floor tiles left, before and right of the eye; a storey above them.
  PlanViewTest() {
    maker.box({-6, -1, -1}, {-4, 0, 1}, kRed);
    maker.box({-1, -1, -6}, {1, 0, -4}, kRed);
    maker.box({4, -1, -1}, {6, 0, 1}, kRed);
    maker.box({-9, 5, -9}, {9, 6, 9}, kGreen);
    plan.camera = testView({0.0, 1.0, 0.0});
    plan.radius = 10.0;
    plan.size_px = 200;
    plan.cut_height = 3.0;
    plan.states = tile_states;
  }

  // The pixel at this place, in metres right of and before the eye.
  static Pixel at(const Image& image, double right, double before) {
    return pixelOf(image, static_cast<std::uint32_t>(100 + 10 * right),
                   static_cast<std::uint32_t>(100 - 10 * before));
  }
  static bool hasHueOf(const Pixel& p, const PlanColor& c) {
    return std::abs(p.r - c[0]) < 24 && std::abs(p.g - c[1]) < 24 && std::abs(p.b - c[2]) < 24;
  }

  SceneMaker maker;
  std::array<ObjectState, 4> tile_states{ObjectState::kOutside, ObjectState::kKept, ObjectState::kHidden,
                                         ObjectState::kHidden};
  PlanView plan;
};

TEST_F(PlanViewTest, ShowsEachObjectInTheColourOfItsState) {
  Renderer renderer = rendererOf(maker.scene);
  const Image image = renderer.drawPlan(plan);
  ASSERT_EQ(image.width, 200u);
  ASSERT_EQ(image.height, 200u);
  EXPECT_TRUE(hasHueOf(at(image, -5, 0), kPlanOutside));
  EXPECT_TRUE(hasHueOf(at(image, 0, 5), kPlanKept));
  EXPECT_TRUE(hasHueOf(at(image, 5, 0), kPlanHidden));
  EXPECT_TRUE(hasHueOf(at(image, -5, -5), kPlanBackground));
  EXPECT_TRUE(hasHueOf(at(image, 0, 0), kPlanCamera));
}

TEST_F(PlanViewTest, WithoutACutTheStoreyAboveIsOnTop) {
  Renderer renderer = rendererOf(maker.scene);
  plan.cut_height = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(hasHueOf(at(renderer.drawPlan(plan), -5, 0), kPlanHidden));
}

TEST_F(PlanViewTest, WhatIsLargerThanHalfThePictureIsPale) {
  Renderer renderer = rendererOf(maker.scene);
  plan.cut_height = std::numeric_limits<double>::infinity();
  plan.objects = maker.scene.objects;
  plan.radius = 16.0;
  EXPECT_TRUE(hasHueOf(at(renderer.drawPlan(plan), -5, 0), kPlanHidden)) << "18 metres of 32, squared";
  plan.radius = 10.0;
  EXPECT_TRUE(hasHueOf(at(renderer.drawPlan(plan), -5, 0), paleOf(kPlanHidden)));
}

TEST_F(PlanViewTest, OccludersAreOutlinedOnTop) {
  OccluderSet set;
  set.vertices = {{-3, 0, -3}, {3, 0, -3}, {3, 2, -3}, {-3, 2, -3}};
  set.occluders.emplace_back().vertex_count = 4;
  const std::array<OccluderId, 1> used{OccluderId(0u)};
  plan.occluders = &set;
  plan.occluders_used = used;
  Renderer renderer = rendererOf(maker.scene);
  EXPECT_TRUE(hasHueOf(at(renderer.drawPlan(plan), 0, 3), kPlanOccluder));
}

TEST_F(PlanViewTest, WallsSeenEdgeOnShow) {
  maker.wall(-8.0, 0.5, kRed);
  std::vector<ObjectState> states(tile_states.begin(), tile_states.end());
  states.push_back(ObjectState::kKept);
  plan.states = states;
  Renderer renderer = rendererOf(maker.scene);
  EXPECT_TRUE(isGreen([&] {
    Pixel p = at(renderer.drawPlan(plan), 0, 8);
    p.r /= 2, p.b /= 2;  // the state's green is a pale one
    return p;
  }()));
}

TEST_F(PlanViewTest, IsTheSameTwiceAndLeavesLaterPicturesAlone) {
  Renderer renderer = rendererOf(maker.scene);
  const View view = testView({0.0, 2.0, 20.0});
  const Image before = renderer.draw(view, allOf(maker.scene));
  const Image first = renderer.drawPlan(plan);
  EXPECT_EQ(first, renderer.drawPlan(plan));
  EXPECT_EQ(before, renderer.draw(view, allOf(maker.scene)));
}

}  // namespace
}  // namespace sightline
