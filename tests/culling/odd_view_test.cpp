// Unusual and invalid views that programs pass: scaled or mirrored axes, no near plane or no far plane, and
// numbers that make no view.

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "tests/culling/demo_frames.h"

namespace sightline {
namespace {

using namespace demo_frames;

using Objects = std::vector<ObjectId>;

constexpr double kOddNumber = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinite = std::numeric_limits<double>::infinity();

// A wall, a crate behind it, a crate beside it, a crate behind the viewer, and a tiny box right in front of
// the eye.
struct WallAndCrates {
  WallAndCrates() {
    const Vec3f corners[] = {{-4, -4, -10}, {4, -4, -10}, {4, 4, -10}, {-4, 4, -10}};
    const OccluderPolygon polygon{corners};
    occluders = makeOccluders({&polygon, 1});
    hierarchy = buildHierarchy(bounds, {});
    view.eye = {};
    setOrientation(view, {0, 0, -1}, {0, 1, 0});
    view.tan_half_fovy = 1.0;
    view.ortho_height = 20.0;
  }

  const std::vector<Box> bounds{Box{{-4, -4, -10}, {4, 4, -10}}, Box{{-1, -1, -21}, {1, 1, -19}},
                                Box{{8, -1, -15}, {10, 1, -13}}, Box{{-1, -1, 15}, {1, 1, 17}},
                                Box{{0, 0, -2e-9f}, {1e-9f, 1e-9f, -1e-9f}}};
  OccluderSet occluders;
  Hierarchy hierarchy;
  View view;
};

const Objects kSeen{ObjectId(0u), ObjectId(2u)};
const Objects kSeenFromNearDistanceZero{ObjectId(0u), ObjectId(2u), ObjectId(4u)};
const Objects kAll{ObjectId(0u), ObjectId(1u), ObjectId(2u), ObjectId(3u), ObjectId(4u)};

class OddViews : public ::testing::TestWithParam<bool> {  // orthographic?
 protected:
  OddViews() { scene_.view.orthographic = GetParam(); }

  // The second frame must give the same result despite the state that the first one left.
  void expectVisible(const View& view, const Objects& expected, const char* what) {
    for (const auto& [name, settings, stands_for_method] : kStructures) {
      AnyCuller culler(scene_.hierarchy, scene_.bounds, scene_.occluders, settings);
      for (int frame = 0; frame < 2; ++frame) {
        culler.cull(view);
        EXPECT_EQ(Objects(culler.visible().begin(), culler.visible().end()), expected)
            << what << ", " << name << ", frame " << frame;
        EXPECT_EQ(culler.stats().view_fault, nullptr);
      }
    }
  }

  WallAndCrates scene_;
};
INSTANTIATE_TEST_SUITE_P(, OddViews, ::testing::Bool(), [](const auto& projection) {
  return projection.param ? "Orthographic" : "Perspective";
});

TEST_P(OddViews, ScaledAndMirroredAxesAreTheSameView) {
  const View& view = scene_.view;
  expectVisible(view, kSeen, "as it should be");
  for (const double scale : {0.01, 0.7, 1.5, 3.0}) {
    View scaled = view;
    scaled.right = view.right * scale;
    scaled.up = view.up * (0.3 * scale);
    scaled.forward = view.forward * (2.0 * scale);
    expectVisible(scaled, kSeen, "scaled");
  }
  View mirrored = view;
  mirrored.right = -view.right;
  expectVisible(mirrored, kSeen, "mirrored");
}

TEST_P(OddViews, WithoutAFarPlaneTheSameIsHidden) {
  scene_.view.z_far = kInfinite;
  expectVisible(scene_.view, kSeen, "infinite far distance");
}

// From so far away, all boxes lie within the rounding of the eye's coordinates.
TEST_P(OddViews, FromAnyDistanceNothingInSightIsHidden) {
  scene_.view.z_far = kInfinite;
  for (const auto& [name, settings, stands_for_method] : kStructures) {
    AnyCuller culler(scene_.hierarchy, scene_.bounds, scene_.occluders, settings);
    for (const double distance :
         {1e5, 1e10, 1e20, 1e30, 1e39, 1e77, 1e140, 1e154, 1e160, 1e200, 1e300, 1.7e308}) {
      scene_.view.eye = {0, 0, distance};
      culler.cull(scene_.view);
      for (const ObjectId in_sight : {ObjectId(0u), ObjectId(2u), ObjectId(3u), ObjectId(4u)}) {
        EXPECT_TRUE(std::find(culler.visible().begin(), culler.visible().end(), in_sight) !=
                    culler.visible().end())
            << name << ", " << distance << " m, object " << in_sight.value;
      }
    }
  }
}

TEST_P(OddViews, WithoutANearPlaneTheSameIsHiddenAndWhatIsAtTheEyeIsKept) {
  scene_.view.z_near = 0.0;
  expectVisible(scene_.view, kSeenFromNearDistanceZero, "near distance 0");
  scene_.view.z_far = kInfinite;
  expectVisible(scene_.view, kSeenFromNearDistanceZero, "near distance 0, infinite far distance");
}

TEST_P(OddViews, KeepEverythingAndSayWhyWhereTheyAreNone) {
  std::vector<View> views;
  for (double View::*member : {&View::z_near, &View::z_far, &View::aspect,
                               GetParam() ? &View::ortho_height : &View::tan_half_fovy}) {
    for (const double bad : {-1.0, kOddNumber}) {
      views.push_back(scene_.view);
      views.back().*member = bad;
    }
  }
  views.push_back(scene_.view);
  views.back().z_near = 2000.0;  // beyond the far plane
  for (Vec3d View::*vector : {&View::eye, &View::right, &View::up, &View::forward}) {
    views.push_back(scene_.view);
    (views.back().*vector).x = kOddNumber;
  }
  views.push_back(scene_.view);
  views.back().forward = {};
  views.push_back(scene_.view);
  views.back().up = normalized(Vec3d(1, 1, 0));

  const std::vector<Box> dynamic{Box{{-1, -1, -12}, {1, 1, -11}}, Box{{-1, -1, 3}, {1, 1, 4}}};
  for (const auto& [name, settings, stands_for_method] : kStructures) {
    AnyCuller culler(scene_.hierarchy, scene_.bounds, scene_.occluders, settings);
    for (std::size_t v = 0; v < views.size(); ++v) {
      culler.cull(scene_.view, dynamic);
      EXPECT_EQ(Objects(culler.visible().begin(), culler.visible().end()), kSeen);
      EXPECT_EQ(culler.dynamicStates()[0], Visibility::kHidden);
      EXPECT_FALSE(culler.occludersUsed().empty());
      culler.cull(views[v], dynamic);
      EXPECT_EQ(Objects(culler.visible().begin(), culler.visible().end()), kAll) << name << ", view " << v;
      EXPECT_EQ(std::vector<Visibility>(culler.dynamicStates().begin(), culler.dynamicStates().end()),
                std::vector<Visibility>(2, Visibility::kVisible));
      ASSERT_NE(culler.stats().view_fault, nullptr);
      EXPECT_EQ(culler.stats().view_fault, validate(views[v]).error().message);
      EXPECT_TRUE(culler.occludersUsed().empty());
      EXPECT_EQ(culler.depthBuffer().width, 0u);
    }
  }
}

// For invalid views the structures themselves hide nothing.
TEST_P(OddViews, StructuresHideNothingWhereTheyAreNone) {
  View none = scene_.view;
  none.up = normalized(Vec3d(1, 1, 0));
  const std::vector<OccluderId> chosen{OccluderId(0u)};
  OcclusionTree tree;
  SupportingPlanes planes;
  OpacityMap opacity;
  DepthPyramid pyramid;
  const Box& crate = scene_.bounds[1];
  for (const View& view : {scene_.view, none, scene_.view}) {
    const bool good = validate(view).has_value();
    tree.build(view, scene_.occluders, chosen);
    planes.build(view, scene_.occluders, chosen);
    opacity.build(view, scene_.occluders, chosen);
    pyramid.build(view, scene_.occluders, chosen);
    EXPECT_EQ(tree.classify(crate) == Visibility::kHidden, good);
    EXPECT_EQ(planes.classify(crate) == Visibility::kHidden, good);
    EXPECT_EQ(opacity.classify(crate) == Visibility::kHidden, good);
    EXPECT_EQ(pyramid.classify(crate) == Visibility::kHidden, good);
  }
}

}  // namespace
}  // namespace sightline
