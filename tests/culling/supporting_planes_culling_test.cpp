// Culling with supporting planes: kept relations do not change results and live as long as they should, both
// forms give the same results, and joint occlusion never keeps more objects. Also tests the occluder database
// and the second test of detail objects.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "tests/culling/ray_judge.h"
#include "tests/occlusion/small_scenes.h"
#include "tests/support/rounds.h"

namespace sightline {
namespace {

using namespace demo_frames;

constexpr AnySettings kThroughEye{.method = AnyMethod::kSupportingPlanes};

AnySettings throughBox(bool kept = true, std::size_t relation_bytes = 64u << 20) {
  AnySettings settings{.method = AnyMethod::kKeptPlanes};
  settings.kept_planes.relation_bytes = relation_bytes;
  settings.temporal_coherence = kept;
  return settings;
}

RelationStats relationsOf(const AnyCuller& culler) {
  const auto count = [&](const char* name) {
    return static_cast<std::uint32_t>(culler.statistic("relations", name));
  };
  return {.reused = count("reused"),
          .unchanged = count("unchanged"),
          .rebuilt = count("rebuilt"),
          .evicted = count("evicted"),
          .dropped = count("dropped"),
          .kept = count("kept"),
          .bytes = count("bytes")};
}

bool sameVisible(const AnyCuller& a, const AnyCuller& b) {
  return std::equal(a.visible().begin(), a.visible().end(), b.visible().begin(), b.visible().end());
}

// Whether culler a keeps no object that culler b culls.
bool keepsNoMore(const AnyCuller& a, const AnyCuller& b) {
  return std::includes(b.visible().begin(), b.visible().end(), a.visible().begin(), a.visible().end());
}

std::size_t notKeptBy(const AnyCuller& a, const AnyCuller& b) {
  return static_cast<std::size_t>(std::count_if(b.visible().begin(), b.visible().end(),
                                                [&](ObjectId object) { return !isKept(a, object); }));
}

// Turns a view to the left about the vertical axis.
View turned(View view, double angle_deg) {
  const double angle = angle_deg * std::numbers::pi / 180.0;
  const Vec3d up(0, 0, 1), forward = view.forward;
  setOrientation(view, forward * std::cos(angle) + cross(up, forward) * std::sin(angle), up);
  return view;
}

// Turns a view once around on the spot, and back.
std::vector<View> turnsOnTheSpot(const View& view, double step_deg) {
  std::vector<View> views;
  const int steps = static_cast<int>(360.0 / step_deg);
  for (int i = 0; i <= 2 * steps; ++i) {
    views.push_back(turned(view, step_deg * std::min(i, 2 * steps - i)));
  }
  return views;
}

// Returns views with random small steps and turns, some of them with none.
std::vector<View> randomWalk(View view, std::uint64_t seed, std::size_t count) {
  std::mt19937_64 random(seed);
  const auto in = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
  };
  std::vector<View> views;
  for (std::size_t i = 0; i < count; ++i) {
    if (i % 7 != 6) {
      const double stride = std::pow(10.0, in(-4.0, 0.3));
      view.eye = view.eye + Vec3d(in(-1, 1), in(-1, 1), in(-0.2, 0.2)) * stride;
      view = turned(view, in(-20, 20));
    }
    views.push_back(view);
  }
  return views;
}

// Returns the views with alternating projections, each for a few frames.
std::vector<View> switchingProjection(std::vector<View> views) {
  for (std::size_t i = 0; i < views.size(); ++i) {
    views[i].orthographic = i / 4 % 2 == 1;
    views[i].ortho_height = 12.0;
  }
  return views;
}

// Returns all of these sequences of views, one after another.
std::vector<View> restlessViews(const DemoScene& demo, std::uint64_t seed) {
  const std::vector<View> walk = demo.frames(demo.scene.paths[0], 60, 24);
  std::vector<View> all = walk;
  for (const std::vector<View>& part :
       {turnsOnTheSpot(walk[20], 20.0), randomWalk(walk[5], seed, 40), jumps(demo, seed, 12),
        switchingProjection({walk.begin(), walk.begin() + 16}), std::vector<View>(3, walk[10])}) {
    all.insert(all.end(), part.begin(), part.end());
  }
  return all;
}

// What a culler said of its last view, and how much it tested for that.
struct AnswerAndWork {
  std::vector<ObjectId> visible;
  std::uint64_t nodes_tested, objects_tested;

  explicit AnswerAndWork(const AnyCuller& culler)
      : visible(culler.visible().begin(), culler.visible().end()),
        nodes_tested(culler.stats().nodes_tested),
        objects_tested(culler.stats().objects_tested) {}
  bool operator==(const AnswerAndWork&) const = default;
};

class OnDemoScenes : public testing::TestWithParam<const DemoScene& (*)()> {
 protected:
  const DemoScene& demo() const { return GetParam()(); }
  std::vector<View> walk(std::size_t first, std::size_t count) const {
    return demo().frames(demo().scene.paths[0], first, count);
  }
};

class KeptRelations : public OnDemoScenes {};
class TwoForms : public OnDemoScenes {};
class DatabaseChoice : public OnDemoScenes {};
class DetailObjects : public OnDemoScenes {};

const auto kScenes = testing::Values(&smallCity, &smallBuilding);
const auto kSceneName = [](const auto& info) { return info.index == 0 ? "City" : "Building"; };
INSTANTIATE_TEST_SUITE_P(, KeptRelations, kScenes, kSceneName);
INSTANTIATE_TEST_SUITE_P(, TwoForms, kScenes, kSceneName);
INSTANTIATE_TEST_SUITE_P(, DatabaseChoice, kScenes, kSceneName);
INSTANTIATE_TEST_SUITE_P(, DetailObjects, kScenes, kSceneName);

TEST_P(KeptRelations, ChangeNoAnswerWithTheDatabaseAndTheSecondTest) {
  const std::vector<View> views = restlessViews(demo(), 32);
  for (const HierarchyKind kind : kKinds) {
    AnySettings kept_settings = throughBox(), new_settings = throughBox(false);
    for (AnySettings* settings : {&kept_settings, &new_settings}) {
      settings->use_lists = true;
      settings->detail_objects = true;
    }
    AnyCuller with = demo().culler(kind, kept_settings), without = demo().culler(kind, new_settings);
    for (std::size_t i = 0; i < views.size(); ++i) {
      with.cull(views[i]);
      without.cull(views[i]);
      EXPECT_TRUE(AnswerAndWork(with) == AnswerAndWork(without)) << nameOf(kind) << ", view " << i;
    }
  }
}

// Size of the table of items: two 4-byte entries per node, per leaf entry and per object.
std::size_t itemTableBytes(const DemoScene& demo, HierarchyKind kind) {
  const Hierarchy& hierarchy = demo.hierarchy(kind);
  return 8 * (hierarchy.nodes.size() + hierarchy.objects.size() + demo.bounds.size());
}

TEST_P(KeptRelations, ChangeNoAnswerAndStayWithinTheirRoomInEveryFrame) {
  const std::vector<View> views = restlessViews(demo(), 31);
  for (const HierarchyKind kind : kKinds) {
    AnyCuller without = demo().culler(kind, throughBox(false));
    std::vector<AnswerAndWork> expected;
    for (const View& view : views) {
      without.cull(view);
      expected.emplace_back(without);
    }
    EXPECT_EQ(without.statistic("relations", "kept") + without.statistic("relations", "reused"), 0u);
    for (const std::size_t bytes : {0u, 1000u, 20'000u, 100'000u, 64u << 20}) {
      const std::string where = nameOf(kind) + " bytes " + std::to_string(bytes);
      AnyCuller with = demo().culler(kind, throughBox(true, bytes));
      std::size_t evicted = 0;
      for (std::size_t i = 0; i < views.size(); ++i) {
        with.cull(views[i]);
        EXPECT_TRUE(AnswerAndWork(with) == expected[i]) << where << ", view " << i;
        EXPECT_LE(with.statistic("relations", "bytes"), bytes + itemTableBytes(demo(), kind)) << where;
        evicted += with.statistic("relations", "evicted");
      }
      if (bytes <= 20'000u) {
        EXPECT_GT(evicted, 100u) << where;
      }
      EXPECT_EQ(with.statistic("relations", "kept") > 0, bytes > 0) << where;
    }
  }
}

TEST_P(KeptRelations, AreThoseThatWereMadeLessThoseThatWent) {
  for (const HierarchyKind kind : kKinds) {
    for (const std::size_t bytes : {100'000u, 64u << 20}) {
      AnyCuller culler = demo().culler(kind, throughBox(true, bytes));
      std::uint32_t before = 0;
      std::size_t dropped = 0, evicted = 0;
      for (const View& view : walk(40, 80)) {
        culler.cull(view);
        const RelationStats relations = relationsOf(culler);
        dropped += relations.dropped;
        evicted += relations.evicted;
        EXPECT_LE(relations.unchanged, relations.reused);
        // The number is smaller if a relation was made again.
        EXPECT_LE(relations.kept + relations.dropped + relations.evicted, before + relations.rebuilt);
        before = relations.kept;
      }
      EXPECT_GT(dropped + evicted, 0u);
      EXPECT_EQ(evicted > 0, bytes == 100'000u);
      culler.reset();
      culler.cull(walk(40, 1)[0]);
      EXPECT_EQ(culler.statistic("relations", "reused"), 0u);
    }
  }
}

TEST_P(KeptRelations, StayWhenTheViewerTurnsAwayAndBack) {
  for (const HierarchyKind kind : kKinds) {
    AnyCuller culler = demo().culler(kind, throughBox());
    const View ahead = walk(100, 1)[0];
    std::size_t first_time = 0, reused = 0, rebuilt = 0;
    const std::vector<View> views = turnsOnTheSpot(ahead, 10.0);
    for (std::size_t i = 0; i < views.size(); ++i) {
      culler.cull(views[i]);
      const RelationStats relations = relationsOf(culler);
      const bool back = i > views.size() / 2;
      first_time += back ? 0 : relations.rebuilt;
      reused += back ? relations.reused : 0;
      rebuilt += back ? relations.rebuilt : 0;
    }
    EXPECT_LT(rebuilt, first_time) << nameOf(kind);
    EXPECT_GT(reused, 10 * rebuilt) << nameOf(kind);
  }
}

struct Work {
  double unchanged = 0.0, rebuilt = 0.0;  // parts of all relations that were looked at

  static Work of(AnyCuller& culler, std::span<const View> walk, std::size_t step) {
    double looks = 0.0;
    Work work;
    for (std::size_t i = 0; i < walk.size(); i += step) {
      culler.cull(walk[i]);
      const RelationStats relations = relationsOf(culler);
      looks += relations.reused + relations.rebuilt;
      work.unchanged += relations.unchanged;
      work.rebuilt += relations.rebuilt;
    }
    return {work.unchanged / looks, work.rebuilt / looks};
  }
};

TEST_P(KeptRelations, SaveLessTheFasterTheWalk) {
  const std::vector<View> views = walk(50, 208);
  for (const HierarchyKind kind : kKinds) {
    std::array<Work, 3> work;
    for (std::size_t i = 0; i < work.size(); ++i) {
      AnyCuller culler = demo().culler(kind, throughBox());
      work[i] = Work::of(culler, views, std::array{1, 4, 16}[i]);
    }
    for (std::size_t i = 1; i < work.size(); ++i) {
      EXPECT_LT(work[i].unchanged, work[i - 1].unchanged) << nameOf(kind) << " " << i;
      EXPECT_GT(work[i].rebuilt, work[i - 1].rebuilt) << nameOf(kind) << " " << i;
    }
    EXPECT_GT(work[0].unchanged, 0.2) << nameOf(kind);
    EXPECT_LT(work[0].rebuilt, 0.3) << nameOf(kind);
  }
}

// A wall of 8 x 8 metres at z = -5, and behind it a row of boxes that continues to the right of the wall.
struct RowScene {
  std::vector<Box> bounds{{{-4, -4, -5}, {4, 4, -5}}};
  Hierarchy hierarchy;
  OccluderSet occluders = test::setOf(std::vector{test::wall(-4, 4, -4, 4, -5)});
  View view;  // from the origin, along -z: the row is hidden in part

  RowScene() {
    for (int i = 0; i < 8; ++i) {
      const float x = 2.0f * static_cast<float>(i);
      bounds.push_back({{x, -1, -12}, {x + 1, 1, -10}});
    }
    hierarchy = buildHierarchy(bounds, {}, {.max_leaf_objects = 1});
    setOrientation(view, {0, 0, -1}, {0, 1, 0});
    view.tan_half_fovy = 10.0;
    view.aspect = 1.0;
    view.z_near = 0.1;
    view.z_far = 100.0;
  }
  View from(const Vec3d& eye) const {
    View moved = view;
    moved.eye = eye;
    return moved;
  }
};

// The culler's work at another view, and then again at the scene's view.
struct ThereAndBack {
  RelationStats first, there, back;

  ThereAndBack(const RowScene& scene, const View& elsewhere) {
    AnyCuller culler(scene.hierarchy, scene.bounds, scene.occluders, throughBox());
    culler.cull(scene.view);
    first = relationsOf(culler);
    culler.cull(elsewhere);
    there = relationsOf(culler);
    culler.cull(scene.view);
    back = relationsOf(culler);
  }
};

TEST(KeptRelationsOfARow, GoWhenANodeAboveThemBecomesHidden) {
  const RowScene scene;
  const ThereAndBack result(scene, scene.from({0, 0, -4}));
  EXPECT_GT(result.there.dropped, 0u);
  EXPECT_LT(result.there.kept, result.first.kept);
  EXPECT_GT(result.back.rebuilt, 0u);
  EXPECT_EQ(result.back.kept, result.first.kept);
}

TEST(KeptRelationsOfARow, GoWhenANodeAboveThemBecomesVisible) {
  const RowScene scene;
  const ThereAndBack result(scene, scene.from({30, 0, 0}));
  EXPECT_GT(result.there.dropped, 0u);
  EXPECT_LE(result.there.kept, 2u) << "those of the root and of the row";
  EXPECT_GE(result.back.rebuilt + result.there.kept, result.first.rebuilt);
}

TEST(KeptRelationsOfARow, StayWhileTheyAreOutsideTheFrustum) {
  const RowScene scene;
  View away = scene.view;
  setOrientation(away, {0, 0, 1}, {0, 1, 0});
  const ThereAndBack result(scene, away);
  EXPECT_EQ(result.there.dropped, 0u);
  EXPECT_EQ(result.there.kept, result.first.kept);
  EXPECT_EQ(result.back.rebuilt, 0u);
  EXPECT_EQ(result.back.reused, result.first.rebuilt);
  EXPECT_EQ(result.back.unchanged, result.back.reused) << "the eye has not moved";
}

TEST(KeptRelationsOfARow, AreNeitherMadeNorKeptForPlanesThroughTheEye) {
  const RowScene scene;
  AnyCuller culler(scene.hierarchy, scene.bounds, scene.occluders, kThroughEye);
  for (int frame = 0; frame < 3; ++frame) {
    culler.cull(scene.view);
    const RelationStats relations = relationsOf(culler);
    EXPECT_EQ(relations.rebuilt + relations.reused + relations.kept, 0u);
    EXPECT_EQ(relations.bytes, 0u);
  }
}

// Returns random views, each a jump, and views along the camera path.
std::vector<View> places(const DemoScene& demo, std::size_t step) {
  std::vector<View> views = jumps(demo, 34, 20);
  const CameraPath& path = demo.scene.paths[0];
  const std::size_t frames = test::rounds(path.frames.size());
  for (std::size_t f = 0; f < frames; f += step) {
    views.push_back(path.view(f, demo.scene.origin));
  }
  return views;
}

TEST_P(TwoForms, HideTheSameButForTheirMargins) {
  for (const HierarchyKind kind : kKinds) {
    AnyCuller eye = demo().culler(kind, kThroughEye);
    AnyCuller box = demo().culler(kind, {.method = AnyMethod::kKeptPlanes});
    std::size_t objects = 0, different = 0;
    for (const View& view : places(demo(), 10)) {
      for (Culler* culler : {&eye, &box}) {
        culler->reset();  // the same occluders for both
        culler->cull(view);
      }
      objects += eye.visible().size();
      different += notKeptBy(eye, box) + notKeptBy(box, eye);
    }
    EXPECT_LE(100 * different, objects) << nameOf(kind) << " " << different << " of " << objects;
  }
}

TEST_P(TwoForms, HideAllThatSingleOccludersHideWhenTheyJoin) {
  for (const HierarchyKind kind : kKinds) {
    for (const AnyMethod method : {AnyMethod::kSupportingPlanes, AnyMethod::kKeptPlanes}) {
      AnySettings settings{.method = method};
      AnyCuller joint = demo().culler(kind, settings);
      settings.supporting_planes.joint_occlusion = settings.kept_planes.joint_occlusion = false;
      AnyCuller single = demo().culler(kind, settings);
      std::size_t more = 0;
      for (const View& view : places(demo(), 10)) {
        for (Culler* culler : {&joint, &single}) {
          culler->reset();
          culler->cull(view);
        }
        EXPECT_TRUE(keepsNoMore(joint, single)) << nameOf(kind);
        more += notKeptBy(joint, single);
      }
      EXPECT_GT(more, 0u) << nameOf(kind) << " method " << static_cast<int>(method);
    }
  }
}

TEST_P(DatabaseChoice, UsesTheListOfTheCellAndTheDirection) {
  for (const NamedSettings& method : kMethods) {
    AnySettings settings = method.settings;
    settings.use_lists = true;
    settings.occluder_count = 32;
    AnyCuller culler = demo().culler(HierarchyKind::kBvh, settings);
    std::size_t used = 0;
    for (const View& view : places(demo(), 20)) {
      culler.cull(view);
      const std::span<const OccluderId> list = demo().database().find(view.eye, view.forward);
      EXPECT_LE(culler.occludersUsed().size(), 32u);
      for (const OccluderId id : culler.occludersUsed()) {
        EXPECT_NE(std::find(list.begin(), list.end(), id), list.end()) << method.name;
      }
      used += culler.occludersUsed().size();
    }
    EXPECT_GT(used, 100u) << method.name;
  }
}

TEST_P(DatabaseChoice, HidesMuchOfWhatTheFrustumHolds) {
  for (const NamedSettings& method : kMethods) {
    AnySettings settings = method.settings;
    settings.use_lists = true;
    AnyCuller culler = demo().culler(HierarchyKind::kBvh, settings);
    AnyCuller frustum = demo().culler(HierarchyKind::kBvh, {.method = AnyMethod::kFrustum});
    std::size_t kept_objects = 0, in_frustum = 0;
    for (const View& view : walk(80, 40)) {
      culler.cull(view);
      frustum.cull(view);
      kept_objects += culler.visible().size();
      in_frustum += frustum.visible().size();
    }
    EXPECT_LT(kept_objects, in_frustum * 7 / 10) << method.name;
  }
}

TEST_P(DatabaseChoice, IsByAreaAngleWithoutADatabase) {
  for (const NamedSettings& method : kMethods) {
    AnySettings settings = method.settings;
    AnyCuller by_area_angle = demo().culler(HierarchyKind::kBvh, settings);
    settings.use_lists = true;
    settings.detail_objects = true;
    AnyCuller without(demo().bvh, demo().bounds, demo().occluders, settings);
    for (const View& view : restlessViews(demo(), 35)) {
      by_area_angle.cull(view);
      without.cull(view);
      EXPECT_TRUE(sameVisible(without, by_area_angle)) << method.name;
      EXPECT_EQ(without.statistic("detail", "tested"), 0u);
    }
  }
}

// The choice from the database does not depend on the last frame, so both cullers use the same occluders.
TEST_P(DetailObjects, ShrinkTheAnswerByThoseThatTheSecondTestHides) {
  for (const HierarchyKind kind : kKinds) {
    for (const NamedSettings& method : kMethods) {
      AnySettings settings = method.settings;
      settings.use_lists = true;
      settings.detail_occluder_count = 32;
      AnyCuller without = demo().culler(kind, settings);
      settings.detail_objects = true;
      AnyCuller with = demo().culler(kind, settings);
      std::size_t culled = 0;
      for (const View& view : walk(100, test::rounds(60u))) {
        without.cull(view);
        with.cull(view);
        const CullStats& stats = with.stats();
        EXPECT_TRUE(keepsNoMore(with, without));
        EXPECT_EQ(with.statistic("detail", "tested"), without.visible().size());
        EXPECT_EQ(with.visible().size() + with.statistic("detail", "culled"), without.visible().size());
        EXPECT_EQ(stats.nodes_tested, without.stats().nodes_tested);
        EXPECT_EQ(without.statistic("detail", "tested") + without.statistic("detail", "culled"), 0u);
        culled += with.statistic("detail", "culled");
      }
      EXPECT_GT(culled, 0u) << nameOf(kind) << " " << method.name;
    }
  }
}

TEST_P(DetailObjects, WithoutOccludersNearThemAreNotHidden) {
  for (const NamedSettings& method : kMethods) {
    AnySettings settings = method.settings;
    settings.detail_objects = true;
    settings.detail_occluder_count = 0;
    AnyCuller culler = demo().culler(HierarchyKind::kBvh, settings);
    for (const View& view : walk(100, 5)) {
      culler.cull(view);
      EXPECT_GT(culler.statistic("detail", "tested"), 0u);
      EXPECT_EQ(culler.statistic("detail", "culled"), 0u);
    }
  }
}

TEST_P(DetailObjects, LeaveTheOccludersOfTheWalkAsTheyAre) {
  AnySettings settings = kThroughEye;
  settings.use_lists = true;
  AnyCuller without = demo().culler(HierarchyKind::kBvh, settings);
  settings.detail_objects = true;
  AnyCuller with = demo().culler(HierarchyKind::kBvh, settings);
  for (const View& view : walk(100, 20)) {
    without.cull(view);
    with.cull(view);
    EXPECT_TRUE(std::equal(with.occludersUsed().begin(), with.occludersUsed().end(),
                           without.occludersUsed().begin(), without.occludersUsed().end()));
    EXPECT_EQ(with.stats().occluders, without.stats().occluders);
  }
}

}  // namespace
}  // namespace sightline
