// Drawings of scenes: what is drawn over what, and which lines are tested against which objects.

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <set>

#include "scenes/moving_scene.h"
#include "sightline/drawing/drawing.h"
#include "tests/drawing/page_geometry.h"
#include "tests/support/layer_shapes.h"
#include "tests/support/solids.h"

namespace sightline {
namespace {

using shapes::Random;
using test::distanceTo;
using test::isInside;
using test::lengthOf;
using test::Solid;

constexpr double kHeight = 400.0;

// Solids that are objects of a scene and parts of a sorter.
struct Set {
  MovingScene moving;

  Set() {
    moving.scene.materials.push_back({.name = "opaque"});
    moving.scene.materials.push_back({.name = "glass", .opacity = Opacity::kBlended});
  }
  void add(const Solid& solid, bool opaque = true, PartSettings::Place place = PartSettings::Place::kSorted) {
    Scene& scene = moving.scene;
    Object object{.first_index = static_cast<std::uint32_t>(scene.indices.size()),
                  .material = MaterialId{opaque ? 0u : 1u}};
    const auto first = static_cast<std::uint32_t>(scene.positions.size());
    scene.positions.insert(scene.positions.end(), solid.points.begin(), solid.points.end());
    for (const std::vector<std::uint32_t>& face : solid.faces) {
      for (std::size_t i = 2; i < face.size(); ++i) {
        scene.indices.insert(scene.indices.end(), {first + face[0], first + face[i - 1], first + face[i]});
      }
    }
    object.index_count = static_cast<std::uint32_t>(scene.indices.size()) - object.first_index;
    scene.objects.push_back(object);
    scene.object_names.push_back("solid " + std::to_string(scene.objects.size() - 1));
    const std::vector<Vec3d> points(solid.points.begin(), solid.points.end());
    moving.parts.push_back({.name = scene.object_names.back(),
                            .hulls = {static_cast<std::uint32_t>(moving.hulls.size())},
                            .settings = {.place = place}});
    moving.hulls.push_back(*buildHull(points));
    updateBounds(scene);
  }
  LayerSorter sorter(bool all_arcs) const {
    return makeSorter(moving, {.arcs = all_arcs ? LayerArcs::kAll : LayerArcs::kWithinGroups});
  }
  Drawing paint(const View& view, const DrawingSettings& settings = {.page_height = kHeight}) const {
    LayerSorter sorter = this->sorter(false);
    return HiddenLineRenderer(moving.scene.view())
        .paint(moving.scene.view(), moving.scene.object_names, view, sorter.update(view), settings);
  }
  Drawing paintSeenFirst(const View& view) const {
    LayerSorter sorter = this->sorter(true);
    return HiddenLineRenderer(moving.scene.view())
        .paint(moving.scene.view(), moving.scene.object_names, view, sorter.update(view),
               {.page_height = kHeight, .seen_first = true});
  }
  Drawing plot(const View& view, const DrawingSettings& settings = {.page_height = kHeight}) const {
    LayerSorter sorter = this->sorter(true);
    return HiddenLineRenderer(moving.scene.view())
        .plot(moving.scene.view(), moving.scene.object_names, view, sorter.update(view), settings);
  }
};

View viewFromFront(bool orthographic = false) {
  View view = test::viewFromFront(orthographic);
  view.ortho_height = 12.0;
  view.aspect = 1.25;
  view.z_near = 0.5;
  view.z_far = 50.0;
  return view;
}

// A view that shows three sides of a box in the middle.
View viewOfACorner() {
  View view = viewFromFront();
  view.eye = {6, 5, 8};
  setOrientation(view, {-6, -5, -8}, {0, 1, 0});
  return view;
}

const DrawingObject* find(const Drawing& drawing, std::uint32_t id) {
  for (const DrawingGroup& group : drawing.groups) {
    for (const DrawingObject& object : group.objects) {
      if (object.object == ObjectId(id)) {
        return &object;
      }
    }
  }
  return nullptr;
}

std::vector<PagePath> strokesOf(const Drawing& drawing, std::uint32_t id) {
  const DrawingObject* object = find(drawing, id);
  return object != nullptr ? object->strokes : std::vector<PagePath>();
}

double lengthOfAll(const std::vector<PagePath>& strokes) {
  double sum = 0.0;
  for (const PagePath& stroke : strokes) {
    sum += lengthOf(stroke);
  }
  return sum;
}

// Boxes, prisms and Ls in random orientations, some of which intersect.
Set randomSet(std::uint64_t seed, int solids) {
  Random random(seed);
  Set set;
  for (int i = 0; i < solids; ++i) {
    const Vec3d x = random.direction();
    const Vec3d y = normalized(cross(x, random.direction()));
    const double size = random.number(0.3, 1.2);
    const Solid solid = i % 3 == 0   ? test::block({-1, -1, -1}, {1, 1, 1})
                        : i % 3 == 1 ? test::prism(6)
                                     : test::octahedron();
    set.add(test::placed(solid, random.point({-5, -4, -6}, {5, 4, 4}), x, y, {size, size, size}));
  }
  return set;
}

TEST(HiddenLineRenderer, PaintsFarGroupsFirstAndLeavesTheirStrokesWhole) {
  Set both, behind;
  both.add(test::block({-1, -1, 2}, {1, 1, 3}));
  both.add(test::block({-2, -2, -3}, {0.5f, 0.5f, -2}));
  behind.add(test::block({-2, -2, -3}, {0.5f, 0.5f, -2}));
  const Drawing drawing = both.paint(viewFromFront());
  ASSERT_EQ(drawing.groups.size(), 2u);
  EXPECT_EQ(drawing.groups[0].objects[0].object, ObjectId(1u));
  EXPECT_EQ(drawing.groups[1].objects[0].object, ObjectId(0u));
  EXPECT_EQ(drawing.groups[0].objects[0].strokes, strokesOf(behind.paint(viewFromFront()), 0));
  EXPECT_EQ(drawing.groups[0].objects[0].outline.size(), 1u);
  EXPECT_EQ(drawing.groups[0].objects[0].name, "solid 1");
  EXPECT_EQ(drawing.width, kHeight * 1.25);
  // In the plot it is broken.
  const Drawing plot = both.plot(viewFromFront());
  EXPECT_LT(lengthOfAll(strokesOf(plot, 1)), 0.9 * lengthOfAll(strokesOf(drawing, 1)));
  EXPECT_TRUE(find(plot, 1)->outline.empty());
}

TEST(HiddenLineRenderer, AConvexObjectIsOneOutlineAndFewStrokes) {
  Set set;
  set.add(test::block({-1, -1, -1}, {1, 1, 1}));
  const Drawing drawing = set.paint(viewOfACorner());
  const DrawingObject* box = find(drawing, 0);
  ASSERT_TRUE(box);
  ASSERT_EQ(box->outline.size(), 1u);
  EXPECT_EQ(box->outline[0].size(), 6u);
  // Nine edges: around, and the near corner's three, of which two are joined.
  EXPECT_EQ(box->strokes.size(), 3u);
  EXPECT_EQ(drawing.stats.lines, 9u);
}

TEST(HiddenLineRenderer, ObjectsThatOccludeEachOtherAreOneGroupWithLinesCut) {
  Set set;
  set.add(test::block({-3, -0.5f, -0.5f}, {3, 0.5f, 0.5f}));
  set.add(test::block({-0.5f, -3, -0.6f}, {0.5f, 3, 0.4f}));
  set.add(test::block({-4, -4, -9}, {4, 4, -8}));
  const Drawing drawing = set.paint(viewFromFront());
  ASSERT_EQ(drawing.groups.size(), 2u);
  ASSERT_EQ(drawing.groups[1].objects.size(), 2u);
  const std::vector<PagePath> upright = strokesOf(drawing, 1);
  // The front of the lying bar is nearer: nothing of the upright one is seen in its middle.
  const double middle = kHeight / 2.0;
  EXPECT_GT(distanceTo(upright, {middle * 1.25, middle}, false), 15.0);
  EXPECT_LT(drawing.pairs, drawing.all_pairs);
}

// A stroke that shows in the painted drawing is in the plot, and the other way round.
void expectPaintedIsPlotted(const Drawing& painted, const Drawing& plot, std::uint64_t seed) {
  constexpr double kNear = 0.05;
  std::size_t seen = 0, covered = 0;
  const auto samples = [&](const std::vector<PagePath>& strokes, const auto& check) {
    Random random(seed);
    for (const PagePath& stroke : strokes) {
      for (std::size_t i = 1; i < stroke.size(); ++i) {
        for (int k = 0; k < 6; ++k) {
          const double t = random.number(0, 1);
          check(PagePoint{stroke[i - 1].x + (stroke[i].x - stroke[i - 1].x) * t,
                          stroke[i - 1].y + (stroke[i].y - stroke[i - 1].y) * t});
        }
      }
    }
  };
  for (std::size_t i = 0; i < painted.groups.size(); ++i) {
    for (const DrawingObject& object : painted.groups[i].objects) {
      const std::vector<PagePath> plotted = strokesOf(plot, object.object.value);
      const auto isPaintedOver = [&](const PagePoint& p, bool& close) {
        bool over = false;
        for (std::size_t k = i + 1; k < painted.groups.size(); ++k) {
          for (const DrawingObject& later : painted.groups[k].objects) {
            over = over || isInside(later.outline, p);
            close = close || distanceTo(later.outline, p, true) < kNear;
          }
        }
        return over;
      };
      samples(object.strokes, [&](const PagePoint& p) {
        bool close = false;
        const bool over = isPaintedOver(p, close);
        const bool is_plotted = distanceTo(plotted, p, false) < kNear;
        if (!close) {
          EXPECT_EQ(is_plotted, !over)
              << "seed " << seed << ", object " << object.object.value << " at " << p.x << ", " << p.y;
          (over ? covered : seen) += 1;
        }
      });
      samples(plotted, [&](const PagePoint& p) {
        EXPECT_LT(distanceTo(object.strokes, p, false), kNear) << "seed " << seed;
        bool close = false;
        EXPECT_TRUE(!isPaintedOver(p, close) || close) << "seed " << seed;
      });
    }
  }
  EXPECT_GT(seen, 50u) << "seed " << seed;
  EXPECT_GT(covered, 0u) << "seed " << seed;
}

TEST(HiddenLineRenderer, PaintingShowsWhatThePlotDraws) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const Set set = randomSet(seed, 18);
    const View view = viewFromFront(seed % 2 == 0);
    expectPaintedIsPlotted(set.paint(view), set.plot(view), seed);
  }
}

// Boxes, prisms and Ls that pass through each other, so that many have no order, with some larger ones before
// them.
Set crowdedSet(std::uint64_t seed) {
  Set set = randomSet(seed, 40);
  Random random(seed + 1000);
  for (int i = 0; i < 3; ++i) {
    const Vec3d middle = random.point({-3, -2, 3}, {3, 2, 4});
    const Vec3f low(middle - Vec3d{1.5, 1.5, 0.2}), high(middle + Vec3d{1.5, 1.5, 0.2});
    set.add(test::block(low, high), i != 2);
  }
  return set;
}

TEST(HiddenLineRenderer, PaintingWhatIsSeenFirstShowsWhatThePlotDraws) {
  std::size_t smaller = 0;
  for (std::uint64_t seed = 21; seed <= 32; ++seed) {
    const Set set = crowdedSet(seed);
    View view = viewFromFront(seed % 2 == 0);
    if (seed % 3 == 0) {
      view.eye = {1, 1, 1};  // among them: some reach behind the eye and beside the page
    }
    const Drawing by_hulls = set.paint(view), seen_first = set.paintSeenFirst(view);
    expectPaintedIsPlotted(seen_first, set.plot(view), seed);
    EXPECT_LE(seen_first.largest_group, by_hulls.largest_group) << "seed " << seed;
    EXPECT_LE(seen_first.pairs, by_hulls.pairs) << "seed " << seed;
    smaller += seen_first.largest_group < by_hulls.largest_group ? 1 : 0;
    if (HasFailure()) {
      return;
    }
  }
  EXPECT_GT(smaller, 4u);
}

// Two crossing beams behind a wall have no order by their hulls, and need none.
TEST(HiddenLineRenderer, WhatAWallHidesIsInNoGroup) {
  Set set;
  set.add(test::block({-2, -0.2f, -0.2f}, {2, 0.2f, 0.2f}));
  set.add(test::block({-0.2f, -2, -0.2f}, {0.2f, 2, 0.2f}));
  EXPECT_EQ(set.paintSeenFirst(viewFromFront()).largest_group, 2u);
  set.add(test::block({-3, -3, 2}, {3, 3, 2.2f}));
  EXPECT_EQ(set.paint(viewFromFront()).largest_group, 2u);
  EXPECT_EQ(set.paintSeenFirst(viewFromFront()).largest_group, 1u);
  // Glass hides nothing.
  set.moving.scene.objects.back().material = MaterialId{1u};
  EXPECT_EQ(set.paintSeenFirst(viewFromFront()).largest_group, 2u);
}

Solid rectanglesFacingTheEye(const std::vector<std::pair<Vec3f, Vec3f>>& low_and_high) {
  Solid solid;
  for (const auto& [low, high] : low_and_high) {
    const auto first = static_cast<std::uint32_t>(solid.points.size());
    for (const Vec3f& p : {low, Vec3f(high.x, low.y, low.z), high, Vec3f(low.x, high.y, low.z)}) {
      solid.points.push_back(p);
    }
    solid.faces.push_back({first, first + 1, first + 2, first + 3});
  }
  return solid;
}

// The far object reaches before the back wall elsewhere, so they have no order by their hulls. The front wall
// leaves a gap of one grid line along the back wall, and a notch of a few units before the far object.
TEST(HiddenLineRenderer, ANotchAtTheEndOfAThinGapIsSeen) {
  Set set;
  const float gap = 1e-5f;
  set.add(rectanglesFacingTheEye({{{-6, -3, 0}, {6, 3, 0}}}));
  set.add(rectanglesFacingTheEye({{{-6, -3, 1}, {5.97f, 3 - gap, 1}}, {{5.97f, -3, 1}, {6, 2.99f, 1}}}));
  set.add(rectanglesFacingTheEye({{{5, 2, -1}, {7, 3.5f, -1}}, {{-1, -1, 0.5f}, {1, 1, 0.5f}}}));
  View view = viewFromFront(true);
  view.ortho_height = 7.2;
  view.aspect = 2.0;
  LayerSorter sorter = set.sorter(true);
  const Drawing drawing = HiddenLineRenderer(set.moving.scene.view())
                              .paint(set.moving.scene.view(), set.moving.scene.object_names, view,
                                     sorter.update(view), {.page_height = 720.0, .seen_first = true});
  const auto groupOf = [&](std::uint32_t object) {
    const auto group =
        std::find_if(drawing.groups.begin(), drawing.groups.end(), [&](const DrawingGroup& candidate) {
          return std::any_of(candidate.objects.begin(), candidate.objects.end(),
                             [&](const DrawingObject& other) { return other.object == ObjectId(object); });
        });
    return group - drawing.groups.begin();
  };
  // Groups are painted from back to front.
  EXPECT_LE(groupOf(2), groupOf(0)) << "the far object is painted over the wall that hides it";
}

TEST(HiddenLineRenderer, WithoutGroupsTheOrderByHullsStays) {
  Set set;
  for (int i = 0; i < 5; ++i) {
    const auto x = static_cast<float>(i);
    set.add(test::block({x - 2, -1, -x}, {x - 1.5f, 1, -x + 0.4f}));
  }
  const Drawing by_hulls = set.paint(viewFromFront()), seen_first = set.paintSeenFirst(viewFromFront());
  EXPECT_EQ(by_hulls.largest_group, 1u);
  EXPECT_EQ(toSvg(seen_first), toSvg(by_hulls));
}

// The visible length of an object's lines by HiddenLines alone, with all objects as occluders.
double visibleLengthAgainstAll(const Scene& scene, const View& view, ObjectId object) {
  const FeatureEdges edges(scene.view());
  HiddenLines hidden;
  hidden.setView(scene.view(), view, kHeight);
  std::vector<FeatureLine> lines;
  edges.select(scene.view(), object, view, {}, lines);
  std::vector<ObjectId> all;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    all.emplace_back(i);
  }
  std::vector<LinePiece> pieces;
  hidden.visiblePieces(lines, all, pieces);
  double sum = 0.0;
  for (const LinePiece& piece : pieces) {
    sum += std::hypot(piece.to.x - piece.from.x, piece.to.y - piece.from.y);
  }
  return sum;
}

TEST(HiddenLineRenderer, PlotsAsIfEachLineWereTestedAgainstAllObjects) {
  for (std::uint64_t seed = 11; seed <= 14; ++seed) {
    const Set set = randomSet(seed, 30);
    const View view = viewFromFront(seed % 2 == 0);
    const Drawing plot = set.plot(view);
    for (std::uint32_t i = 0; i < 30; ++i) {
      const double expected = visibleLengthAgainstAll(set.moving.scene, view, ObjectId(i));
      EXPECT_NEAR(lengthOfAll(strokesOf(plot, i)), expected, 0.05) << "seed " << seed << ", object " << i;
    }
    EXPECT_LT(plot.pairs, plot.all_pairs / 3) << "seed " << seed;
  }
}

TEST(HiddenLineRenderer, PlotsAnEdgeThatObjectsShareOnce) {
  Set disjoint, together;
  disjoint.add(test::block({-2, -1, -1}, {0, 1, 1}));
  disjoint.add(test::block({0.5f, -1, -1}, {2.5f, 1, 1}));
  together.add(test::block({-2, -1, -1}, {0, 1, 1}));
  together.add(test::block({0, -1, -1}, {2, 1, 1}));
  const auto lengthOfPlot = [](const Set& set) {
    const Drawing plot = set.plot(viewFromFront(true));
    return lengthOfAll(strokesOf(plot, 0)) + lengthOfAll(strokesOf(plot, 1));
  };
  // The page shows 12 metres: two squares of 2, and two that share a side.
  const double side = 2.0 * kHeight / 12.0;
  EXPECT_NEAR(lengthOfPlot(disjoint), 8 * side, 1e-6);
  EXPECT_NEAR(lengthOfPlot(together), 7 * side, 1e-6);
  // Designers separate painted objects.
  EXPECT_NEAR(lengthOfAll(strokesOf(together.paint(viewFromFront(true)), 1)), 4 * side, 1e-6);
}

TEST(HiddenLineRenderer, GlassHasLinesAndHidesNothing) {
  Set set;
  set.add(test::block({-1, -1, 2}, {1, 1, 3}), false);
  set.add(test::block({-2, -2, -3}, {0.5f, 0.5f, -2}));
  const Drawing painted = set.paint(viewFromFront()), plot = set.plot(viewFromFront());
  ASSERT_TRUE(find(painted, 0));
  EXPECT_TRUE(find(painted, 0)->outline.empty());
  EXPECT_FALSE(find(painted, 0)->strokes.empty());
  EXPECT_NEAR(lengthOfAll(strokesOf(plot, 1)), lengthOfAll(strokesOf(painted, 1)), 1e-9);
}

TEST(HiddenLineRenderer, BackdropsAndOverlaysFollowTheOrder) {
  Set set;
  set.add(test::block({-9, -9, -30}, {9, 9, -29}), true, PartSettings::Place::kBackdrop);
  set.add(test::block({-1, -1, -1}, {1, 1, 1}));
  set.add(test::block({0, 0, 8}, {0.5f, 0.5f, 8.5f}), true, PartSettings::Place::kOverlay);
  const Drawing painted = set.paint(viewFromFront());
  ASSERT_EQ(painted.groups.size(), 3u);
  EXPECT_EQ(painted.groups[0].objects[0].object, ObjectId(0u));
  EXPECT_EQ(painted.groups[2].objects[0].object, ObjectId(2u));
  const Drawing plot = set.plot(
      viewFromFront(),
      {.page_height = kHeight, .overlays = {ObjectId(2u), ObjectId(77u)}, .backdrops = {ObjectId(0u)}});
  for (std::uint32_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(lengthOfAll(strokesOf(plot, i)),
                visibleLengthAgainstAll(set.moving.scene, viewFromFront(), ObjectId(i)), 0.05)
        << i;
  }
}

// The sorter has no arcs of parts that are left to a depth buffer, as of overlays and backdrops.
TEST(HiddenLineRenderer, PlotsWhatIsLeftToADepthBufferAsOverlayAndBackdrop) {
  Set set;
  set.add(test::block({-2, -2, -9}, {2, 2, -8}), true, PartSettings::Place::kDepthBuffered);
  set.add(test::block({-1, -1, -1}, {1, 1, 1}));
  set.add(test::block({0, 0, 3}, {0.5f, 0.5f, 3.5f}), true, PartSettings::Place::kDepthBuffered);
  const std::vector<ObjectId> depth_buffered{ObjectId(0u), ObjectId(2u)};
  const Drawing plot = set.plot(
      viewFromFront(), {.page_height = kHeight, .overlays = depth_buffered, .backdrops = depth_buffered});
  for (std::uint32_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(lengthOfAll(strokesOf(plot, i)),
                visibleLengthAgainstAll(set.moving.scene, viewFromFront(), ObjectId(i)), 0.05)
        << i;
  }
}

TEST(HiddenLineRenderer, LeavesOutWhatIsNotOnThePage) {
  Set set;
  set.add(test::block({-1, -1, -1}, {1, 1, 1}));
  set.add(test::block({-1, -1, 20}, {1, 1, 21}));    // behind the eye
  set.add(test::block({30, -1, -1}, {31, 1, 1}));    // beside the page
  set.add(test::block({-1, -1, -90}, {1, 1, -80}));  // beyond the far plane
  EXPECT_EQ(set.paint(viewFromFront()).groups.size(), 1u);
  EXPECT_EQ(set.plot(viewFromFront()).groups.size(), 1u);
}

TEST(HiddenLineRenderer, ChoosesKindsOfLines) {
  Set set;
  set.add(test::block({-1, -1, -1}, {1, 1, 1}));
  const View view = viewOfACorner();
  DrawingSettings settings{.page_height = kHeight};
  settings.features = {.creases = true, .silhouettes = false, .boundaries = false};
  EXPECT_EQ(set.paint(view, settings).stats.lines, 9u);  // a silhouette of an angle is a crease too
  settings.features = {.creases = false, .silhouettes = true, .boundaries = false};
  EXPECT_EQ(set.paint(view, settings).stats.lines, 6u);
  ASSERT_EQ(set.paint(view, settings).groups.size(), 1u);
  const std::vector<PagePath> strokes = strokesOf(set.paint(view, settings), 0);
  ASSERT_EQ(strokes.size(), 1u);
  EXPECT_EQ(strokes[0].front(), strokes[0].back());
  settings.features.silhouettes = false;
  EXPECT_TRUE(strokesOf(set.paint(view, settings), 0).empty());
  EXPECT_EQ(find(set.paint(view, settings), 0)->outline.size(), 1u);
}

TEST(HiddenLineRenderer, FollowsPositionsThatChangeAndKeepsNothingOfTheViewBefore) {
  const Set set = randomSet(5, 10);
  Scene moved = set.moving.scene;
  for (std::uint32_t i = 0; i < 10; ++i) {
    const Object& object = moved.objects[i];
    std::set<std::uint32_t> corners(moved.indices.begin() + object.first_index,
                                    moved.indices.begin() + object.first_index + object.index_count);
    for (const std::uint32_t corner : corners) {
      moved.positions[corner] = moved.positions[corner] + Vec3f(0.1f * static_cast<float>(i), -0.3f, 0.5f);
    }
  }
  const View view = viewFromFront(), other = viewFromFront(true);
  LayerSorter sorter = set.sorter(true);
  const LayerOrder& order = sorter.update(view);
  const std::vector<std::string>& names = set.moving.scene.object_names;
  HiddenLineRenderer used(set.moving.scene.view()), fresh(moved.view());
  used.paint(set.moving.scene.view(), names, other, order, {.page_height = 10.0});
  used.plot(set.moving.scene.view(), names, view, order, {.page_height = kHeight});
  EXPECT_EQ(toSvg(used.paint(moved.view(), names, view, order, {.page_height = kHeight})),
            toSvg(fresh.paint(moved.view(), names, view, order, {.page_height = kHeight})));
  EXPECT_EQ(toPdf(used.plot(moved.view(), names, view, order, {.page_height = kHeight})),
            toPdf(fresh.plot(moved.view(), names, view, order, {.page_height = kHeight})));
}

TEST(HiddenLineRenderer, OrdersAndNamesOfAnotherSceneDoNoHarm) {
  const Set set = randomSet(6, 12);
  Set part;
  part.add(test::block({-1, -1, -1}, {1, 1, 1}));
  const View view = viewFromFront();
  LayerSorter sorter = set.sorter(true);
  const LayerOrder& order = sorter.update(view);
  HiddenLineRenderer renderer(part.moving.scene.view());
  for (const Drawing& drawing : {renderer.paint(part.moving.scene.view(), {}, view, order, {}),
                                 renderer.plot(part.moving.scene.view(), {}, view, order, {})}) {
    ASSERT_EQ(drawing.groups.size(), 1u);
    EXPECT_EQ(drawing.groups[0].objects[0].name, "");
  }
  EXPECT_TRUE(renderer.paint(part.moving.scene.view(), {}, view, LayerOrder{}, {}).groups.empty());
  EXPECT_TRUE(renderer.plot(part.moving.scene.view(), {}, view, LayerOrder{}, {}).groups.empty());
}

TEST(HiddenLineRenderer, ViewsAndPagesWithoutSizeGiveEmptyDrawings) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const Set set = randomSet(7, 3);
  for (const double height : {0.0, -1.0, kNan, 1e300}) {
    const Drawing drawing = set.paint(viewFromFront(), {.page_height = height});
    EXPECT_TRUE(drawing.groups.empty());
    EXPECT_EQ(drawing.width, 0.0);
    toSvg(drawing);
    toPdf(drawing);
  }
  View view = viewFromFront();
  view.aspect = kNan;
  EXPECT_TRUE(set.plot(view).groups.empty());
}

TEST(HiddenLineRenderer, TellsOfItsProgressUpToTheEnd) {
  const Set set = randomSet(8, 5);
  std::vector<double> told;
  const DrawingSettings settings{.page_height = kHeight,
                                 .progress = [&](double done) { told.push_back(done); }};
  set.paint(viewFromFront(), settings);
  set.plot(viewFromFront(), settings);
  ASSERT_EQ(told.size(), 10u);
  for (std::size_t i = 0; i < 10; ++i) {
    EXPECT_DOUBLE_EQ(told[i], static_cast<double>(i % 5 + 1) / 5.0);
  }
}

TEST(HiddenLineRenderer, DrawsTheSameHoweverNearTheNearPlaneIs) {
  const Set set = randomSet(3, 12);
  for (const bool orthographic : {false, true}) {
    View view = viewFromFront(orthographic);
    const std::uint64_t plotted = countStrokes(set.plot(view)), painted = countStrokes(set.paint(view));
    ASSERT_GT(plotted, 20u);
    view.z_near = 0.0;
    EXPECT_EQ(countStrokes(set.plot(view)), plotted);
    EXPECT_EQ(countStrokes(set.paint(view)), painted);
  }
}

TEST(HiddenLineRenderer, DrawsTheSameWithAxesOfOtherLengths) {
  const Set set = randomSet(4, 12);
  for (const bool orthographic : {false, true}) {
    View view = viewOfACorner();
    view.orthographic = orthographic;
    const Drawing expected = set.plot(view);
    ASSERT_GT(countStrokes(expected), 20u);
    view.right = view.right * 3.0;
    view.up = view.up * 0.25;
    view.forward = view.forward * 1e170;
    const Drawing drawing = set.plot(view);
    ASSERT_EQ(countStrokes(drawing), countStrokes(expected));
    for (std::uint32_t id = 0; id < 12; ++id) {
      EXPECT_NEAR(lengthOfAll(strokesOf(drawing, id)), lengthOfAll(strokesOf(expected, id)), 1e-6);
    }
  }
}

}  // namespace
}  // namespace sightline
