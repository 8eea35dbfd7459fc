// Parts in cycles, divided by planes: what rays see is in the order of the groups, and pieces are the part.

#include "sightline/layers/cycle_splitter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <set>
#include <vector>

#include "scenes/moving_scene.h"
#include "tests/layers/moving_sorter.h"
#include "tests/layers/split_things.h"
#include "tests/support/translation.h"

namespace sightline::splitting {
namespace {

using test::translation;

// Three rods, each over the next one, as seen along -z.
std::vector<Thing> threeRods() {
  const Vec3d corners[] = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
  std::vector<Thing> rods;
  for (int i = 0; i < 3; ++i) {
    Vec3d from = corners[i], to = corners[(i + 1) % 3];
    const Vec3d along = normalized(to - from) * 0.4;
    rods.push_back(rod(from - along + Vec3d{0, 0, 0.3}, to + along - Vec3d{0, 0, 0.3}, 0.05));
  }
  return rods;
}

std::vector<Thing> twoLinks() {
  return {ring({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 1.0, 0.08), ring({1, 0, 0}, {1, 0, 0}, {0, 0, 1}, 1.0, 0.08)};
}

std::vector<Thing> chain(int links) {
  std::vector<Thing> rings;
  for (int i = 0; i < links; ++i) {
    rings.push_back(
        ring({1.4 * i, 0, 0}, {1, 0, 0}, i % 2 == 0 ? Vec3d{0, 1, 0} : Vec3d{0, 0, 1}, 1.0, 0.08));
  }
  return rings;
}

// Two Us that hook into each other, and one around both.
std::vector<Thing> nestedUs() {
  return {uShape({0, -1, 0}, {1, 0, 0}, {0, 2, 0}, 0.1), uShape({0, 0.5, 0}, {0, 0, 1}, {0, -1, 0}, 0.1),
          uShape({0, -2, 0}, {2, 0, 0}, {0, 4, 0}, 0.1)};
}

std::vector<Thing> randomSticks(std::uint32_t seed, int count) {
  Random random(seed);
  std::vector<Thing> sticks;
  for (int i = 0; i < count; ++i) {
    const Vec3d middle = random.point({-1, -1, -1}, {1, 1, 1}), half = random.direction() * 1.2;
    sticks.push_back(rod(middle - half, middle + half, 0.01));
  }
  return sticks;
}

View farView() {
  return viewFrom({0.3, 0.2, 7.0}, {0, 0, -1});
}

// Sorts once and checks what rays see.
const LayerOrder& expectRight(ThingSorter& sorter, const View& view, std::uint32_t seed) {
  const LayerOrder& order = sorter.update(view);
  Random random(seed);
  EXPECT_GT(expectRaysInOrder(sorter.things(), sorter.splitter().pieces(), order, view, random, 1500), 10u);
  expectPiecesHoldTheirParts(sorter, random, 300);
  return order;
}

TEST(CycleSplitter, OneOfThreeRodsInACycleIsDividedInTwo) {
  ThingSorter sorter(threeRods(), false);
  ASSERT_EQ(largestGroupOfWhole(sorter.things(), farView()), 3u);
  EXPECT_EQ(largestGroup(expectRight(sorter, farView(), 1)), 1u);
  EXPECT_EQ(sorter.splitter().stats().divided, 1u);
  EXPECT_EQ(sorter.splitter().pieces().size(), 2u);
}

TEST(CycleSplitter, LinksOfAChainComeApartByTheirTriangles) {
  for (const int links : {2, 3, 5}) {
    SCOPED_TRACE(links);
    ThingSorter sorter(chain(links), true, {.max_trials = 4000});
    ASSERT_EQ(largestGroupOfWhole(sorter.things(), farView()), static_cast<std::size_t>(links));
    EXPECT_EQ(largestGroup(expectRight(sorter, farView(), 2)), 1u);
  }
}

TEST(CycleSplitter, HullsThatPassThroughEachOtherAreLeftWhole) {
  // Without triangles nothing says that the rings have holes.
  ThingSorter rings(twoLinks(), false);
  EXPECT_EQ(largestGroup(rings.update(farView())), 2u);
  EXPECT_EQ(rings.splitter().pieces().size(), 0u);
  ThingSorter crossed({rod({-1, 0, 0}, {1, 0, 0}, 0.1), rod({0, -1, 0}, {0, 1, 0}, 0.1)}, true);
  EXPECT_EQ(largestGroup(crossed.update(farView())), 2u);
  EXPECT_EQ(crossed.splitter().pieces().size(), 0u);
}

TEST(CycleSplitter, NestedUsComeApart) {
  ThingSorter sorter(nestedUs(), true);
  ASSERT_EQ(largestGroupOfWhole(sorter.things(), farView()), 3u);
  EXPECT_EQ(largestGroup(expectRight(sorter, farView(), 3)), 1u);
}

// The most parts that are connected by hulls that pass through each other, which no plane takes apart.
std::size_t largestClump(const std::vector<Thing>& things, const View& view) {
  LayerSorter sorter({.contact_tolerance = 1e-9});
  for (const Thing& thing : things) {
    const HullId hull = sorter.addHull(shapes::hullOf(pointsOf(thing)));
    sorter.setTransform(sorter.addPart(std::span(&hull, 1)), thing.world_from_part);
  }
  std::vector<std::size_t> clump_of(things.size());
  for (std::size_t i = 0; i < clump_of.size(); ++i) {
    clump_of[i] = i;
  }
  for (const LayerArc& pair : sorter.update(view).collisions) {
    const std::size_t from = clump_of[pair.back.value], to = clump_of[pair.front.value];
    std::replace(clump_of.begin(), clump_of.end(), from, to);
  }
  std::size_t largest = 1;
  for (const std::size_t clump : clump_of) {
    largest = std::max<std::size_t>(
        largest, static_cast<std::size_t>(std::count(clump_of.begin(), clump_of.end(), clump)));
  }
  return largest;
}

// Pieces are within their parts, so those of a group are of parts that would be in one group as well.
std::size_t mostPartsInAGroup(const CycleSplitter& splitter, const LayerOrder& order) {
  std::size_t most = 0;
  for (std::size_t i = 0; i < order.groups(); ++i) {
    std::set<PartId> parts;
    for (const PartId part : order.group(i)) {
      parts.insert(splitter.partOf(part));
    }
    most = std::max(most, parts.size());
  }
  return most;
}

TEST(CycleSplitter, FewSticksComeApartExceptWhereTheyPassThroughEachOther) {
  std::size_t gained = 0;
  for (std::uint32_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    View view = farView();
    view.orthographic = seed % 4 == 0;
    ThingSorter sorter(randomSticks(seed, 20), seed % 2 == 0, {.max_trials = 4000});
    const std::size_t whole = largestGroupOfWhole(sorter.things(), view);
    const std::size_t divided = largestGroup(expectRight(sorter, view, seed));
    EXPECT_LE(divided, largestClump(sorter.things(), view));
    gained += divided < whole ? 1 : 0;
    if (HasFailure()) {
      return;
    }
  }
  EXPECT_GT(gained, 8u);
}

TEST(CycleSplitter, ManySticksAreInOrderAlongAllRays) {
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    View view = farView();
    view.orthographic = seed == 2;
    ThingSorter sorter(randomSticks(seed, 60), seed % 2 == 0);
    const std::size_t whole = largestGroupOfWhole(sorter.things(), view);
    const LayerOrder& order = expectRight(sorter, view, seed);
    EXPECT_LE(mostPartsInAGroup(sorter.splitter(), order), whole);
    if (HasFailure()) {
      return;
    }
  }
}

TEST(CycleSplitter, AnOrderOfPiecesHoldsForASetOfEyes) {
  ThingSorter sorter(threeRods(), false);
  const std::vector<Vec3d> eyes{{0.0, 0.2, 7.0}, {0.6, 0.3, 7.1}};
  const LayerOrder& order = sorter.update(farView(), eyes);
  EXPECT_EQ(largestGroup(order), 1u);
  Random random(5);
  for (const Vec3d& eye : eyes) {
    EXPECT_GT(expectRaysInOrder(sorter.things(), sorter.splitter().pieces(), order, viewFrom(eye, {0, 0, -1}),
                                random, 800),
              10u);
  }
}

TEST(CycleSplitter, ThePiecesOfAConvexPartHaveItsVolumeTogether) {
  ThingSorter sorter(threeRods(), false);
  sorter.update(farView());
  const auto volumeOf = [&](PartId part) {
    const ConvexHull& hull = sorter.sorter().hull(sorter.sorter().hullsOf(part)[0]);
    double volume = 0.0;
    for (const auto& [a, b, c] : hull.triangles) {
      volume += dot(hull.vertices[a], cross(hull.vertices[b], hull.vertices[c])) / 6.0;
    }
    return volume;
  };
  double of_pieces = 0.0, of_part = 0.0;
  for (const PartPiece& piece : sorter.splitter().pieces()) {
    of_pieces += volumeOf(piece.piece);
    of_part = volumeOf(piece.part);
  }
  EXPECT_GT(of_part, 0.0);
  EXPECT_NEAR(of_pieces, of_part, 1e-12);
}

TEST(CycleSplitter, TheBudgetOfPiecesIsKept) {
  for (const std::uint32_t budget : {0u, 1u, 2u, 5u, 9u}) {
    ThingSorter sorter(randomSticks(3, 40), true, {.max_pieces = budget});
    for (int frame = 0; frame < 40; ++frame) {
      sorter.update(farView());
      EXPECT_LE(sorter.splitter().pieces().size(), budget);
      EXPECT_EQ(sorter.splitter().stats().pieces, sorter.splitter().pieces().size());
    }
  }
}

TEST(CycleSplitter, TheTrialsOfAnUpdateAreLimited) {
  ThingSorter sorter(chain(5), true, {.max_trials = 40});
  for (int frame = 0; frame < 60; ++frame) {
    sorter.update(farView());
    EXPECT_LE(sorter.splitter().stats().trials, 40u);
  }
}

TEST(CycleSplitter, PiecesStayFromFrameToFrame) {
  ThingSorter sorter(chain(3), true);
  sorter.update(farView());
  const std::vector<PartPiece> first(sorter.splitter().pieces().begin(), sorter.splitter().pieces().end());
  ASSERT_FALSE(first.empty());
  for (int frame = 1; frame < 100; ++frame) {
    View view = farView();
    view.eye.x += 0.002 * frame;
    sorter.update(view);
    EXPECT_EQ(sorter.splitter().stats().cuts, 0u) << frame;
    EXPECT_EQ(sorter.splitter().stats().joins, 0u) << frame;
    const std::span<const PartPiece> pieces = sorter.splitter().pieces();
    ASSERT_EQ(pieces.size(), first.size()) << frame;
    for (std::size_t i = 0; i < first.size(); ++i) {
      EXPECT_EQ(pieces[i].piece, first[i].piece);
      EXPECT_EQ(pieces[i].sides, first[i].sides);
    }
  }
}

TEST(CycleSplitter, PiecesAreJoinedSomeFramesAfterTheCycleIsGone) {
  ThingSorter sorter(threeRods(), false, {.keep_frames = 10});
  sorter.update(farView());
  ASSERT_EQ(sorter.splitter().pieces().size(), 2u);
  const std::size_t parts = sorter.sorter().parts();
  for (int round = 0; round < 5; ++round) {
    SCOPED_TRACE(round);
    for (std::uint32_t part = 0; part < 3; ++part) {
      sorter.place(part, translation({0, 0, 5.0 * -static_cast<double>(part)}));  // one behind the other
    }
    int frames = 0;
    while (!sorter.splitter().pieces().empty() && frames < 40) {
      sorter.update(farView());
      ++frames;
    }
    EXPECT_GT(frames, 10);
    EXPECT_LT(frames, 20);
    EXPECT_TRUE(sorter.sorter().isEnabled(PartId(0u)) && sorter.sorter().isEnabled(PartId(1u)) &&
                sorter.sorter().isEnabled(PartId(2u)));
    for (std::uint32_t part = 0; part < 3; ++part) {
      sorter.place(part, {});
    }
    for (int frame = 0; frame < 20; ++frame) {
      sorter.update(farView());
    }
    EXPECT_EQ(sorter.splitter().pieces().size(), 2u);
    EXPECT_EQ(sorter.sorter().parts(), parts) << "numbers are not used again";
  }
}

TEST(CycleSplitter, PiecesMoveWithTheirPart) {
  ThingSorter sorter(chain(2), true);
  Random random(7);
  for (int frame = 0; frame < 30; ++frame) {
    SCOPED_TRACE(::testing::Message() << "frame " << frame);
    const double angle = 0.02 * frame;
    Mat4 turned;
    turned(0, 0) = turned(1, 1) = std::cos(angle);
    turned(1, 0) = std::sin(angle);
    turned(0, 1) = -turned(1, 0);
    turned(0, 3) = 0.01 * frame;
    sorter.place(0, turned);
    sorter.place(1, turned);
    const LayerOrder& order = sorter.update(farView());
    EXPECT_GT(expectRaysInOrder(sorter.things(), sorter.splitter().pieces(), order, farView(), random, 200),
              5u);
    for (const PartPiece& piece : sorter.splitter().pieces()) {
      EXPECT_EQ(sorter.sorter().transformOf(piece.piece).m, turned.m);
    }
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_FALSE(sorter.splitter().pieces().empty());
}

TEST(CycleSplitter, PartsThatMustStayWholeDo) {
  ThingSorter sorter(threeRods(), false);
  sorter.splitter().setMayDivide(PartId(0u), false);
  sorter.splitter().setMayDivide(PartId(2u), false);
  sorter.splitter().setMayDivide(PartId(), false);  // no part
  EXPECT_EQ(largestGroup(expectRight(sorter, farView(), 9)), 1u);
  for (const PartPiece& piece : sorter.splitter().pieces()) {
    EXPECT_EQ(piece.part, PartId(1u));
  }
  sorter.splitter().setMayDivide(PartId(1u), false);
  sorter.splitter().join(PartId(1u));
  for (int frame = 0; frame < 40; ++frame) {
    EXPECT_EQ(largestGroup(sorter.update(farView())), 3u);
  }
  EXPECT_TRUE(sorter.splitter().pieces().empty());
}

TEST(CycleSplitter, JoinMakesAPartOfManyPiecesWhole) {
  ThingSorter sorter(chain(3), true);
  sorter.update(farView());
  ASSERT_GT(sorter.splitter().pieces().size(), 3u);
  for (std::uint32_t part = 0; part < 3; ++part) {
    sorter.splitter().join(PartId(part));
    EXPECT_TRUE(sorter.sorter().isEnabled(PartId(part)));
    EXPECT_EQ(sorter.splitter().partOf(PartId(part)), PartId(part));
  }
  for (std::uint32_t piece = 3; piece < sorter.sorter().parts(); ++piece) {
    EXPECT_FALSE(sorter.sorter().isEnabled(PartId(piece))) << piece;
  }
}

// A rod that crosses one of the three near its end has no order with it by their hulls, and one by a rule.
TEST(CycleSplitter, PiecesHaveTheRulesOfTheirPart) {
  std::vector<Thing> things = threeRods();
  const Vec3d near_end{-0.138, 1.276, -0.282};
  things.push_back(rod(near_end - Vec3d{0.3, 0.15, 0}, near_end + Vec3d{0.1, 0.05, 0}, 0.02));
  ASSERT_EQ(largestGroupOfWhole(things, farView()), 4u);
  ThingSorter sorter(std::move(things), false);
  for (const std::uint32_t part : {0u, 2u, 3u}) {
    sorter.splitter().setMayDivide(PartId(part), false);
  }
  const PairCallback first{[](void*, const View&) { return PairOrder{true, false}; }, nullptr};
  sorter.sorter().setRule(PartId(1u), PartId(3u), first);
  const LayerOrder& order = sorter.update(farView());
  EXPECT_EQ(largestGroup(order), 1u);
  EXPECT_EQ(sorter.splitter().pieces().size(), 2u);
  std::size_t arcs = 0;
  for (const LayerArc& arc : order.arcs) {
    const PartId front = sorter.splitter().partOf(arc.front), back = sorter.splitter().partOf(arc.back);
    EXPECT_FALSE(front == PartId(3u) && back == PartId(1u)) << "a piece lacks the rule";
    arcs += front == PartId(1u) && back == PartId(3u) ? 1 : 0;
  }
  EXPECT_EQ(arcs, 1u);
}

// Pieces touch along the planes between them, which must not keep them divided. The chain of three is cut
// into pieces of pieces.
TEST(CycleSplitter, PiecesThatTouchAreJoinedWithoutATolerance) {
  for (const int links : {2, 3}) {
    SCOPED_TRACE(links);
    ThingSorter sorter(chain(links), true, {.max_trials = 4000, .keep_frames = 5},
                       {.contact_tolerance = 0.0});
    sorter.update(farView());
    ASSERT_GT(sorter.splitter().pieces().size(), 2u);
    for (int link = 0; link < links; ++link) {
      sorter.place(static_cast<std::uint32_t>(link), translation({100.0 * link, 0, 0}));
    }
    for (int frame = 0; frame < 200; ++frame) {
      sorter.update(farView());
    }
    EXPECT_EQ(sorter.splitter().pieces().size(), 0u);
    EXPECT_EQ(largestGroup(sorter.update(farView())), 1u);
  }
}

// The neighbour overlaps the divided rod, and is in front of it by a rule.
TEST(CycleSplitter, ANeighbourThatARuleOrdersDoesNotKeepAPartDivided) {
  std::vector<Thing> things = threeRods();
  things.push_back(things[1]);
  things.push_back(things[1]);
  ThingSorter sorter(things, false, {.keep_frames = 5});
  for (const std::uint32_t part : {0u, 2u, 3u, 4u}) {
    sorter.splitter().setMayDivide(PartId(part), false);
  }
  const PairCallback first{[](void*, const View&) { return PairOrder{true, false}; }, nullptr};
  for (const std::uint32_t neighbour : {3u, 4u}) {
    sorter.place(neighbour, translation({0, 0, -50.0 * neighbour}));
    sorter.sorter().setRule(PartId(1u), PartId(neighbour), first);
  }
  sorter.sorter().setRule(PartId(3u), PartId(4u), first);
  sorter.update(farView());
  ASSERT_EQ(sorter.splitter().pieces().size(), 2u);
  sorter.place(0, translation({100, 0, 0}));
  sorter.place(2, translation({200, 0, 0}));
  for (const std::uint32_t neighbour : {3u, 4u}) {
    sorter.place(neighbour, translation({0.02 * neighbour, 0, 0}));
  }
  for (int frame = 0; frame < 100; ++frame) {
    sorter.update(farView());
  }
  EXPECT_EQ(sorter.splitter().pieces().size(), 0u);
}

void setHullsMovedBy(const Vec3d& by, const std::vector<Thing>& things, LayerSorter& sorter) {
  for (std::uint32_t part = 0; part < things.size(); ++part) {
    Points points = pointsOf(things[part]);
    for (Vec3d& point : points) {
      point += by;
    }
    sorter.setHull(sorter.hullsOf(PartId(part)).front(), shapes::hullOf(points));
  }
}

TEST(CycleSplitter, HullsThatChangeAreCutWhereTheyAre) {
  const std::vector<Thing> things = threeRods();
  ThingSorter sorter(things, false);
  sorter.update(farView());
  ASSERT_EQ(sorter.splitter().pieces().size(), 2u);
  for (std::uint32_t part = 0; part < 3; ++part) {
    sorter.splitter().join(PartId(part));
  }
  setHullsMovedBy({50, 0, 0}, things, sorter.sorter());
  View view = farView();
  view.eye.x += 50.0;
  for (int frame = 0; frame < 40; ++frame) {
    sorter.update(view);
  }
  EXPECT_EQ(largestGroup(sorter.update(view)), 1u);
  EXPECT_EQ(sorter.splitter().pieces().size(), 2u);
  for (const PartPiece& piece : sorter.splitter().pieces()) {
    EXPECT_GT(sorter.sorter().hull(sorter.sorter().hullsOf(piece.piece).front()).centre.x, 45.0);
  }
}

std::set<std::uint32_t> numbersIn(const LayerOrder& order) {
  std::set<std::uint32_t> numbers;
  for (const PartId part : order.parts) {
    numbers.insert(part.value);
  }
  return numbers;
}

// Engines enable what they show in every frame.
TEST(CycleSplitter, ADividedPartThatIsEnabledStaysOutOfTheOrder) {
  ThingSorter sorter(threeRods(), false);
  sorter.update(farView());
  ASSERT_EQ(sorter.splitter().pieces().size(), 2u);
  const std::uint32_t divided = sorter.splitter().pieces()[0].part.value;
  for (std::uint32_t part = 0; part < 3; ++part) {
    sorter.sorter().setEnabled(PartId(part), true);
  }
  EXPECT_EQ(numbersIn(expectRight(sorter, farView(), 2)).count(divided), 0u);
  sorter.splitter().join(PartId(divided));
  EXPECT_TRUE(sorter.sorter().isEnabled(PartId(divided)));
}

TEST(CycleSplitter, ThePiecesOfARemovedPartGoWithIt) {
  for (const bool is_replaced : {false, true}) {
    SCOPED_TRACE(is_replaced);
    ThingSorter sorter(threeRods(), false);
    sorter.update(farView());
    ASSERT_EQ(sorter.splitter().pieces().size(), 2u);
    const PartId divided = sorter.splitter().pieces()[0].part;
    const std::vector<HullId> hulls = sorter.sorter().hullsOf(divided);
    sorter.sorter().removePart(divided);
    std::set<std::uint32_t> expected{0, 1, 2};
    if (is_replaced) {
      ASSERT_EQ(sorter.sorter().addPart(hulls), divided);
      sorter.sorter().setTransform(divided, translation({100.0, 0, 0}));
    } else {
      expected.erase(divided.value);
    }
    EXPECT_EQ(numbersIn(sorter.update(farView())), expected);
    EXPECT_TRUE(sorter.splitter().pieces().empty());
    EXPECT_EQ(sorter.splitter().stats().divided, 0u);
  }
}

TEST(CycleSplitter, ANewPartMayBeDividedThoughTheOneBeforeMightNot) {
  ThingSorter sorter(threeRods(), false);
  for (std::uint32_t part = 0; part < 3; ++part) {
    sorter.splitter().setMayDivide(PartId(part), false);
  }
  EXPECT_EQ(largestGroup(sorter.update(farView())), 3u);
  const std::vector<HullId> hulls = sorter.sorter().hullsOf(PartId(1u));
  sorter.sorter().removePart(PartId(1u));
  ASSERT_EQ(sorter.sorter().addPart(hulls), PartId(1u));
  for (int frame = 0; frame < 40; ++frame) {
    sorter.update(farView());
  }
  EXPECT_EQ(largestGroup(sorter.update(farView())), 1u);
}

TEST(CycleSplitter, PartsAreWholeAfterTheSplitterIsGone) {
  LayerSorter sorter({.contact_tolerance = 1e-9});
  for (const Thing& thing : threeRods()) {
    const HullId hull = sorter.addHull(shapes::hullOf(pointsOf(thing)));
    sorter.addPart(std::span(&hull, 1));
  }
  {
    CycleSplitter splitter(sorter);
    splitter.update(farView());
    ASSERT_EQ(splitter.pieces().size(), 2u);
  }
  EXPECT_EQ(numbersIn(sorter.update(farView())), (std::set<std::uint32_t>{0, 1, 2}));
}

TEST(CycleSplitter, NothingIsDividedWithoutArcsOrExactTests) {
  LayerSorter sorter({.arcs = LayerArcs::kNone});
  for (const Thing& thing : threeRods()) {
    const HullId hull = sorter.addHull(shapes::hullOf(pointsOf(thing)));
    sorter.addPart(std::span(&hull, 1));
  }
  CycleSplitter splitter(sorter);
  EXPECT_EQ(largestGroup(splitter.update(farView())), 3u);
  EXPECT_TRUE(splitter.pieces().empty());
}

TEST(CycleSplitter, ToothpicksAreInOrderAlongAllRays) {
  const MovingScene scene = makeToothpicks({.count = 200});
  LayerSorter sorter = makeSorter(scene, {.contact_tolerance = 1e-9});
  LayerSorter whole_sorter = makeSorter(scene, {.contact_tolerance = 1e-9});
  CycleSplitter splitter(sorter);
  std::vector<Thing> things;
  for (const MovingPart& part : scene.parts) {
    Thing& thing = things.emplace_back();
    for (const std::uint32_t hull : part.hulls) {
      for (const auto& [a, b, c] : scene.hulls[hull].triangles) {
        const std::vector<Vec3d>& vertices = scene.hulls[hull].vertices;
        thing.triangles.push_back({vertices[a], vertices[b], vertices[c]});
      }
    }
  }
  Random random(1);
  std::vector<Mat4> poses;
  std::size_t pieces = 0;
  for (std::uint32_t frame = 0; frame < 24; frame += 2) {
    SCOPED_TRACE(::testing::Message() << "frame " << frame);
    pose(scene, frame, poses, sorter);
    pose(scene, frame, poses, whole_sorter);
    const View view = scene.scene.paths[0].view(frame, {});
    const LayerOrder& order = splitter.update(view);
    EXPECT_LE(mostPartsInAGroup(splitter, order), largestGroup(whole_sorter.update(view)));
    pieces += splitter.pieces().size();
    if (frame % 8 == 0) {
      // Joints are rules of spheres and cylinders, which rays must not judge.
      std::vector<Thing> judged(things.begin(), things.begin() + 200);
      for (std::size_t i = 0; i < judged.size(); ++i) {
        judged[i].world_from_part = poses[i];
      }
      expectRaysInOrder(judged, splitter.pieces(), order, view, random, 150);
    }
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_GT(pieces, 0u);
}

}  // namespace
}  // namespace sightline::splitting
