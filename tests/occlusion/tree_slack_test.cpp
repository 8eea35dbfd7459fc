// Meshes whose edges are off those of their merged polygons by the slack that findOccluders allows, where
// lines of several polygons coincide as the eye sees them: what shows through must not be called hidden.
// Exact arithmetic says what shows.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "sightline/occluders/occluder_set.h"
#include "tests/occlusion/small_scenes.h"
#include "tests/support/exact_sight.h"
#include "tests/support/hand_made.h"

namespace sightline {
namespace {

using test::ExactSight;

using FlatPoint = std::array<double, 2>;  // in the plane of a facade

// Panels that face +z, each an object of its own. Points of the facade are mirrored as `turn` says (0 to 7).
struct Facade {
  explicit Facade(unsigned with_turn = 0) : turn(with_turn) { scene.materials.push_back({}); }

  Vec3d at(FlatPoint p, double z = -5) const {
    const double x = (turn & 1) != 0 ? -p[0] : p[0], y = (turn & 2) != 0 ? -p[1] : p[1];
    return (turn & 4) != 0 ? Vec3d(y, x, z) : Vec3d(x, y, z);
  }
  // Adds a panel of triangles that run counter-clockwise before mirroring.
  void add(const std::vector<std::array<FlatPoint, 3>>& triangles, double z = -5) {
    const bool mirrored = (((turn & 1) + (turn >> 1 & 1) + (turn >> 2 & 1)) & 1) != 0;
    std::vector<Vec3f> corners;
    for (auto [a, b, c] : triangles) {
      if (mirrored) {
        std::swap(b, c);
      }
      for (const FlatPoint& p : {a, b, c}) {
        corners.emplace_back(at(p, z));
      }
    }
    hand_made::addTriangles(scene, MaterialId(0u), corners);
  }
  void addRectangle(FlatPoint low, FlatPoint high, double z = -5) {
    const FlatPoint right{high[0], low[1]}, left{low[0], high[1]};
    add({{low, right, high}, {low, high, left}}, z);
  }

  unsigned turn;
  Scene scene;
};

// Whether the view shows the point of a triangle that is added to the scene.
bool showsPoint(Scene scene, const View& view, const std::vector<Vec3f>& triangle, const Vec3d& point) {
  const MaterialId both_sides = hand_made::addMaterial(scene, Opacity::kOpaque, true);
  const ObjectId object = hand_made::addTriangles(scene, both_sides, triangle);
  return ExactSight(scene.view(), view).reaches(point, object);
}

// Asks trees of every variant, with the occluders in every order.
void expectNotHidden(Scene scene, const View& view, const Box& box, const std::string& what) {
  weldPositions(scene);
  updateBounds(scene);
  const OccluderSet set = findOccluders(scene.view(), {.area_fraction = 1.0});
  std::vector<OccluderId> order = test::all(set);
  const auto before = [](OccluderId a, OccluderId b) { return a.value < b.value; };
  do {
    for (const auto variant : test::kTreeVariants) {
      OcclusionTree tree({.variant = variant});
      tree.build(view, set, order);
      ASSERT_NE(tree.classify(box), Visibility::kHidden) << what << ", variant " << static_cast<int>(variant);
    }
  } while (std::next_permutation(order.begin(), order.end(), before));
}

// Looks from (eye, 0), in the direction of -z, to points behind the facade's point; tests that those which
// show are not hidden. Returns how many show.
int lookBehind(const Facade& facade, FlatPoint eye, FlatPoint point, double factor, const std::string& what) {
  View view = test::viewFrom(facade.at(eye, 0), {0, 0, -1});
  view.tan_half_fovy = 1.5;
  const Vec3f target(view.eye + (facade.at(point) - view.eye) * factor);
  const auto up = [](float x) { return std::nextafter(x, std::numeric_limits<float>::infinity()); };
  const std::vector<Vec3f> triangle{
      target, {up(target.x), target.y, target.z}, {target.x, up(target.y), target.z}};
  if (!showsPoint(facade.scene, view, triangle, Vec3d(target))) {
    return 0;
  }
  expectNotHidden(facade.scene, view, {target, target}, what + ", turn " + std::to_string(facade.turn));
  return 1;
}

// Adds a panel below the line y = 0 and two above it. The panel's upper edge lies on the line but for its
// middle vertex, the tip of the gap between the two.
constexpr double kDip = 4e-6;
constexpr FlatPoint kTip{1.5, -kDip};
void addPanelsAroundTip(Facade& facade) {
  facade.add({{FlatPoint{0.5, -1}, FlatPoint{2.5, -1}, kTip},
              {FlatPoint{2.5, -1}, FlatPoint{2.5, 0}, kTip},
              {FlatPoint{0.5, -1}, kTip, FlatPoint{0.5, 0}}});
  facade.add({{FlatPoint{0.5, 0}, kTip, FlatPoint{1.4, 1}},
              {FlatPoint{0.5, 0}, FlatPoint{1.4, 1}, FlatPoint{0.5, 1}}});
  facade.add({{kTip, FlatPoint{2.5, 0}, FlatPoint{2.5, 1}}, {kTip, FlatPoint{2.5, 1}, FlatPoint{1.6, 1}}});
}

// Looks at points in the tip of the gap, with what add_more adds to the facade.
void expectTipIsSeen(const std::function<void(Facade&)>& add_more) {
  int seen = 0;
  for (unsigned turn = 0; turn < 8; ++turn) {
    Facade facade(turn);
    addPanelsAroundTip(facade);
    add_more(facade);
    for (const double below : {0.5e-6, 1e-6, 1.5e-6, 2e-6, 3e-6}) {
      seen +=
          lookBehind(facade, {1.5, -1.25}, {kTip[0], -below}, 2.0, "below " + std::to_string(below * 1e6));
    }
  }
  EXPECT_GE(seen, 20) << "the test's own premise";
}

TEST(TreeSlack, APieceThatLostASharedEdgeIsStillAsWideThere) {
  // The first panel's open edge is in line with the shared edge. Its plane, drawn in by the margin of
  // rounding alone, cuts the second panel just below that edge.
  expectTipIsSeen([](Facade& facade) { facade.addRectangle({-2, -1}, {0, 0}); });
}

TEST(TreeSlack, ASharedEdgeIsNotAsNarrowAsThePlaneOfAnotherOne) {
  expectTipIsSeen([](Facade& facade) {
    facade.addRectangle({-2, -1}, {0, 0});
    facade.addRectangle({-2, 0}, {0, 1});
  });
}

TEST(TreeSlack, AnOccluderHidesNothingBeforeItsOpenEdgeJustBeyondAWidePlane) {
  // The plane of the shared edge cuts a farther panel that ends less than the edge's width below it.
  for (const double end : {-1.2e-6, -0.7e-6, -0.24e-6}) {
    expectTipIsSeen([&](Facade& facade) { facade.addRectangle({1, 0.25 + end}, {2, 1}, -6); });
  }
}

TEST(TreeSlack, ASharedEdgeIsNotAsWideAsThePlaneOfAnotherOne) {
  // Two farther panels share an exact edge, as seen in line with the other one. They end at the tip, where
  // the lower one leaves the edge at 45 degrees.
  for (const double end : {1.5 + 0.25e-6, 1.5 + 0.5e-6, 1.5 + 1e-6}) {
    expectTipIsSeen([&](Facade& facade) {
      const FlatPoint left{1, 0.25}, right{end, 0.25};
      facade.add({{left, right, FlatPoint{end, 1.25}}, {left, FlatPoint{end, 1.25}, FlatPoint{1, 1.25}}}, -6);
      facade.add({{left, FlatPoint{1, 0.25 - (end - 1)}, right}}, -6);
    });
  }
}

TEST(TreeSlack, WhatLiesBetweenTheOpenOutlineAndItsPlaneIsNotInShadow) {
  // The upper edges of two panels lie on one line. The second panel is cut in two, for its lower edge is
  // shared in part.
  int seen = 0;
  for (unsigned turn = 0; turn < 8; ++turn) {
    Facade facade(turn);
    const FlatPoint dip{-1, 1 - kDip};
    facade.addRectangle({2, 0}, {3, 1}, -8);
    facade.add({{FlatPoint{-2, 0}, FlatPoint{0, 0}, dip},
                {FlatPoint{-2, 0}, dip, FlatPoint{-2, 1}},
                {FlatPoint{0, 0}, FlatPoint{1, 0}, FlatPoint{1, 1}},
                {FlatPoint{0, 0}, FlatPoint{1, 1}, dip}},
               -8);
    facade.addRectangle({0, -1}, {1, 0}, -8);
    for (const double below : {0.5e-6, 1e-6, 2e-6, 3e-6}) {
      const FlatPoint point{-1 * 5.0 / 8, (1 - below) * 5.0 / 8};
      seen += lookBehind(facade, {0, 0}, point, 16.0 / 5, "below " + std::to_string(below * 1e6));
    }
  }
  EXPECT_GE(seen, 16) << "the test's own premise";
}

TEST(TreeSlack, TheSharedPartOfAPolygonKeepsTheOpenEdgesOfItsRest) {
  // The lower edge is shared but for its last tenth of a millimetre. The open edge on the right begins there,
  // leans over the shared part, and its middle vertex is off by 5 micrometres.
  int seen = 0;
  for (int step = 0; step < 750; step += 3) {
    const double lean = 1.5e-4 + 4e-7 * step, height = 1 - 3.5e-4, right = 1 - lean * height;
    const FlatPoint end{1 - 1e-4, 0}, middle{right - 5e-6, height};
    Facade facade;
    facade.add({{FlatPoint{0, 0}, end, middle},
                {end, FlatPoint{1, 0}, middle},
                {FlatPoint{0, 0}, middle, FlatPoint{0, 1}},
                {middle, FlatPoint{1 - lean, 1}, FlatPoint{0, 1}}},
               -8);
    facade.add({{FlatPoint{0, -1}, FlatPoint{end[0], -1}, end}, {FlatPoint{0, -1}, end, FlatPoint{0, 0}}},
               -8);
    const Vec3d eye(0.5, 0.5, 0);
    for (const double off : {0.5e-6, 1e-6, 2e-6, 3e-6, 4e-6}) {
      const Vec3d through = (Vec3d(middle[0] + off, height, -8) - eye) * (5.0 / 8) + eye;
      seen += lookBehind(facade, {eye.x, eye.y}, {through.x, through.y}, 8.0 / 5 * 1.0001,
                         "step " + std::to_string(step) + ", off " + std::to_string(off * 1e6));
    }
  }
  EXPECT_GE(seen, 100) << "the test's own premise";
}

TEST(TreeSlack, ABoxThatReachesVeryFarIsCutWhereItIsNear) {
  // Two walls with a gap of 9 mm, a low one before them, and a box from 2 m to 6.6e15 m, seen through the
  // gap.
  for (const float side : {1.0f, -1.0f}) {
    const float gap = side * 0.00895909f, end = side * 1.5f, edge = side * 2.0f, far = -6621980005766468.0f;
    Facade facade;
    const auto addWall = [&](float x0, float x1, float top, float z) {
      const auto [low, high] = std::minmax(x0, x1);
      facade.addRectangle({low, -2}, {high, top}, z);
    };
    addWall(-end, 0, 2, -1);
    addWall(gap, edge, 2, -1);
    addWall(-side, side, 0.18f, -0.9f);
    View view = test::viewFrom({-0.25 * static_cast<double>(side), 0, 0}, {0, 0, -1});
    view.tan_half_fovy = 1.5;
    view.z_far = INFINITY;
    const float near = side * 0.930937052f;
    Box box;
    box.extend({near, -1, -2});
    box.extend({near + side * 0.05f, 1, far});
    const double eye = view.eye.x;
    const double depth = (static_cast<double>(near) - eye) / (0.5 * static_cast<double>(gap) - eye);
    const Vec3d point(static_cast<double>(near), 0.95, -depth);
    ASSERT_TRUE(showsPoint(facade.scene, view, {{near, -1, -2}, {near, 1, -2}, {near, 1, -8}}, point));
    expectNotHidden(facade.scene, view, box, side > 0 ? "right" : "left");
  }
}

}  // namespace
}  // namespace sightline
