#include "src/culling/methods/focus_maps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "sightline/hierarchy/hierarchy.h"
#include "tests/culling/edge_scene.h"

namespace sightline::culling {
namespace {

using test::EdgeScene;

constexpr std::uint32_t kBoxes = 12;
constexpr double kEdge = 160.5, kOtherEdge = 40.5;  // pixels
constexpr FocusSettings kAtAnyPrice{.worth = 1e9};

// How windows draw the wall.
enum class Wall : std::uint8_t { kOccluder, kSurface, kMovingSurface };

struct Options {
  bool coherent = true;
  Wall wall = Wall::kOccluder;
  EdgeScene scene{};
  std::uint32_t others = 0;  // the first boxes are at the other edge
};

// Small boxes behind the edge of a wall, one above the other within one window. Object 0 is the wall, the
// boxes follow. A test says view by view which objects the first buffer kept.
class Boxes {
 public:
  explicit Boxes(const FocusSettings& settings, const Options& options = {})
      : options_(options),
        scene_(options.scene),
        surfaces_(options.wall == Wall::kOccluder ? SurfaceUse::kNone : SurfaceUse::kAlone, {}, 0.0,
                  nullptr) {
    walls_ = {scene_.wallBetween(100.0, kEdge), scene_.wallBetween(0.0, kOtherEdge)};
    bounds_ = {test::boundsOf(walls_[0])};
    for (std::uint32_t i = 1; i <= kBoxes; ++i) {
      bounds_.emplace_back();
      hide(i);
    }
    set_ = test::setOf(walls_);
    chosen_ = test::all(set_);
    if (options.wall == Wall::kOccluder) {
      occluders_ = {{&set_, chosen_}};
    }
    mesh_ = test::surfacesOf(walls_);
    hierarchy_ = buildHierarchy(bounds_, {});
    for (std::uint32_t i = 0; i <= kBoxes; ++i) {
      kept_.push_back(ObjectId(i));
    }
    const CullingScene scene{.hierarchy = &hierarchy_,
                             .object_bounds = bounds_,
                             .occluders = &set_,
                             .surfaces = options.wall == Wall::kSurface ? &mesh_ : nullptr};
    surfaces_.prepare(scene);
    maps_.emplace(settings, scene, EdgeScene::kWidth, EdgeScene::kHeight, options.coherent);
    buffer_.build(scene_.view, set_, chosen_);
  }

  // The first buffer cannot tell that the box is hidden, a finer one can.
  void hide(std::uint32_t box) { place(box, -0.7, -0.3); }
  // Part of a pixel of the box is beside the wall.
  void show(std::uint32_t box) { place(box, -0.1, 0.3); }
  // Many pixels of the box are beside the wall.
  void clear(std::uint32_t box) { place(box, 0.0, 60.0); }

  // Culls a view. Returns how many objects windows hid.
  std::uint32_t cull() {
    CullingFrame frame{.view = scene_.view, .frustum = frustumOf(scene_.view)};
    frame.jumped = jumped;
    frame.occluders = occluders_;
    frame.moving_surfaces = moving_;
    frame.last_visible = kept_;
    frame.parallel_for = &serial_;
    surfaces_.begin(frame);
    maps_->begin();
    left_ = kept_;
    maps_->refine({.buffer = buffer_,
                   .frame = frame,
                   .surfaces = surfaces_,
                   .surface_work = work,
                   .traversal = stats,
                   .changes_fast = changes},
                  left_);
    return maps_->hidden();
  }
  std::uint32_t windows() const { return maps_->windows(); }
  bool hidden(std::uint32_t box) const {
    return !std::binary_search(left_.begin(), left_.end(), ObjectId(box));
  }
  // Culls views until windows hide a box. Returns how many of them kept it, at most 100.
  std::uint32_t viewsUntilHidden(std::uint32_t box) {
    std::uint32_t views = 0;
    while (cull(), !hidden(box) && views < 100) {
      ++views;
    }
    return views;
  }

  // The first buffer hides these boxes, or keeps them again.
  void takeAway(std::uint32_t first) { kept_.resize(first); }
  void giveBack() {
    for (std::uint32_t i = static_cast<std::uint32_t>(kept_.size()); i <= kBoxes; ++i) {
      kept_.push_back(ObjectId(i));
    }
  }

  const EdgeScene& scene() const { return scene_; }
  const SurfaceSet& mesh() const { return mesh_; }
  void setOccluders(std::vector<ChosenOccluders> occluders) { occluders_ = std::move(occluders); }
  std::span<const ChosenOccluders> occluders() const { return occluders_; }
  void setMoving(std::vector<MovingSurfaces> moving) { moving_ = std::move(moving); }

  bool jumped = false, changes = false;
  double work = 1e6;
  CullStats stats;

 private:
  // left, right: pixels from the edge.
  void place(std::uint32_t box, double left, double right) {
    const double row = 83.0 + box, edge = box <= options_.others ? kOtherEdge : kEdge;
    bounds_[box] = scene_.boxBetween(edge + left, edge + right, row + 0.2, row + 0.8);
  }

  Options options_;
  EdgeScene scene_;
  std::vector<test::OraclePolygon> walls_;
  std::vector<Box> bounds_;
  OccluderSet set_;
  std::vector<OccluderId> chosen_;
  std::vector<ChosenOccluders> occluders_;
  SurfaceSet mesh_;
  std::vector<MovingSurfaces> moving_;
  Hierarchy hierarchy_;
  std::vector<ObjectId> kept_, left_;
  ParallelFor serial_ = serialFor;
  SurfaceDrawer surfaces_;
  std::optional<FocusMaps> maps_;
  DepthPyramid buffer_{{.raster = {.width = EdgeScene::kWidth, .height = EdgeScene::kHeight}}};
};

TEST(FocusMaps, LooksForNewDoubtsInEveryFourthView) {
  Boxes boxes(kAtAnyPrice);
  boxes.takeAway(kBoxes);
  EXPECT_EQ(boxes.cull(), kBoxes - 1);
  boxes.giveBack();
  for (int view = 1; view < 4; ++view) {
    EXPECT_EQ(boxes.cull(), kBoxes - 1) << "what it hid once it looks at again, view " << view;
  }
  EXPECT_EQ(boxes.cull(), kBoxes);
  EXPECT_EQ(boxes.cull(), kBoxes);
}

TEST(FocusMaps, LooksForNewDoubtsAtOnceAfterAJumpAndInAViewThatChangesFast) {
  for (const bool jumped : {false, true}) {
    Boxes boxes(kAtAnyPrice);
    boxes.takeAway(kBoxes);
    boxes.cull();
    boxes.giveBack();
    boxes.jumped = jumped;
    boxes.changes = !jumped;
    EXPECT_EQ(boxes.cull(), kBoxes);
  }
}

TEST(FocusMaps, LooksForDoubtsMoreRarelyWhereThereWereNoneButWithin32Views) {
  std::uint32_t longest = 0;
  for (int views = 1; views < 80; ++views) {
    Boxes boxes(kAtAnyPrice);
    boxes.takeAway(1);
    for (int view = 0; view < views; ++view) {
      EXPECT_EQ(boxes.cull(), 0u);
    }
    boxes.giveBack();
    longest = std::max(longest, boxes.viewsUntilHidden(1));
  }
  EXPECT_LT(longest, 32u);
  EXPECT_GT(longest, 16u);
}

TEST(FocusMaps, LetsRestWhatCouldBeSeenInAWindow) {
  Boxes boxes(kAtAnyPrice);
  boxes.show(1);
  EXPECT_EQ(boxes.cull(), kBoxes - 1);
  boxes.hide(1);
  // Without a rest it would be found by the next search, in the fourth view.
  EXPECT_GT(boxes.viewsUntilHidden(1), 3u);
}

TEST(FocusMaps, LetsRestWhatShowsInManyPixelsAlsoIfItHidItBefore) {
  for (const bool hidden_before : {false, true}) {
    Boxes boxes(kAtAnyPrice);
    if (hidden_before) {
      EXPECT_EQ(boxes.cull(), kBoxes);
    }
    boxes.jumped = true;  // so that it is looked at in this view
    boxes.clear(1);
    EXPECT_EQ(boxes.cull(), kBoxes - 1);
    boxes.jumped = false;
    boxes.hide(1);
    const std::uint32_t views = boxes.viewsUntilHidden(1);
    EXPECT_GE(views, 19u) << hidden_before;
    EXPECT_LE(views, 31u) << hidden_before;
  }
}

TEST(FocusMaps, WithoutCoherenceLooksAtEachObjectInEachView) {
  Boxes boxes(kAtAnyPrice, {.coherent = false});
  boxes.show(1);
  boxes.clear(2);
  boxes.takeAway(kBoxes);
  EXPECT_EQ(boxes.cull(), kBoxes - 3);
  boxes.giveBack();
  EXPECT_EQ(boxes.cull(), kBoxes - 2);
  boxes.hide(1);
  boxes.hide(2);
  EXPECT_EQ(boxes.cull(), kBoxes);
}

// Twelve boxes that were never tried count half each. An object costs a fifth of what a window does.
TEST(FocusMaps, DrawsAWindowInVainAgainAndAgainOnlyWithoutCoherence) {
  for (const bool coherent : {false, true}) {
    Boxes boxes({.worth = 1.0}, {.coherent = coherent});
    boxes.work = (kBoxes + 1) * 120.0;
    for (std::uint32_t i = 1; i <= kBoxes; ++i) {
      boxes.show(i);
    }
    std::uint32_t windows = 0;
    for (int view = 0; view < 20; ++view) {
      EXPECT_EQ(boxes.cull(), 0u);
      windows += boxes.windows();
    }
    EXPECT_EQ(windows, coherent ? 1u : 20u);
  }
}

// Most boxes lie so far off-centre that there is no window for them.
TEST(FocusMaps, DrawsTheNextWindowWhereThereIsNoneInTheBestPlace) {
  Options options{.scene = EdgeScene(true), .others = 4};
  options.scene.view.shift_x = 50.4;  // a window is a twentieth of the picture: at most 50 are possible
  Boxes boxes(kAtAnyPrice, options);
  EXPECT_EQ(boxes.cull(), 4u);
  EXPECT_TRUE(boxes.hidden(1));
  EXPECT_FALSE(boxes.hidden(kBoxes));
}

TEST(FocusMaps, CountsTheTestsOfBoxesAsWorkThatAnObjectCosts) {
  Boxes boxes({.worth = 1.0});
  boxes.work = 0.0;
  EXPECT_EQ(boxes.cull(), 0u);
  Boxes tested({.worth = 1.0});
  tested.work = 0.0;
  tested.stats.objects_tested = 100'000;
  EXPECT_EQ(tested.cull(), kBoxes);
}

// A window that costs 3,000 raises what the next one is expected to cost from 600 to about 760.
TEST(FocusMaps, ForgetsAfterSomeViewsThatAWindowWasDear) {
  Boxes boxes({.worth = 1.0}, {.coherent = false});
  boxes.setOccluders(std::vector<ChosenOccluders>(300, boxes.occluders()[0]));
  // Twelve boxes count half each. An object costs a sixth of 630.
  boxes.work = (kBoxes + 1) * 105.0 - 10.0;
  EXPECT_EQ(boxes.cull(), kBoxes);
  std::uint32_t views = 0;
  while (boxes.cull() == 0 && views < 200) {
    ++views;
  }
  EXPECT_GT(views, 10u);
  EXPECT_LT(views, 100u);
}

// What a window draws first, left of the boxes, takes all that it may cost.
TEST(FocusMaps, DrawsNoMoreOfSurfacesThanAWindowMayCost) {
  struct {
    Wall wall;
    bool after_occluders;  // otherwise after surfaces that move
  } cases[] = {{Wall::kSurface, true}, {Wall::kMovingSurface, true}, {Wall::kMovingSurface, false}};
  for (const auto& [wall, after_occluders] : cases) {
    for (const double work : {0.0, 1e6}) {
      Boxes boxes(kAtAnyPrice, {.wall = wall});
      boxes.work = work;
      // Each nearer than the one before, so that all are drawn.
      const std::vector<test::OraclePolygon> first{boxes.scene().wallBetween(100.0, 155.0, 9.0),
                                                   boxes.scene().wallBetween(100.0, 155.0, 8.0),
                                                   boxes.scene().wallBetween(100.0, 155.0, 7.0)};
      const OccluderSet set = test::setOf(first);
      const std::vector<OccluderId> chosen = test::all(set);
      std::vector<SurfaceSet> meshes;
      for (const test::OraclePolygon& polygon : first) {
        meshes.push_back(test::surfacesOf({&polygon, 1}));
      }
      std::vector<MovingSurfaces> moving;
      if (after_occluders) {
        boxes.setOccluders({{&set, chosen}});
      } else {
        for (const SurfaceSet& mesh : meshes) {
          moving.push_back({.surfaces = &mesh});
        }
      }
      if (wall == Wall::kMovingSurface) {
        moving.push_back({.surfaces = &boxes.mesh()});
      }
      boxes.setMoving(moving);
      EXPECT_EQ(boxes.cull(), work > 0.0 ? kBoxes : 0u) << static_cast<int>(wall) << " " << after_occluders;
      EXPECT_EQ(boxes.windows(), 1u);
    }
  }
}

}  // namespace
}  // namespace sightline::culling
