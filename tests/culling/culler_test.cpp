#include "sightline/occluders/occluder_database.h"
#include "tests/culling/kept_objects.h"
#include "tests/support/any_culler.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <limits>
#include <string>

#include "src/culling/object_bits.h"
#include "tests/culling/demo_frames.h"
#include "tests/occlusion/small_scenes.h"
#include "tests/support/rounds.h"

namespace sightline {
namespace {

using namespace demo_frames;

using kept_objects::includesAll;
using kept_objects::Objects;
using kept_objects::visibleOf;

// The number of objects that a culler keeps, and the number of those in the frustum.
struct Share {
  std::size_t kept = 0, in_frustum = 0;
  double value() const { return static_cast<double>(kept) / static_cast<double>(in_frustum); }
};

class ShareMeter {
 public:
  ShareMeter(const DemoScene& demo, HierarchyKind kind, const AnySettings& settings = {})
      : tree_(demo.culler(kind, settings)), frustum_(demo.culler(kind, {.method = AnyMethod::kFrustum})) {}

  void add(const View& view, Share& share) {
    tree_.cull(view);
    frustum_.cull(view);
    share.kept += tree_.visible().size();
    share.in_frustum += frustum_.visible().size();
  }
  void reset() { tree_.reset(); }

 private:
  AnyCuller tree_, frustum_;
};

const DemoScene& city() {
  static const DemoScene kCity(makeCity({.copies = 10}));
  return kCity;
}

constexpr std::size_t kPlaces[] = {5, 60, 120, 190, 260, 330};

TEST(Culler, CullsFromTheFirstFrameOn) {
  for (const HierarchyKind kind : kKinds) {
    ShareMeter meter(city(), kind);
    Share share;
    for (const std::size_t place : kPlaces) {
      meter.reset();
      meter.add(city().frames(city().scene.paths[0], place, 1)[0], share);
    }
    EXPECT_LT(share.value(), 0.6);
  }
}

TEST(Culler, CullsInTheFrameAfterAJump) {
  for (const HierarchyKind kind : kKinds) {
    ShareMeter meter(city(), kind);
    Share share, steady;
    for (const std::size_t place : kPlaces) {
      const std::vector<View> frames = city().frames(city().scene.paths[0], place, 4);
      meter.add(frames[0], share);
      for (const View& view : frames) {
        meter.add(view, steady);
      }
    }
    EXPECT_LT(share.value(), 0.6);
    EXPECT_LT(share.value(), 1.25 * steady.value()) << "as well as in the frames after it";
  }
}

TEST(Culler, CullsOnASteadyWalk) {
  for (const HierarchyKind kind : kKinds) {
    for (const auto& [name, settings, stands_for_method] : kStructures) {
      ShareMeter meter(city(), kind, settings);
      Share share;
      for (const View& view : city().frames(city().scene.paths[0], 100, 30)) {
        meter.add(view, share);
      }
      EXPECT_LT(share.value(), 0.6) << name;
    }
  }
}

TEST(Culler, KeepsNothingThatFrustumCullingLeavesOut) {
  for (const HierarchyKind kind : kKinds) {
    for (const auto& [name, settings, stands_for_method] : kStructures) {
      AnyCuller culler = city().culler(kind, settings);
      AnyCuller frustum = city().culler(kind, {.method = AnyMethod::kFrustum});
      for (const View& view : jumps(city(), 3, 20)) {
        EXPECT_TRUE(includesAll(visibleOf(frustum, view), visibleOf(culler, view))) << name;
      }
    }
  }
}

Objects notOutside(const DemoScene& demo, const View& view) {
  Objects objects;
  for (std::size_t i = 0; i < demo.bounds.size(); ++i) {
    std::uint8_t mask = kAllFrustumPlanes;
    if (classify(frustumOf(view), demo.bounds[i], mask) != FrustumSide::kOutside) {
      objects.push_back(ObjectId(i));
    }
  }
  return objects;
}

// Whether any point of a lattice in the box is inside of the frustum.
bool hasAPointInside(const Frustum& frustum, const Box& box) {
  constexpr int kSteps = 12;
  const Vec3d extent = Vec3d(box.max) - Vec3d(box.min);
  for (int i = 0; i < kSteps * kSteps * kSteps; ++i) {
    const int column = i % kSteps, row = i / kSteps % kSteps, layer = i / (kSteps * kSteps);
    const Vec3d t(column, row, layer);
    const Vec3d point =
        Vec3d(box.min) + Vec3d(t.x * extent.x, t.y * extent.y, t.z * extent.z) / (kSteps - 1.0);
    if (std::all_of(frustum.planes.begin(), frustum.planes.end(),
                    [&](const Plane& plane) { return plane.evaluate(point) > 1e-6; })) {
      return true;
    }
  }
  return false;
}

TEST(Culler, FrustumCullingKeepsTheObjectsWhoseBoxesAreNotOutside) {
  AnyCuller bvh = smallCity().culler(HierarchyKind::kBvh, {.method = AnyMethod::kFrustum});
  AnyCuller kd_tree = smallCity().culler(HierarchyKind::kKdTree, {.method = AnyMethod::kFrustum});
  for (const View& view : jumps(smallCity(), 4, 60)) {
    const Objects expected = notOutside(smallCity(), view);
    EXPECT_EQ(visibleOf(bvh, view), expected);
    // A leaf tests only its part of a box that is in several leaves. All parts may be outside, each beyond
    // another plane, when the whole box is not.
    const Objects kept = visibleOf(kd_tree, view);
    EXPECT_TRUE(includesAll(expected, kept));
    Objects left_out;
    std::set_difference(expected.begin(), expected.end(), kept.begin(), kept.end(),
                        std::back_inserter(left_out));
    for (const ObjectId object : left_out) {
      EXPECT_FALSE(hasAPointInside(frustumOf(view), smallCity().bounds[object.value]));
    }
  }
  EXPECT_TRUE(bvh.occludersUsed().empty());
}

TEST(Culler, TemporalCoherenceTestsFewerNodesAndCullsAsMuch) {
  for (const HierarchyKind kind : kKinds) {
    AnyCuller coherent = city().culler(kind, {.temporal_coherence = true});
    AnyCuller incoherent = city().culler(kind, {.temporal_coherence = false});
    std::size_t coherent_tests = 0, incoherent_tests = 0, coherent_kept = 0, incoherent_kept = 0, skipped = 0;
    for (const View& view : city().frames(city().scene.paths[0], 20, 60)) {
      coherent.cull(view);
      incoherent.cull(view);
      coherent_tests += coherent.stats().nodes_tested;
      incoherent_tests += incoherent.stats().nodes_tested;
      coherent_kept += coherent.visible().size();
      incoherent_kept += incoherent.visible().size();
      skipped += coherent.stats().nodes_skipped;
      EXPECT_EQ(incoherent.stats().nodes_skipped, 0u);
    }
    EXPECT_LT(coherent_tests, incoherent_tests);
    EXPECT_GT(skipped, 0u);
    // Skipping a node leads to more tests of its children, but not to more visible objects.
    EXPECT_LE(coherent_kept, incoherent_kept + incoherent_kept / 20);
  }
}

TEST(Culler, ANodeBelowTheMinimumCostIsTakenAsVisible) {
  for (const HierarchyKind kind : kKinds) {
    AnyCuller all = city().culler(kind, {.min_node_cost = 0});
    AnyCuller some = city().culler(kind, {.min_node_cost = 400});
    AnyCuller none = city().culler(kind, {.min_node_cost = 1'000'000'000});
    AnyCuller frustum = city().culler(kind, {.method = AnyMethod::kFrustum});
    std::size_t all_tests = 0, some_tests = 0;
    for (const View& view : city().frames(city().scene.paths[0], 40, 8)) {
      for (Culler* culler : {&all, &some, &none, &frustum}) {
        culler->reset();  // the same occluders for each
      }
      const Objects tight = visibleOf(all, view), loose = visibleOf(some, view);
      EXPECT_TRUE(includesAll(loose, tight));
      EXPECT_EQ(visibleOf(none, view), visibleOf(frustum, view));
      EXPECT_EQ(none.stats().nodes_tested + none.stats().objects_tested, 0u);
      all_tests += all.stats().nodes_tested;
      some_tests += some.stats().nodes_tested;
    }
    EXPECT_LT(some_tests, all_tests);
  }
}

TEST(Culler, NodesOfManyTrianglesAreTestedWithALargeMinimumCost) {
  // Two objects of 100,000 triangles each behind a wall.
  const std::vector<Box> bounds{
      {{-8, -8, -5}, {8, 8, -5}}, {{-1, -1, -9}, {0, 1, -8}}, {{0.5f, -1, -9}, {1, 1, -8}}};
  const std::vector<std::uint32_t> triangles{2, 100'000, 100'000};
  const std::vector<Vec3f> corners{{-8, -8, -5}, {8, -8, -5}, {8, 8, -5}, {-8, 8, -5}};
  const std::vector<OccluderPolygon> polygons{{corners, false, ObjectId(0u)}};
  const OccluderSet wall = makeOccluders(polygons);
  View view;
  setOrientation(view, {0, 0, -1}, {0, 1, 0});
  view.z_near = 0.1;
  for (const HierarchyKind kind : kKinds) {
    const Hierarchy hierarchy = buildHierarchy(bounds, triangles, {.kind = kind, .max_leaf_objects = 1});
    for (auto [name, settings, stands_for_method] : kStructures) {
      for (const std::uint32_t cost : {0u, 65'535u, 65'536u, 100'000u}) {
        settings.min_node_cost = cost;
        AnyCuller culler(hierarchy, bounds, wall, settings);
        EXPECT_EQ(visibleOf(culler, view), Objects{ObjectId(0u)}) << name << " " << cost;
      }
      settings.min_node_cost = 200'003;
      AnyCuller none(hierarchy, bounds, wall, settings);
      EXPECT_EQ(visibleOf(none, view).size(), 3u) << name;
    }
  }
}

TEST(Culler, KeepsNoMoreWithMoreOccluders) {
  const auto expectNoMore = [](const DemoScene& demo, const char* scene, std::size_t step) {
    const CameraPath& path = demo.scene.paths[0];
    for (const auto variant : test::kTreeVariants) {
      std::size_t before = std::numeric_limits<std::size_t>::max();
      for (const std::uint32_t count : {16u, 32u, 64u, 128u, 256u}) {
        AnyCuller culler = demo.culler(HierarchyKind::kBvh, {.variant = variant, .occluder_count = count});
        std::size_t kept = 0;
        for (std::size_t frame = 0; frame < path.frames.size(); frame += step) {
          culler.reset();
          culler.cull(path.view(frame, demo.scene.origin));
          kept += culler.visible().size();
        }
        EXPECT_LE(kept, before) << scene << ", variant " << static_cast<int>(variant) << ", " << count;
        before = kept;
      }
    }
  };
  const std::size_t step = test::sanitized() ? 100 : 25;
  expectNoMore(city(), "city", step);
  static const DemoScene kBuilding(makeBuilding({.floors = 4}));
  expectNoMore(kBuilding, "building", step);
}

TEST(Culler, TheModifiedTreeKeepsAsLittleAsTheStandardOne) {
  // They may differ in boxes that touch a shadow plane within rounding.
  for (const std::uint32_t count : {32u, 128u, 256u}) {
    std::size_t standard_kept = 0, modified_kept = 0;
    for (const std::size_t place : kPlaces) {
      const View view = city().scene.paths[0].view(place, city().scene.origin);
      const auto keptBy = [&](OcclusionTreeVariant variant) {
        AnyCuller culler = city().culler(HierarchyKind::kBvh, {.variant = variant, .occluder_count = count});
        return visibleOf(culler, view).size();
      };
      standard_kept += keptBy(OcclusionTreeVariant::kFSE);
      modified_kept += keptBy(OcclusionTreeVariant::kFME);
    }
    EXPECT_GE(modified_kept, standard_kept) << count;
    EXPECT_LE(modified_kept, standard_kept + standard_kept / 50) << count;
  }
}

TEST(Culler, BoxesInsideTheFrustumAreNotComparedWithItsPlanes) {
  // From far away all of the city is in view, so there is nothing for the tree without occluders to compare.
  View view;
  const Box all = sceneBounds(city().scene.view());
  view.eye = Vec3d(center(all)) + Vec3d(0, 5000, 1);
  setOrientation(view, {0, -1, 0}, {0, 0, 1});
  view.z_far = 1e5;
  for (const auto variant : test::kTreeVariants) {
    AnyCuller culler = city().culler(HierarchyKind::kBvh, {.variant = variant, .occluder_count = 0});
    EXPECT_EQ(visibleOf(culler, view).size(), city().bounds.size());
    EXPECT_GT(culler.stats().nodes_tested, 0u);
    EXPECT_EQ(culler.statistic("tree", "plane_tests"), 0u) << static_cast<int>(variant);
  }
}

TEST(Culler, WithoutTestsOfObjectsKeepsASuperset) {
  for (const HierarchyKind kind : kKinds) {
    AnyCuller with = city().culler(kind, {});
    AnyCuller without = city().culler(kind, {.test_objects = false});
    for (const View& view : city().frames(city().scene.paths[0], 40, 6)) {
      with.reset();
      without.reset();
      EXPECT_TRUE(includesAll(visibleOf(without, view), visibleOf(with, view)));
      EXPECT_EQ(without.stats().objects_tested, 0u);
    }
  }
}

TEST(Culler, UsesAtMostTheGivenNumberOfOccluders) {
  for (const NamedSettings& method : kMethods) {
    for (const std::uint32_t count : {0u, 1u, 8u, 50u}) {
      AnySettings settings = method.settings;
      settings.occluder_count = count;
      AnyCuller culler = city().culler(HierarchyKind::kBvh, settings);
      AnyCuller frustum = city().culler(HierarchyKind::kBvh, {.method = AnyMethod::kFrustum});
      for (const View& view : city().frames(city().scene.paths[0], 40, 4)) {
        const Objects visible = visibleOf(culler, view);
        EXPECT_LE(culler.occludersUsed().size(), count);
        EXPECT_EQ(culler.stats().occluders, culler.occludersUsed().size());
        if (count == 0) {
          EXPECT_EQ(visible, visibleOf(frustum, view));
        }
      }
    }
  }
}

bool sameWork(const AnyCuller& one, const AnyCuller& other) {
  const CullStats& a = one.stats();
  const CullStats& b = other.stats();
  const auto sameValue = [](const MethodStatistic& x, const MethodStatistic& y) {
    return x.value == y.value;
  };
  return a.nodes_visited == b.nodes_visited && a.nodes_tested == b.nodes_tested &&
         a.objects_tested == b.objects_tested && a.nodes_skipped == b.nodes_skipped &&
         a.occluders == b.occluders &&
         std::equal(one.statistics().begin(), one.statistics().end(), other.statistics().begin(),
                    other.statistics().end(), sameValue);
}

// Expects equal results of two cullers, frame by frame.
void expectEqualRuns(AnyCuller& a, AnyCuller& b, std::span<const View> views) {
  for (const View& view : views) {
    a.cull(view);
    b.cull(view);
    EXPECT_TRUE(std::equal(a.visible().begin(), a.visible().end(), b.visible().begin(), b.visible().end()));
    EXPECT_TRUE(std::equal(a.occludersUsed().begin(), a.occludersUsed().end(), b.occludersUsed().begin(),
                           b.occludersUsed().end()));
    EXPECT_TRUE(sameWork(a, b));
  }
}

TEST(Culler, GivesTheSameBitForBitWhenRunTwice) {
  for (const HierarchyKind kind : kKinds) {
    for (const auto& [name, settings, stands_for_method] : kStructures) {
      SCOPED_TRACE(name);
      AnyCuller a = smallCity().culler(kind, settings), b = smallCity().culler(kind, settings);
      expectEqualRuns(a, b, smallCity().frames(smallCity().scene.paths[0], 50, 20));
      expectEqualRuns(a, b, jumps(smallCity(), 5, 20));
    }
  }
}

TEST(Culler, IsAsNewAfterReset) {
  for (const HierarchyKind kind : kKinds) {
    for (const NamedSettings& method : kMethods) {
      SCOPED_TRACE(method.name);
      AnySettings settings = method.settings;
      settings.detail_objects = true;
      AnyCuller used = smallCity().culler(kind, settings), fresh = smallCity().culler(kind, settings);
      for (const View& view : jumps(smallCity(), 6, 10)) {
        used.cull(view);
      }
      used.reset();
      expectEqualRuns(used, fresh, smallCity().frames(smallCity().scene.paths[0], 50, 20));
    }
  }
}

TEST(Culler, CanBeMoved) {
  for (const auto& [name, settings, stands_for_method] : kMethods) {
    SCOPED_TRACE(name);
    const std::vector<View> views = smallCity().frames(smallCity().scene.paths[0], 50, 6);
    AnyCuller first = smallCity().culler(HierarchyKind::kBvh, settings),
              other = smallCity().culler(HierarchyKind::kBvh, settings);
    expectEqualRuns(first, other, std::span(views).first(3));
    AnyCuller second = std::move(first);
    expectEqualRuns(second, other, std::span(views).last(3));
  }
}

TEST(Culler, OfAnEmptySceneKeepsNothing) {
  const DemoScene empty{Scene{}};
  for (const HierarchyKind kind : kKinds) {
    for (const NamedSettings& method : kMethods) {
      AnySettings settings = method.settings;
      settings.detail_objects = true;
      AnyCuller culler = empty.culler(kind, settings);
      for (const View& view : jumps(smallCity(), 7, 4)) {
        EXPECT_TRUE(visibleOf(culler, view).empty());
      }
    }
  }
}

TEST(Culler, OfASceneWithoutOccludersDoesFrustumCulling) {
  Scene glass = makeCity({.copies = 1});
  for (Material& material : glass.materials) {
    material.opacity = Opacity::kBlended;
  }
  const DemoScene demo(std::move(glass));
  ASSERT_TRUE(demo.occluders.occluders.empty());
  for (const HierarchyKind kind : kKinds) {
    AnyCuller frustum = demo.culler(kind, {.method = AnyMethod::kFrustum});
    for (const NamedSettings& method : kMethods) {
      AnySettings settings = method.settings;
      settings.detail_objects = true;
      AnyCuller culler = demo.culler(kind, settings);
      for (const View& view : jumps(demo, 8, 10)) {
        EXPECT_EQ(visibleOf(culler, view), visibleOf(frustum, view)) << method.name;
      }
    }
  }
}

// A wall of 8 x 8 metres at z = -5, seen from the origin along -z.
struct WallScene {
  std::vector<Box> bounds{{{-4, -4, -5}, {4, 4, -5}}};
  OccluderSet occluders = test::setOf(std::vector{test::wall(-4, 4, -4, 4, -5)});
  View view;

  WallScene() {
    setOrientation(view, {0, 0, -1}, {0, 1, 0});
    view.tan_half_fovy = 2.0;
    view.aspect = 1.0;
    view.z_near = 0.1;
    view.z_far = 100.0;
  }
};

TEST(Culler, ObjectsWithBadBoxesAreNeverCulledAndStopTheCullingOfNoOther) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  WallScene scene;
  const Box hidden{{-1, -1, -12}, {1, 1, -10}};
  for (const Box& box : {hidden, Box{}, Box{{nan, 0, -12}, {1, 1, -10}}, Box{{-1, -1, -inf}, {1, 1, -10}},
                         hidden, Box{{5, 5, 90}, {4, 4, 80}}}) {
    scene.bounds.push_back(box);
  }
  const Objects wall_and_bad{ObjectId(0u), ObjectId(2u), ObjectId(3u), ObjectId(4u), ObjectId(6u)};
  for (const HierarchyKind kind : kKinds) {
    const Hierarchy hierarchy = buildHierarchy(scene.bounds, {}, {.kind = kind, .max_leaf_objects = 1});
    const OccluderDatabase database = OccluderDatabase::build(hierarchy, scene.occluders);
    for (const NamedSettings& structure : kStructures) {
      for (const bool detail_objects : {false, true}) {
        AnySettings settings = structure.settings;
        settings.detail_objects = detail_objects;
        AnyCuller culler(hierarchy, scene.bounds, scene.occluders, settings, {&database, &database});
        for (int frame = 0; frame < 3; ++frame) {
          EXPECT_EQ(visibleOf(culler, scene.view), wall_and_bad)
              << "frame " << frame << " " << nameOf(kind) << " " << structure.name;
        }
      }
    }
  }
}

TEST(Culler, DynamicBoxesAreHiddenBehindWallsAndOutsideTheFrustumOnly) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const WallScene scene;
  const std::array<Box, 8> boxes{Box{{-1, -1, -12}, {1, 1, -10}},    // behind the wall
                                 Box{{-1, -1, -4}, {1, 1, -3}},      // before it
                                 Box{{-1, -1, 3}, {1, 1, 4}},        // behind the viewer
                                 Box{{-1, -1, -120}, {1, 1, -110}},  // beyond the far plane
                                 Box{{7, -1, -12}, {12, 1, -10}},    // beside its shadow, in part
                                 Box{{12, -1, -12}, {13, 1, -10}},   // beside its shadow
                                 Box{{nan, -1, -12}, {1, 1, -10}},  Box{}};
  const std::array<Visibility, 8> expected{Visibility::kHidden,  Visibility::kVisible, Visibility::kHidden,
                                           Visibility::kHidden,  Visibility::kPartial, Visibility::kVisible,
                                           Visibility::kVisible, Visibility::kVisible};
  const Hierarchy hierarchy = buildHierarchy(scene.bounds, {});
  for (const auto& [name, settings, stands_for_method] : kStructures) {
    AnyCuller culler(hierarchy, scene.bounds, scene.occluders, settings);
    for (int frame = 0; frame < 3; ++frame) {
      culler.cull(scene.view, boxes);
      ASSERT_EQ(culler.dynamicStates().size(), boxes.size());
      for (std::size_t i = 0; i < boxes.size(); ++i) {
        // The opacity map does not detect that a box is in front of everything that covers its pixels.
        const bool before = settings.method == AnyMethod::kOpacityMap && i == 1;
        EXPECT_EQ(culler.dynamicStates()[i], before ? Visibility::kPartial : expected[i])
            << "box " << i << " " << name;
      }
      EXPECT_EQ(culler.visible().size(), 1u);
    }
    culler.cull(scene.view);
    EXPECT_TRUE(culler.dynamicStates().empty());
  }
}

// The occlusion structure that a culler with these settings uses.
class Structure {
 public:
  Structure(const AnySettings& settings, const View& view, const OccluderSet& set,
            std::span<const OccluderId> used)
      : method_(settings.method),
        tree_({.variant = settings.variant}),
        planes_(settings.supporting_planes),
        kept_planes_(settings.kept_planes),
        opacity_map_({.raster = settings.raster}),
        pyramid_({.raster = settings.raster}) {
    tree_.build(view, set, used);
    planes_.build(view, set, used);
    kept_planes_.build(view, set, used);
    opacity_map_.build(view, set, used);
    pyramid_.build(view, set, used);
  }
  Visibility classify(const Box& box) {
    switch (method_) {
      case AnyMethod::kOcclusionTree:
        return tree_.classify(box);
      case AnyMethod::kKeptPlanes:
        return kept_planes_.classify(box);
      case AnyMethod::kOpacityMap:
        return opacity_map_.classify(box);
      case AnyMethod::kDepthPyramid:
        return pyramid_.classify(box);
      case AnyMethod::kSupportingPlanes:
        return planes_.classify(box);
      case AnyMethod::kFrustum:
      case AnyMethod::kVisibilityOctree:
        break;  // they have no structure
    }
    return Visibility::kVisible;
  }

 private:
  AnyMethod method_;
  OcclusionTree tree_;
  SupportingPlanes planes_;
  KeptPlanes kept_planes_;
  OpacityMap opacity_map_;
  DepthPyramid pyramid_;
};

// Moving walls hide objects together with the static ones, but only in their own frame.
TEST(Culler, OccludersThatMoveHideInTheirFrame) {
  const WallScene scene;
  const Hierarchy hierarchy = buildHierarchy(scene.bounds, {});
  const Box box{{12, -1, -12}, {13, 1, -10}};  // beside the wall's shadow
  const Vec3f corners[] = {{7, -3, -8}, {14, -3, -8}, {14, 3, -8}, {7, 3, -8}};
  const OccluderPolygon wall{corners};
  const OccluderSet moving = makeOccluders({&wall, 1});
  ASSERT_EQ(moving.occluders.size(), 1u);
  for (const auto& [name, settings, stands_for_method] : kStructures) {
    AnyCuller culler(hierarchy, scene.bounds, scene.occluders, settings);
    culler.cull(scene.view, {&box, 1});
    EXPECT_NE(culler.dynamicStates()[0], Visibility::kHidden) << name;
    culler.cull(scene.view, {&box, 1}, &moving);
    EXPECT_EQ(culler.dynamicStates()[0], Visibility::kHidden) << name;
    culler.cull(scene.view, {&box, 1});
    EXPECT_NE(culler.dynamicStates()[0], Visibility::kHidden) << name;
  }
}

TEST(Culler, DynamicBoxesAreClassifiedAsTheStructureDoes) {
  std::mt19937_64 random(12);
  const auto in = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
  };
  for (const auto& [name, settings, stands_for_method] : kStructures) {
    std::size_t hidden = 0, others = 0;
    AnyCuller culler = smallCity().culler(HierarchyKind::kBvh, settings);
    for (const View& view : smallCity().frames(smallCity().scene.paths[0], 30, 10)) {
      std::vector<Box> boxes;
      for (int i = 0; i < 100; ++i) {
        const Vec3d middle =
            view.eye + view.forward * in(1, 60) + view.right * in(-20, 20) + view.up * in(-3, 9);
        const Vec3d half(in(0.1, 2), in(0.1, 2), in(0.1, 2));
        boxes.push_back({Vec3f(middle - half), Vec3f(middle + half)});
      }
      culler.cull(view, boxes);
      Structure structure(settings, view, smallCity().occluders, culler.occludersUsed());
      for (std::size_t i = 0; i < boxes.size(); ++i) {
        std::uint8_t mask = kAllFrustumPlanes;
        const bool outside = classify(frustumOf(view), boxes[i], mask) == FrustumSide::kOutside;
        const Visibility expected = outside ? Visibility::kHidden : structure.classify(boxes[i]);
        EXPECT_EQ(culler.dynamicStates()[i], expected) << name;
        hidden += !outside && expected == Visibility::kHidden ? 1 : 0;
        others += expected != Visibility::kHidden ? 1 : 0;
      }
    }
    EXPECT_GT(hidden, 25u) << name;
    EXPECT_GT(others, 25u) << name;
  }
}

TEST(Culler, FrustumCullingClassifiesDynamicBoxesByTheFrustumAlone) {
  const WallScene scene;
  const Hierarchy hierarchy = buildHierarchy(scene.bounds, {});
  AnyCuller culler(hierarchy, scene.bounds, scene.occluders, {.method = AnyMethod::kFrustum});
  const Box boxes[] = {{{-1, -1, -12}, {1, 1, -10}}, {{-1, -1, 3}, {1, 1, 4}}};
  culler.cull(scene.view, boxes);
  EXPECT_EQ(culler.dynamicStates()[0], Visibility::kVisible);
  EXPECT_EQ(culler.dynamicStates()[1], Visibility::kHidden);
}

TEST(ObjectBits, ReturnTheirMembersOnceAndInOrder) {
  for (const std::size_t count : {0u, 1u, 63u, 64u, 65u, 5000u, 70000u}) {
    std::mt19937_64 random(count);
    culling::ObjectBits bits(count);
    for (int round = 0; round < 3; ++round) {
      Objects expected;
      for (std::size_t i = 0; i < count; i += 1 + random() % 40) {
        expected.push_back(ObjectId(i));
      }
      Objects shuffled = expected;
      std::shuffle(shuffled.begin(), shuffled.end(), random);
      for (const ObjectId object : shuffled) {
        EXPECT_TRUE(bits.insert(object));
        EXPECT_FALSE(bits.insert(object));
      }
      Objects drained;
      if (round == 1) {
        bits.clear();
        expected.clear();
      }
      bits.drainInto(drained);
      EXPECT_EQ(drained, expected) << "of " << count;
    }
  }
}

}  // namespace
}  // namespace sightline
