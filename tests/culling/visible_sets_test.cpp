// Culling with potentially visible sets, alone and as a filter for other methods.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>

#include "tests/culling/demo_frames.h"
#include "tests/culling/fake_sets.h"
#include "tests/culling/kept_objects.h"
#include "tests/culling/ray_judge.h"
#include "tests/culling/seen_though_culled.h"
#include "tests/support/rounds.h"

namespace sightline {
namespace {

using namespace demo_frames;
using fake_sets::FakeSets;
using fake_sets::randomMembers;

using kept_objects::includesAll;
using kept_objects::lookForCulled;
using kept_objects::Objects;
using kept_objects::Sightings;
using kept_objects::visibleOf;

AnyCuller cullerWith(const DemoScene& demo, HierarchyKind kind, AnySettings settings, VisibleSets* sets) {
  return AnyCuller(demo.hierarchy(kind), demo.bounds, demo.occluders, settings, demo.listsFor(settings),
                   sets);
}

Objects within(const Objects& objects, const std::vector<bool>& members) {
  Objects both;
  std::copy_if(objects.begin(), objects.end(), std::back_inserter(both),
               [&](ObjectId object) { return members[object.value]; });
  return both;
}

std::vector<View> perspective(std::vector<View> views) {
  std::erase_if(views, [](const View& view) { return view.orthographic; });
  return views;
}

TEST(VisibilityOctreeCulling, KeepsTheObjectsOfTheSetWhoseBoxesAreNotOutside) {
  for (const DemoScene* demo : {&smallCity(), &smallBuilding()}) {
    FakeSets sets(demo->bounds);
    AnyCuller culler =
        cullerWith(*demo, HierarchyKind::kBvh, {.method = AnyMethod::kVisibilityOctree}, &sets);
    AnyCuller frustum = demo->culler(HierarchyKind::kBvh, {.method = AnyMethod::kFrustum});
    std::mt19937_64 random(5);
    std::size_t kept = 0;
    std::uint32_t id = 0;
    for (const View& view : perspective(jumps(*demo, 11, 400))) {
      const std::vector<bool> members = randomMembers(sets.boxes(), random);
      sets.use(id++, members);
      Objects expected;
      for (std::size_t i = 0; i < demo->bounds.size(); ++i) {
        std::uint8_t mask = kAllFrustumPlanes;
        if (members[i] && classify(frustumOf(view), demo->bounds[i], mask) != FrustumSide::kOutside) {
          expected.push_back(ObjectId(i));
        }
      }
      EXPECT_EQ(visibleOf(culler, view), expected) << "set " << id;
      EXPECT_EQ(expected, within(visibleOf(frustum, view), members));
      EXPECT_EQ(culler.stats().set_nodes, sets.nodeCount());
      EXPECT_EQ(culler.stats().set_objects, std::count(members.begin(), members.end(), true));
      kept += expected.size();
    }
    EXPECT_GT(kept, 1000u);
    EXPECT_TRUE(culler.occludersUsed().empty());
  }
}

TEST(VisibilityOctreeCulling, TestsFewerNodesThanTheSetHas) {
  // Every second leaf is in the set, and the view sees a corner of the scene.
  FakeSets sets(smallCity().bounds);
  std::vector<bool> members(smallCity().bounds.size());
  for (std::size_t i = 0; i < members.size(); ++i) {
    members[sets.boxes().objects[i].value] = i % 2 == 0;
  }
  sets.use(1, members);
  AnyCuller culler =
      cullerWith(smallCity(), HierarchyKind::kBvh, {.method = AnyMethod::kVisibilityOctree}, &sets);
  std::size_t tested = 0, in_sets = 0;
  for (View view : perspective(jumps(smallCity(), 2, 40))) {
    view.tan_half_fovy = 0.1;
    culler.cull(view);
    tested += culler.stats().nodes_visited;
    in_sets += culler.stats().set_nodes;
  }
  EXPECT_LT(tested, in_sets / 2);
}

TEST(VisibilityOctreeCulling, KeepsObjectsWithBrokenBoxesThatAreInTheSet) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::vector<Box> boxes{{{-1, -1, -11}, {1, 1, -9}},
                         {{nan, 0, 0}, {1, 1, 1}},
                         Box{},
                         {{-1, -1, 9}, {1, 1, 11}},
                         {{nan, 0, 0}, {nan, 1, 1}}};
  const Hierarchy hierarchy = buildHierarchy(boxes, {});
  const OccluderSet none;
  FakeSets sets(boxes);
  sets.use(3, {true, true, true, true, false});
  AnyCuller culler(hierarchy, boxes, none, {.method = AnyMethod::kVisibilityOctree}, {}, &sets);
  View view;
  setOrientation(view, {0, 0, -1}, {0, 1, 0});
  EXPECT_EQ(visibleOf(culler, view), (Objects{ObjectId(0u), ObjectId(1u), ObjectId(2u)}));
}

TEST(VisibilityOctreeCulling, AsksForTheViewsEyeAndTheCornerOfItsNearPlane) {
  FakeSets sets(smallCity().bounds);
  AnyCuller culler =
      cullerWith(smallCity(), HierarchyKind::kBvh, {.method = AnyMethod::kVisibilityOctree}, &sets);
  for (const View& view : perspective(jumps(smallCity(), 6, 20))) {
    culler.cull(view);
    const Vec3d corner =
        view.forward + view.up * view.tan_half_fovy + view.right * (view.tan_half_fovy * view.aspect);
    EXPECT_EQ(sets.last_eye, view.eye);
    EXPECT_NEAR(sets.last_near_distance, length(corner * view.z_near), 1e-12);
  }
  EXPECT_EQ(sets.finds, 10u) << "one a frame";
}

TEST(VisibilityOctreeCulling, WithoutASetIsFrustumCulling) {
  FakeSets sets(smallCity().bounds), of_others(std::span(smallCity().bounds).first(50));
  of_others.use(1, std::vector<bool>(50, false));
  const AnySettings settings{.method = AnyMethod::kVisibilityOctree};
  for (const HierarchyKind kind : kKinds) {
    AnyCuller none = cullerWith(smallCity(), kind, settings, nullptr);
    AnyCuller everything = cullerWith(smallCity(), kind, settings, &sets);
    AnyCuller others = cullerWith(smallCity(), kind, settings, &of_others);
    AnyCuller frustum = smallCity().culler(kind, {.method = AnyMethod::kFrustum});
    for (const View& view : jumps(smallCity(), 8, 60)) {
      const Objects expected = visibleOf(frustum, view);
      EXPECT_EQ(visibleOf(none, view), expected);
      EXPECT_EQ(visibleOf(everything, view), expected);
      EXPECT_EQ(visibleOf(others, view), expected) << "sets of another scene are not trusted";
      EXPECT_EQ(none.stats().set_nodes, 0u);
      EXPECT_EQ(everything.stats().set_nodes, view.orthographic ? 0u : 1u);
      EXPECT_EQ(everything.stats().set_objects, view.orthographic ? 0u : smallCity().bounds.size());
    }
  }
}

// Sets of another scene with the same number of objects and the same ids are not used. All objects pass the
// filter, as without sets.
TEST(VisibleSets, OfOtherBoxesAreNotTrusted) {
  const std::vector<Box>& own = smallCity().bounds;
  std::vector<Box> moved = own, one_off = own, exchanged = own;
  for (Box& box : moved) {
    box = {box.min + Vec3f(30, 0, 0), box.max + Vec3f(30, 0, 0)};
  }
  one_off[40].max.y = std::nextafter(one_off[40].max.y, 1e9f);
  std::swap(exchanged[10], exchanged[11]);
  ASSERT_NE(exchanged, own);
  std::vector<NamedSettings> all(std::begin(kMethods), std::end(kMethods));
  all.push_back({"visibility octree", {.method = AnyMethod::kVisibilityOctree}});
  for (auto& [name, settings, stands_for_method] : all) {
    settings.visible_sets = true;
    settings.occluder_count = 0;  // nothing is hidden but by the set
    for (const std::vector<Box>& others : {moved, one_off, exchanged}) {
      FakeSets sets(others);
      sets.use(1, std::vector<bool>(own.size(), false));
      AnyCuller culler = cullerWith(smallCity(), HierarchyKind::kBvh, settings, &sets);
      AnyCuller frustum = smallCity().culler(HierarchyKind::kBvh, {.method = AnyMethod::kFrustum});
      const View view = smallCity().frames(smallCity().scene.paths[0], 10, 1)[0];
      EXPECT_EQ(visibleOf(culler, view), visibleOf(frustum, view)) << name;
      EXPECT_EQ(culler.stats().set_nodes, 0u) << name;
      ASSERT_NE(culler.stats().scene_note, nullptr) << name;
      EXPECT_NE(std::string(culler.stats().scene_note).find("other boxes"), std::string::npos) << name;
    }
  }
}

TEST(VisibilityOctreeCulling, OrthographicViewsAskForNoSet) {
  FakeSets sets(smallCity().bounds);
  sets.use(1, std::vector<bool>(smallCity().bounds.size(), false));
  AnyCuller culler =
      cullerWith(smallCity(), HierarchyKind::kBvh, {.method = AnyMethod::kVisibilityOctree}, &sets);
  AnyCuller frustum = smallCity().culler(HierarchyKind::kBvh, {.method = AnyMethod::kFrustum});
  // The view changes from perspective to orthographic and back.
  for (const View& view : jumps(smallCity(), 9, 40)) {
    const Objects expected = view.orthographic ? visibleOf(frustum, view) : Objects{};
    EXPECT_EQ(visibleOf(culler, view), expected);
  }
}

TEST(VisibilityOctreeCulling, SaysNothingAboutBoxesThatMove) {
  FakeSets sets(smallCity().bounds);
  sets.use(1, std::vector<bool>(smallCity().bounds.size(), false));
  AnyCuller culler =
      cullerWith(smallCity(), HierarchyKind::kBvh, {.method = AnyMethod::kVisibilityOctree}, &sets);
  const View view = smallCity().frames(smallCity().scene.paths[0], 0, 1)[0];
  const Vec3d ahead = view.eye + view.forward * 20.0, behind = view.eye - view.forward * 20.0;
  const Box boxes[] = {{Vec3f(ahead), Vec3f(ahead)}, {Vec3f(behind), Vec3f(behind)}};
  culler.cull(view, boxes);
  EXPECT_EQ(culler.dynamicStates()[0], Visibility::kVisible);
  EXPECT_EQ(culler.dynamicStates()[1], Visibility::kHidden) << "outside the frustum";
}

TEST(VisibleSets, FrustumCullingHasNone) {
  FakeSets sets(smallCity().bounds);
  sets.use(1, std::vector<bool>(smallCity().bounds.size(), false));
  AnyCuller with = cullerWith(smallCity(), HierarchyKind::kBvh,
                              {.method = AnyMethod::kFrustum, .visible_sets = true}, &sets);
  AnyCuller without = smallCity().culler(HierarchyKind::kBvh, {.method = AnyMethod::kFrustum});
  for (const View& view : jumps(smallCity(), 1, 10)) {
    EXPECT_EQ(visibleOf(with, view), visibleOf(without, view));
  }
}

// The visibility tests of these methods do not depend on the set, so results are compared object by object.
// Finer depth buffers are off: all objects that are kept decide where they lie, and so what they hide.
TEST(VisibleSets, AMethodsAnswerWithinTheSetIsTheSameAsWithoutIt) {
  std::uint32_t id = 0;
  std::mt19937_64 random(77);
  for (const HierarchyKind kind : kKinds) {
    for (const auto& [name, plain, stands_for_method] : kMethods) {
      for (const bool detail : {false, true}) {
        for (const bool test_objects : {false, true}) {
          AnySettings settings = plain;
          settings.use_lists = true;
          settings.temporal_coherence = false;
          settings.focus.magnification = 0.0;
          settings.detail_objects = detail;
          settings.test_objects = test_objects;
          settings.min_node_cost = detail ? 60 : 0;
          FakeSets sets(smallCity().bounds);
          AnyCuller without = cullerWith(smallCity(), kind, settings, nullptr);
          settings.visible_sets = true;
          AnyCuller with = cullerWith(smallCity(), kind, settings, &sets);
          for (const View& view : perspective(jumps(smallCity(), 100 + id, 16))) {
            const std::vector<bool> members = randomMembers(sets.boxes(), random);
            sets.use(id++, members);
            EXPECT_EQ(visibleOf(with, view), within(visibleOf(without, view), members))
                << name << " " << nameOf(kind) << " set " << id;
          }
        }
      }
    }
  }
}

TEST(VisibleSets, WithoutASetAMethodDoesWhatItDoesAlone) {
  for (const HierarchyKind kind : kKinds) {
    for (const auto& [name, plain, stands_for_method] : kMethods) {
      AnySettings settings = plain;
      AnyCuller alone = cullerWith(smallCity(), kind, settings, nullptr);
      settings.visible_sets = true;
      FakeSets everything(smallCity().bounds);
      AnyCuller with_all = cullerWith(smallCity(), kind, settings, &everything);
      AnyCuller with_none = cullerWith(smallCity(), kind, settings, nullptr);
      std::vector<View> views = smallCity().frames(smallCity().scene.paths[0], 50, 12);
      const std::vector<View> more = jumps(smallCity(), 12, 6);
      views.insert(views.end(), more.begin(), more.end());
      for (const View& view : views) {
        const Objects expected = visibleOf(alone, view);
        EXPECT_EQ(visibleOf(with_all, view), expected) << name;
        EXPECT_EQ(visibleOf(with_none, view), expected) << name;
        EXPECT_EQ(with_all.stats().nodes_tested, alone.stats().nodes_tested) << name;
      }
    }
  }
}

TEST(VisibleSets, EqualIdsAreEqualSetsUntilReset) {
  for (const auto& [name, plain, stands_for_method] : kMethods) {
    AnySettings settings = plain;
    settings.visible_sets = true;
    settings.occluder_count = 0;  // nothing is hidden but by the set
    FakeSets sets(smallCity().bounds);
    std::vector<bool> even(smallCity().bounds.size()), odd;
    for (std::size_t i = 0; i < even.size(); i += 2) {
      even[i] = true;
    }
    odd = even;
    odd.flip();
    AnyCuller culler = cullerWith(smallCity(), HierarchyKind::kBvh, settings, &sets);
    AnyCuller frustum = smallCity().culler(HierarchyKind::kBvh, {.method = AnyMethod::kFrustum});
    const View view = smallCity().frames(smallCity().scene.paths[0], 10, 1)[0];
    const Objects all = visibleOf(frustum, view);
    sets.use(4, even);
    EXPECT_EQ(visibleOf(culler, view), within(all, even)) << name;
    sets.use(4, odd);  // against the contract: a culler that looks at it again is found out
    EXPECT_EQ(visibleOf(culler, view), within(all, even)) << name;
    culler.reset();
    EXPECT_EQ(visibleOf(culler, view), within(all, odd)) << name;
    sets.useEverything();
    EXPECT_EQ(visibleOf(culler, view), all) << name;
    sets.use(4, even);
    EXPECT_EQ(visibleOf(culler, view), within(all, even)) << name;
  }
}

// Sets of all objects that are visible from one eye, found by the occlusion tree in six directions.
class TrueSets {
 public:
  explicit TrueSets(const DemoScene& demo)
      : demo_(demo), tree_(demo.culler(HierarchyKind::kBvh, {.temporal_coherence = false})) {}

  std::vector<bool> of(const View& view) {
    const double near = nearDistance(view);
    std::vector<bool> members(demo_.bounds.size(), false);
    View side = view;
    side.tan_half_fovy = 1.0;
    side.aspect = 1.0;
    side.z_near = near;
    side.z_far = 1e5;
    const Vec3d axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int direction = 0; direction < 6; ++direction) {
      const Vec3d axis = axes[direction / 2] * (direction % 2 == 0 ? 1.0 : -1.0);
      setOrientation(side, axis, axes[(direction / 2 + 1) % 3]);
      tree_.reset();
      tree_.cull(side);
      for (const ObjectId object : tree_.visible()) {
        members[object.value] = true;
      }
    }
    // The six views begin at a distance of `near`.
    const Vec3d reach(2.0 * near, 2.0 * near, 2.0 * near);
    const Box close{Vec3f(view.eye - reach), Vec3f(view.eye + reach)};
    for (std::size_t i = 0; i < members.size(); ++i) {
      members[i] = members[i] || overlaps(close, demo_.bounds[i]);
    }
    return members;
  }

 private:
  const DemoScene& demo_;
  AnyCuller tree_;
};

std::vector<NamedCuller> allSetCullers(const DemoScene& demo, VisibleSets* sets) {
  std::vector<NamedCuller> cullers;
  const auto add = [&](const std::string& name, HierarchyKind kind, AnySettings settings) {
    settings.visible_sets = true;
    cullers.push_back({name + " " + nameOf(kind), cullerWith(demo, kind, settings, sets)});
  };
  for (const HierarchyKind kind : kKinds) {
    for (const NamedSettings& structure : kStructures) {
      for (const bool coherence : {true, false}) {
        AnySettings settings = structure.settings;
        settings.temporal_coherence = coherence;
        add(structure.name + std::string(coherence ? ", coherent" : ""), kind, settings);
      }
    }
    for (const NamedSettings& method : kMethods) {
      AnySettings settings = method.settings;
      settings.use_lists = true;
      settings.detail_objects = true;
      add(std::string("database, detail objects, ") + method.name, kind, settings);
    }
    add("visibility octree", kind, {.method = AnyMethod::kVisibilityOctree});
  }
  return cullers;
}

// Along a camera path each frame has the set of its eye, and some frames have none, so that coherence with a
// differently filtered frame is tested.
void judgeWalk(const DemoScene& demo, const std::vector<View>& views, const std::string& where) {
  FakeSets sets(demo.bounds);
  TrueSets true_sets(demo);
  ExactVisibility exact(demo.scene.view());
  std::vector<NamedCuller> cullers = allSetCullers(demo, &sets);
  std::size_t seen = 0, kept = 0, in_sets = 0;
  std::vector<bool> members;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const View& view = views[v];
    if (v % 7 == 6) {
      sets.useEverything();
      members.assign(demo.bounds.size(), true);
    } else {
      members = true_sets.of(view);
      sets.use(static_cast<std::uint32_t>(v), members);
    }
    for (NamedCuller& c : cullers) {
      const Objects visible = visibleOf(c.culler, view);
      EXPECT_TRUE(includesAll(visible, within(visible, members)) && within(visible, members) == visible)
          << c.name << " keeps what is not in the set, " << where << " view " << v;
      kept += visible.size();
    }
    in_sets += static_cast<std::size_t>(std::count(members.begin(), members.end(), true));
    const Sightings sightings =
        lookForCulled(exact, view, {.samples = 3}, culledByAny(demo, cullers),
                      [&](ObjectId object) { return namesWithout(cullers, object).empty(); });
    seen += sightings.through_pixels;
    for (const SeenPoint& witness : sightings.though_culled) {
      ADD_FAILURE() << "object " << witness.object.value << " is seen, " << where << " view " << v
                    << ", but culled by " << namesWithout(cullers, witness.object);
    }
  }
  EXPECT_GT(seen, 3 * views.size()) << where;
  EXPECT_LT(kept / cullers.size(), in_sets) << where;
}

TEST(VisibleSets, NothingThatRaysSeeIsCulledOnWalks) {
  judgeWalk(smallCity(), smallCity().frames(smallCity().scene.paths[0], 100, test::rounds(14u)), "city");
  judgeWalk(smallBuilding(), smallBuilding().frames(smallBuilding().scene.paths[0], 200, test::rounds(14u)),
            "building");
}

TEST(VisibleSets, NothingThatRaysSeeIsCulledAfterJumps) {
  judgeWalk(smallCity(), perspective(jumps(smallCity(), 41, 24)), "city, jumps");
  judgeWalk(smallBuilding(), perspective(jumps(smallBuilding(), 42, 24)), "building, jumps");
}

TEST(VisibleSets, TheLookUpIsPartOfTheTotal) {
  FakeSets sets(smallCity().bounds);
  AnyCuller culler = cullerWith(smallCity(), HierarchyKind::kBvh, {.visible_sets = true}, &sets);
  culler.cull(smallCity().frames(smallCity().scene.paths[0], 0, 1)[0]);
  const CullStats& stats = culler.stats();
  EXPECT_GT(stats.look_up_us, 0.0);
  EXPECT_EQ(stats.totalUs(),
            stats.look_up_us + stats.choose_us + stats.build_us + stats.traverse_us + stats.detail_us);
}

}  // namespace
}  // namespace sightline
