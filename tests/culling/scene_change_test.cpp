// Changes of a scene that a culler uses: it grows, shrinks or moves, or its parts do not belong together.

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <string>

#include "tests/culling/demo_frames.h"
#include "tests/culling/fake_sets.h"
#include "tests/culling/kept_objects.h"
#include "tests/culling/seen_though_culled.h"
#include "tests/occlusion/small_scenes.h"

namespace sightline {
namespace {

using namespace demo_frames;
using fake_sets::FakeSets;

using kept_objects::Objects;
using kept_objects::visibleOf;

Objects firstObjects(std::size_t count) {
  Objects objects;
  for (std::size_t i = 0; i < count; ++i) {
    objects.push_back(ObjectId(i));
  }
  return objects;
}

// Returns settings of every method.
std::vector<NamedSettings> allMethods() {
  std::vector<NamedSettings> all(std::begin(kMethods), std::end(kMethods));
  all.push_back({"frustum", {.method = AnyMethod::kFrustum}});
  all.push_back({"visibility octree", {.method = AnyMethod::kVisibilityOctree}});
  all.push_back({"depth pyramid within sets", {.method = AnyMethod::kDepthPyramid, .visible_sets = true}});
  NamedSettings detail{"planes through the box, detail objects", {.method = AnyMethod::kKeptPlanes}};
  detail.settings.detail_objects = true;
  detail.settings.use_lists = true;
  all.push_back(detail);
  return all;
}

// Makes the demo city with all coordinates moved.
Scene movedCity(std::uint32_t copies, const Vec3f& by) {
  Scene scene = makeCity({.copies = copies});
  for (Vec3f& position : scene.positions) {
    position += by;
  }
  updateBounds(scene);
  return scene;
}

AnyLists databasesOf(const DemoScene& demo) {
  return {&demo.database(), &demo.detailDatabase()};
}

// Their databases are made at once, so that copies have them too.
const DemoScene& oneCopy() {
  static const DemoScene kScene(makeCity({.copies = 1}));
  databasesOf(kScene);
  return kScene;
}
const DemoScene& oneCopyMoved() {
  static const DemoScene kScene(movedCity(1, {25, 0, 13}));
  databasesOf(kScene);
  return kScene;
}

// A scene that is replaced in the same memory, with potentially visible sets that contain every object.
struct LiveScene {
  DemoScene demo;
  std::unique_ptr<FakeSets> sets;

  explicit LiveScene(const DemoScene& first) : demo(first) { makeSets(); }
  void become(const DemoScene& other) {
    databasesOf(other);
    demo = other;
    makeSets();
  }
  AnyCuller culler(HierarchyKind kind, const AnySettings& settings) const {
    return AnyCuller(demo.hierarchy(kind), demo.bounds, demo.occluders, settings, databases(), sets.get());
  }
  AnyLists databases() const { return databasesOf(demo); }

 private:
  void makeSets() {
    sets = std::make_unique<FakeSets>(demo.bounds);
    sets->use(1, std::vector<bool>(demo.bounds.size(), true));
  }
};

// The culler has just culled this view.
void expectTheSeenIsKept(const ExactVisibility& exact, const AnyCuller& culler, const View& view,
                         const std::string& where) {
  const kept_objects::Sightings sightings = kept_objects::lookForCulled(
      exact, view, {}, {}, [&](ObjectId object) { return kept_objects::isKept(culler, object); });
  for (const SeenPoint& witness : sightings.though_culled) {
    ADD_FAILURE() << where << ": object " << witness.object.value << " is seen";
  }
}

// Expects that the culler's next frames equal those of a new culler, and that no object that a ray reaches is
// culled.
void expectAsNew(AnyCuller& culler, const LiveScene& live, HierarchyKind kind, const AnySettings& settings,
                 const std::string& where) {
  AnyCuller fresh = live.culler(kind, settings);
  const ExactVisibility exact(live.demo.scene.view());
  for (const View& view : live.demo.frames(live.demo.scene.paths[0], 60, 4)) {
    const Objects visible = visibleOf(culler, view);
    EXPECT_EQ(visible, visibleOf(fresh, view)) << where;
    EXPECT_EQ(culler.stats().scene_fault, nullptr) << where;
    EXPECT_LT(visible.size(), live.demo.bounds.size()) << where;
    expectTheSeenIsKept(exact, culler, view, where);
  }
}

TEST(ResetCuller, IsRightInASceneThatGrewShrankOrMoved) {
  for (const HierarchyKind kind : kKinds) {
    for (const auto& [name, settings, stands_for_method] : allMethods()) {
      LiveScene live(oneCopy());
      AnyCuller culler = live.culler(kind, settings);
      expectAsNew(culler, live, kind, settings, std::string(name) + ", at first");
      for (const auto& [change, scene] :
           {std::pair{", grown", &smallCity()}, {", shrunk", &oneCopy()}, {", moved", &oneCopyMoved()}}) {
        live.become(*scene);
        culler.reset(live.demo.hierarchy(kind), live.demo.bounds, live.demo.occluders, live.databases(),
                     live.sets.get());
        expectAsNew(culler, live, kind, settings, name + nameOf(kind) + change);
      }
    }
  }
}

// The culler still holds the sets of the old scene, which it must not use any more.
TEST(ResetCuller, IsRightInASceneThatMovedInTheSameMemory) {
  for (const HierarchyKind kind : kKinds) {
    for (const auto& [name, settings, stands_for_method] : allMethods()) {
      LiveScene live(oneCopy());
      const Box* memory = live.demo.bounds.data();
      AnyCuller culler = live.culler(kind, settings);
      expectAsNew(culler, live, kind, settings, std::string(name) + ", at first");
      live.demo = oneCopyMoved();
      ASSERT_EQ(live.demo.bounds.data(), memory);
      culler.reset();
      expectAsNew(culler, live, kind, settings, name + nameOf(kind) + ", moved");
    }
  }
}

TEST(ResetCuller, HasNoAnswersUntilTheNextFrame) {
  AnyCuller culler = oneCopy().culler(HierarchyKind::kBvh, {});
  const std::vector<View> views = oneCopy().frames(oneCopy().scene.paths[0], 60, 1);
  EXPECT_FALSE(visibleOf(culler, views[0]).empty());
  culler.reset();
  EXPECT_TRUE(culler.visible().empty());
  EXPECT_TRUE(culler.occludersUsed().empty());
}

TEST(Culler, KeepsEverythingOfASceneThatGrewOrShrankWithoutReset) {
  for (const HierarchyKind kind : kKinds) {
    for (const auto& [name, settings, stands_for_method] : allMethods()) {
      LiveScene live(oneCopy());
      AnyCuller culler = live.culler(kind, settings);
      const std::size_t count = live.demo.bounds.size();
      const std::vector<View> views = live.demo.frames(live.demo.scene.paths[0], 60, 4);
      EXPECT_LT(visibleOf(culler, views[0]).size(), count);
      live.become(smallCity());
      ASSERT_GT(live.demo.bounds.size(), count);
      for (const View& view : views) {
        EXPECT_EQ(visibleOf(culler, view), firstObjects(live.demo.bounds.size())) << name;
        EXPECT_NE(culler.stats().scene_fault, nullptr);
        EXPECT_TRUE(culler.occludersUsed().empty());
        EXPECT_TRUE(culler.depthBuffer().reciprocal_depth.empty());
      }
      live.become(DemoScene{Scene{}});
      EXPECT_EQ(visibleOf(culler, views[0]), firstObjects(count)) << name;
      live.become(oneCopyMoved());
      culler.reset(live.demo.hierarchy(kind), live.demo.bounds, live.demo.occluders, live.databases(),
                   live.sets.get());
      expectAsNew(culler, live, kind, settings, name);
    }
  }
}

TEST(Culler, KeepsEverythingWhereTheOccludersAreOthersWithoutReset) {
  for (const auto& [name, settings, stands_for_method] : allMethods()) {
    LiveScene live(oneCopy());
    AnyCuller culler = live.culler(HierarchyKind::kBvh, settings);
    const std::vector<View> views = live.demo.frames(live.demo.scene.paths[0], 60, 2);
    culler.cull(views[0]);
    live.demo.occluders = smallCity().occluders;
    const Box behind{Vec3f(views[1].eye - views[1].forward * 9.0),
                     Vec3f(views[1].eye - views[1].forward * 9.0)};
    const Box ahead{Vec3f(views[1].eye + views[1].forward * 90.0),
                    Vec3f(views[1].eye + views[1].forward * 90.0)};
    const Box dynamic_boxes[] = {behind, ahead};
    culler.cull(views[1], dynamic_boxes);
    EXPECT_EQ(Objects(culler.visible().begin(), culler.visible().end()),
              firstObjects(live.demo.bounds.size()));
    ASSERT_EQ(culler.dynamicStates().size(), 2u);
    EXPECT_EQ(culler.dynamicStates()[0], Visibility::kHidden) << "outside the frustum";
    EXPECT_EQ(culler.dynamicStates()[1], Visibility::kVisible) << name;
  }
}

TEST(Culler, KeepsEverythingInViewWhereTheSetsAreOthersWithoutReset) {
  const DemoScene& demo = oneCopy();
  const View view = demo.frames(demo.scene.paths[0], 60, 1)[0];
  AnyCuller frustum = demo.culler(HierarchyKind::kBvh, {.method = AnyMethod::kFrustum});
  for (const DemoScene* other : {&smallCity(), &smallBuilding()}) {
    for (AnySettings settings :
         {AnySettings{.method = AnyMethod::kVisibilityOctree},
          AnySettings{.occluder_count = 0, .visible_sets = true},
          AnySettings{.method = AnyMethod::kDepthPyramid, .occluder_count = 0, .visible_sets = true}}) {
      FakeSets sets(demo.bounds);
      sets.use(1, std::vector<bool>(demo.bounds.size(), false));
      AnyCuller culler(demo.bvh, demo.bounds, demo.occluders, settings, {}, &sets);
      EXPECT_TRUE(visibleOf(culler, view).empty());
      sets = FakeSets(other->bounds);
      sets.use(2, std::vector<bool>(other->bounds.size(), true));
      EXPECT_EQ(visibleOf(culler, view), visibleOf(frustum, view));
    }
  }
}

// Sets of which a part was replaced in place by an equal number of others.
class ReplacedInPart final : public VisibleSets {
 public:
  explicit ReplacedInPart(std::span<const Box> bounds) : tree_(buildBoxTree(bounds, {})), other_(tree_) {}

  bool other_nodes = false, other_objects = false;

  BoxTreeView boxes() const override {
    return {other_nodes ? other_.view().nodes : tree_.view().nodes,
            other_objects ? other_.view().objects : tree_.view().objects};
  }
  VisibleSet find(const Vec3d&, double) override { return {1, {}}; }

 private:
  BoxTree tree_, other_;
};

TEST(Culler, KeepsEverythingInViewWhereAPartOfTheSetsIsAnotherWithoutReset) {
  const DemoScene& demo = oneCopy();
  const View view = demo.frames(demo.scene.paths[0], 60, 1)[0];
  AnyCuller frustum = demo.culler(HierarchyKind::kBvh, {.method = AnyMethod::kFrustum});
  for (const bool nodes : {true, false}) {
    ReplacedInPart sets(demo.bounds);
    AnyCuller culler(demo.bvh, demo.bounds, demo.occluders, {.method = AnyMethod::kVisibilityOctree}, {},
                     &sets);
    EXPECT_TRUE(visibleOf(culler, view).empty());
    (nodes ? sets.other_nodes : sets.other_objects) = true;
    EXPECT_EQ(visibleOf(culler, view), visibleOf(frustum, view)) << nodes;
  }
}

// Boxes in front of and behind a wall, which is object 0; the view is from the origin along -z.
struct Street {
  std::vector<Box> bounds{
      {{-4, -4, -5}, {4, 4, -5}}, {{-1, -1, -12}, {1, 1, -10}}, {{-1, -1, 10}, {1, 1, 12}}};
  std::vector<Vec3f> corners{{-4, -4, -5}, {4, -4, -5}, {4, 4, -5}, {-4, 4, -5}};
  View view = test::kLookingBack;

  OccluderSet wallOf(ObjectId object) const {
    const OccluderPolygon wall{corners, false, object};
    return makeOccluders({&wall, 1});
  }
};

TEST(Culler, KeepsEverythingWhereTheHierarchyIsOfOtherBoxes) {
  const Street street;
  const OccluderSet occluders = street.wallOf(ObjectId(0u));
  for (const HierarchyKind kind : kKinds) {
    const Hierarchy fitting = buildHierarchy(street.bounds, {}, {.kind = kind, .max_leaf_objects = 1});
    std::vector<Box> more = street.bounds, moved = street.bounds, without_place = street.bounds;
    without_place[1].max.y = std::numeric_limits<float>::quiet_NaN();
    more.push_back({{2, 2, -3}, {3, 3, -2}});
    moved[1] = {{-1, 9, -12}, {1, 10, -10}};
    Hierarchy beyond = fitting, invalid = fitting, twice = fitting;
    beyond.objects.back() = ObjectId(70'000u);
    invalid.objects.back() = ObjectId();
    twice.objects.front() = twice.objects.back();
    for (const auto& [name, settings, stands_for_method] : allMethods()) {
      const auto keptBy = [&, &name = name, &settings = settings](const Hierarchy& hierarchy,
                                                                  std::span<const Box> bounds) {
        AnyCuller culler(hierarchy, bounds, occluders, settings);
        visibleOf(culler, street.view);
        const Objects kept = visibleOf(culler, street.view);
        EXPECT_NE(culler.stats().scene_fault, nullptr) << name;
        return kept;
      };
      AnyCuller culler(fitting, street.bounds, occluders, settings);
      EXPECT_LT(visibleOf(culler, street.view).size(), 3u) << name;
      EXPECT_EQ(culler.stats().scene_fault, nullptr) << name;
      EXPECT_EQ(keptBy(fitting, more), firstObjects(4)) << name;
      EXPECT_EQ(keptBy(fitting, std::span(street.bounds).first(1)), firstObjects(3)) << name;
      EXPECT_EQ(keptBy(fitting, moved), firstObjects(3)) << name;
      EXPECT_EQ(keptBy(fitting, without_place), firstObjects(3)) << name;
      Objects with_beyond = firstObjects(3);
      with_beyond.push_back(ObjectId(70'000u));
      EXPECT_EQ(keptBy(beyond, street.bounds), with_beyond) << name;
      EXPECT_EQ(keptBy(invalid, street.bounds), firstObjects(3)) << name;
      EXPECT_EQ(keptBy(twice, street.bounds), firstObjects(3)) << name;
      EXPECT_EQ(keptBy(Hierarchy{}, street.bounds), firstObjects(3)) << name;
    }
  }
}

TEST(Culler, OccludersOfObjectsBeyondTheBoxesAreNotLookedFor) {
  const Street street;
  const Hierarchy hierarchy = buildHierarchy(street.bounds, {});
  for (const ObjectId object : {ObjectId(3u), ObjectId(4'000'000'000u), ObjectId()}) {
    const OccluderSet occluders = street.wallOf(object);
    for (const auto& [name, settings, stands_for_method] : allMethods()) {
      AnyCuller culler(hierarchy, street.bounds, occluders, settings);
      EXPECT_EQ(visibleOf(culler, street.view), firstObjects(2)) << name;
    }
  }
}

TEST(Culler, ADatabaseOfOtherOccludersHidesNothingWrongly) {
  const DemoScene& demo = oneCopy();
  const ExactVisibility exact(demo.scene.view());
  ASSERT_GT(smallCity().occluders.occluders.size(), demo.occluders.occluders.size());
  for (const NamedSettings& method : kMethods) {
    AnySettings settings = method.settings;
    settings.use_lists = true;
    settings.detail_objects = true;
    AnyCuller culler(demo.bvh, demo.bounds, demo.occluders, settings, databasesOf(smallCity()));
    for (const View& view : demo.frames(demo.scene.paths[0], 60, 4)) {
      culler.cull(view);
      EXPECT_EQ(culler.stats().scene_fault, nullptr);
      expectTheSeenIsKept(exact, culler, view, method.name);
    }
  }
}

// Random walls and boxes that all change in each step, in the same memory and with the same counts.
struct RestlessScene {
  test::Random random{5};
  std::vector<test::OraclePolygon> walls;
  std::vector<Box> bounds;
  Hierarchy hierarchy;
  OccluderSet occluders;

  RestlessScene() : walls(6), bounds(6 + 60) { move(HierarchyKind::kBvh); }

  void move(HierarchyKind kind) {
    std::vector<OccluderPolygon> input;
    for (std::size_t w = 0; w < walls.size(); ++w) {
      const auto x = static_cast<float>(random.in(-9, 5)), y = static_cast<float>(random.in(-5, 1)),
                 z = static_cast<float>(random.in(-9, -5));
      walls[w] = test::wall(x, x + 5, y, y + 5, z);
      bounds[w] = {walls[w].vertices[0], walls[w].vertices[2]};
      input.push_back({walls[w].vertices, false, ObjectId(w)});
    }
    for (std::size_t i = walls.size(); i < bounds.size(); ++i) {
      const Vec3d middle(random.in(-15, 15), random.in(-8, 8), random.in(-25, -12));
      bounds[i] = {Vec3f(middle - Vec3d(0.4, 0.4, 0.4)), Vec3f(middle + Vec3d(0.4, 0.4, 0.4))};
    }
    hierarchy = buildHierarchy(bounds, {}, {.kind = kind, .max_leaf_objects = 1});
    occluders = makeOccluders(input);
  }
};

TEST(ResetCuller, HidesNothingThatARayReachesWhenAllMovedInPlace) {
  for (const HierarchyKind kind : kKinds) {
    for (const NamedSettings& structure : kStructures) {
      AnySettings settings = structure.settings;
      settings.raster = {.width = 256, .height = 256};
      RestlessScene scene;
      scene.move(kind);
      AnyCuller culler(scene.hierarchy, scene.bounds, scene.occluders, settings);
      std::size_t hidden = 0;
      for (int step = 0; step < 12; ++step) {
        for (int frame = 0; frame < 2; ++frame) {
          const Objects visible = visibleOf(culler, test::kLookingBack);
          EXPECT_EQ(culler.stats().scene_fault, nullptr);
          for (std::size_t i = 0; i < scene.bounds.size(); ++i) {
            if (std::binary_search(visible.begin(), visible.end(), ObjectId(i))) {
              continue;
            }
            ++hidden;
            EXPECT_FALSE(
                test::lookAt(scene.bounds[i], test::kLookingBack, scene.walls, 100, scene.random.engine())
                    .seen)
                << structure.name << " step " << step << " object " << i;
          }
        }
        scene.move(kind);
        culler.reset();
      }
      EXPECT_GT(hidden, 50u) << structure.name;
    }
  }
}

}  // namespace
}  // namespace sightline
