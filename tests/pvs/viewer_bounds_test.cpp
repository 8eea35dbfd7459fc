// Sets hold for where viewers are expected in a cell, and nowhere else.

#include <gtest/gtest.h>

#include <cmath>

#include "sightline/pvs/query/set_query.h"
#include "src/pvs/bake/bake_scene.h"
#include "src/pvs/bake/cell_tree.h"
#include "tests/pvs/bake_scenes.h"
#include "tests/pvs/sight_checks.h"

namespace sightline {
namespace {

using test::baked;
using test::BakeJudge;
using test::block;
using test::sceneOf;
using test::Solid;

// Walls, doors and crates on a floor of 16 m.
Scene roomsScene(std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto place = [&](float most) { return static_cast<float>(random() % 64) / 64.0f * most; };
  std::vector<Solid> solids{block({0, -0.5f, 0}, {16, 0, 16})};
  for (int i = 0; i < 10; ++i) {
    const Vec3f at(place(12), 0, place(12));
    const float length = 2 + place(6);
    solids.push_back(block(at, at + (random() % 2 == 0 ? Vec3f(length, 3, 0.25f) : Vec3f(0.25f, 3, length))));
  }
  for (int i = 0; i < 40; ++i) {
    const Vec3f at(place(15), 0, place(15));
    solids.push_back(block(at, at + Vec3f(0.5f, 1, 0.5f)));
  }
  return sceneOf(solids);
}

std::vector<Box> randomViewers(std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto place = [&](float most) { return static_cast<float>(random() % 1024) / 1024.0f * most; };
  std::vector<Box> viewers;
  for (int i = 0; i < 6; ++i) {
    const Vec3f at(place(14), 0.25f + place(1), place(14));
    viewers.push_back({at, at + Vec3f(place(5), place(2), place(5))});
  }
  return viewers;
}

BakeSettings settingsFor(std::uint32_t seed, bool fused) {
  return {.occlusion = fused ? BakeOcclusion::kFused : BakeOcclusion::kConvex,
          .triangle_budget = 100,
          .max_depth = fused ? 3u : 4u,
          .near_distance = 0.05,
          .viewers = randomViewers(seed),
          .narrowings = fused ? 1u : 0u};
}

struct Range {
  Vec3d min, max;

  bool holds(const Vec3d& p) const {
    return p.x >= min.x && p.x <= max.x && p.y >= min.y && p.y <= max.y && p.z >= min.z && p.z <= max.z;
  }
  bool empty() const { return !(min.x <= max.x && min.y <= max.y && min.z <= max.z); }
};

Range cellRange(const VisibilityOctree& octree, const OctreeCell& cell) {
  return {cellMin(octree.min, octree.max, cell), cellMax(octree.min, octree.max, cell)};
}

Range viewerRange(const VisibilityOctree& octree, const OctreeCell& cell, std::uint32_t leaf) {
  const ViewerBounds viewers = octree.view().viewersOf(leaf);
  return {viewersMin(octree.min, octree.max, cell, viewers),
          viewersMax(octree.min, octree.max, cell, viewers)};
}

Range common(const Range& range, const Box& box) {
  return {max(range.min, Vec3d(box.min)), min(range.max, Vec3d(box.max))};
}

// The box around what of the viewers' boxes lies in the cell, wider by a 60th of it.
Range askedAbout(const VisibilityOctree& octree, const OctreeCell& cell, const std::vector<Box>& viewers) {
  const Range all = cellRange(octree, cell);
  Range around{all.max, all.min};
  bool any = false;
  for (const Box& box : viewers) {
    if (const Range part = common(all, box); !part.empty()) {
      around = {min(around.min, part.min), max(around.max, part.max)};
      any = true;
    }
  }
  const Vec3d wider = (all.max - all.min) / 60.0;
  return any ? Range{around.min - wider, around.max + wider} : Range{{1, 1, 1}, {0, 0, 0}};
}

OctreeCell childAt(const VisibilityOctree& octree, const OctreeCell& cell, const Vec3d& point) {
  const Vec3d middle = cellMin(octree.min, octree.max, cell.child(7));
  return cell.child((point.x >= middle.x ? 1u : 0u) | (point.y >= middle.y ? 2u : 0u) |
                    (point.z >= middle.z ? 4u : 0u));
}

TEST(ViewerBounds, HoldAllViewersAndNothingThatWasNotAskedAbout) {
  std::size_t partial = 0, merged = 0;
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    const Scene scene = roomsScene(seed);
    BakeSettings settings = settingsFor(seed, false);
    settings.merge_tolerance = seed % 2 == 0 ? 0.05 : 0.5;
    const BakedVisibility result = baked(scene, settings);
    const VisibilityOctree& octree = result.octree;
    std::mt19937 random(seed);
    forEachLeaf(octree.view(), [&](std::uint32_t leaf, const OctreeCell& cell) {
      const Range own = viewerRange(octree, cell, leaf), all = cellRange(octree, cell);
      if (octree.reasons[leaf] == static_cast<std::uint8_t>(StopReason::kOutside)) {
        return;
      }
      for (const Box& box : settings.viewers) {
        const Range part = common(all, box);
        // What a viewer's box only touches belongs to the cell beside it.
        const Vec3d extent = part.max - part.min;
        if (std::min({extent.x, extent.y, extent.z}) > 0.0) {
          EXPECT_TRUE(own.holds(part.min) && own.holds(part.max)) << "leaf " << leaf << " seed " << seed;
        }
      }
      partial += octree.viewers[leaf] != ViewerBounds{} ? 1 : 0;
      const bool is_merged = octree.reasons[leaf] == static_cast<std::uint8_t>(StopReason::kMerged);
      merged += is_merged ? 1 : 0;
      for (int i = 0; i < 50; ++i) {
        const Vec3d point = test::pointIn(own.min, own.max, random);
        bool asked = false;
        for (OctreeCell at = cell; !asked && at.level <= settings.max_depth;
             at = childAt(octree, at, point)) {
          asked =
              (!is_merged || at.level > cell.level) && askedAbout(octree, at, settings.viewers).holds(point);
        }
        EXPECT_TRUE(asked) << "leaf " << leaf << " seed " << seed;
      }
    });
  }
  EXPECT_GT(partial, 100u) << "the test would prove little";
  EXPECT_GT(merged, 5u) << "the test would prove little";
}

TEST(ViewerBounds, LeaveOutNothingThatIsSeenFromAnywhereInThem) {
  std::size_t hidden = 0, seen = 0;
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    for (const bool fused : {false, true}) {
      const Scene scene = roomsScene(seed);
      const BakedVisibility result = baked(scene, settingsFor(seed, fused));
      EXPECT_FALSE(result.octree.viewers.empty());
      BakeJudge judge(scene, result);
      judge.judge(2, fused ? 1 : 3, 0.05, seed);
      hidden += judge.hidden;
      seen += judge.seen;
    }
  }
  EXPECT_GT(seen, 500u);
  EXPECT_GT(hidden, seen) << "the test would prove little";
}

TEST(ViewerBounds, MakeSetsSmaller) {
  const Scene scene = roomsScene(2);
  for (const bool fused : {false, true}) {
    BakeSettings settings = settingsFor(2, fused);
    settings.max_depth = 3;
    settings.triangle_budget = 0;
    settings.merge_tolerance = 0.0;
    const BakedVisibility parts = baked(scene, settings);
    settings.whole_cells = true;
    const BakedVisibility whole = baked(scene, settings);
    EXPECT_TRUE(whole.octree.viewers.empty());
    const sight_test::Bytes part_bytes = sight_test::bytesOf(parts), whole_bytes = sight_test::bytesOf(whole);
    SetQuery query(*SightFile::fromBytes(part_bytes, "parts")),
        other(*SightFile::fromBytes(whole_bytes, "whole"));
    const auto count = [](SetQuery& sets, const Vec3d& eye) {
      std::uint32_t objects = 0;
      for (const std::uint32_t node : sets.find(eye, 0.05).nodes) {
        objects += sets.boxes().nodes[node].object_count;
      }
      return objects;
    };
    std::uint64_t kept = 0, kept_by_whole = 0;
    std::mt19937 random(5);
    for (const Box& box : settings.viewers) {
      for (int i = 0; i < 50; ++i) {
        const Vec3d eye = test::pointIn(Vec3d(box.min), Vec3d(box.max), random);
        kept += count(query, eye);
        kept_by_whole += count(other, eye);
      }
    }
    EXPECT_LT(kept, kept_by_whole) << fused;
  }
}

TEST(ViewerBounds, AreAllOfEachCellWhereNoBoxesAreGiven) {
  const Scene scene = roomsScene(3);
  const BakedVisibility result = baked(scene, {.max_depth = 4});
  EXPECT_TRUE(result.octree.viewers.empty());
  // A box of viewers that is the root gives the same cells.
  const BakedVisibility whole = baked(scene, {.max_depth = 3, .viewers = {{{0, 0, 0}, {16, 16, 16}}}});
  EXPECT_TRUE(whole.octree.viewers.empty());
}

// Boxes that begin and end anywhere, or exactly at the borders of cells: what is hidden from a parent is
// taken to be hidden from its children.
TEST(ViewerBounds, OfAChildLieWithinItsParents) {
  const Scene scene = sceneOf({block({0, 0, 0}, {1, 1, 1}), block({3, 3, 3}, {4, 4, 4})});
  const OccluderSet set = test::allOccluders(scene);
  const double edge = 16.0 * (1.0 + 0x1p-20);  // of the root around viewers from 0 to 16
  std::size_t children = 0;
  for (std::uint32_t seed = 1; seed <= 100; ++seed) {
    std::mt19937 random(seed);
    const auto place = [&] {
      const auto levels = static_cast<std::uint32_t>(random() % 5),
                 at = static_cast<std::uint32_t>(random() % ((1u << levels) + 1));
      const double border = std::min(edge * at / (1u << levels), 16.0);
      return random() % 2 == 0 ? static_cast<float>(border) : static_cast<float>(random() % 1600) / 100.0f;
    };
    std::vector<Box> viewers{{{0, 0, 0}, {0.01f, 0.01f, 0.01f}}, {{15.9f, 15.9f, 15.9f}, {16, 16, 16}}};
    for (int i = 0; i < 3; ++i) {
      Box box;
      box.extend(Vec3f(place(), place(), place()));
      box.extend(Vec3f(place(), place(), place()));
      viewers.push_back(box);
    }
    const pvs::BakeScene bake(scene.view(), set, {.max_depth = 3, .viewers = viewers}, serialFor);
    std::vector<OctreeCell> below{{}};
    while (!below.empty()) {
      const OctreeCell cell = below.back();
      below.pop_back();
      const pvs::CellBox region = bake.regionOf(cell);
      for (std::uint32_t i = 0; i < 8 && cell.level < 4; ++i) {
        const OctreeCell child = cell.child(i);
        if (!bake.holdsViewers(bake.boxOf(child))) {
          continue;
        }
        const pvs::CellBox inner = bake.regionOf(child);
        for (int axis = 0; axis < 3; ++axis) {
          ASSERT_GE(inner.min[axis], region.min[axis]) << seed;
          ASSERT_LE(inner.max[axis], region.max[axis]) << seed;
        }
        ++children;
        below.push_back(child);
      }
    }
  }
  EXPECT_GT(children, 10'000u);
}

// The viewers begin at the border between two cells. From the last step of the cell that they only touch, one
// looks past the wall.
TEST(ViewerBounds, OfACellThatViewersOnlyTouchClaimNothingThatWasNotAsked) {
  std::vector<Solid> solids{block({4.065f, 5, 3}, {12, 14, 3.1f}),
                            block({4.6f, 9.4f, 10}, {4.7f, 9.5f, 10.1f})};
  for (int i = 0; i < 4; ++i) {
    const auto x = static_cast<float>(i) + 1.0f;
    solids.push_back(block({x, 8.5f, 4}, {x + 0.8f, 9.5f, 4.6f}));
    solids.push_back(block({x, 12.5f, 1}, {x + 2, 15, 1.1f}));
  }
  const Scene scene = sceneOf(solids);
  const float border = 4.0f + 0x1p-18f;
  const BakeSettings settings{.triangle_budget = 0,
                              .max_depth = 3,
                              .near_distance = 0.05,
                              .viewers = {{{0, 0, 0}, {0.01f, 0.01f, 0.01f}},
                                          {{15.99f, 15.99f, 15.99f}, {16, 16, 16}},
                                          {{border, 9, 1}, {5, 10, 2}}},
                              .merge_tolerance = 0.0};
  const BakedVisibility made = baked(scene, settings);
  BakeJudge judge(scene, made);
  judge.judge(20, 1, 0.05, 1);
  const sight_test::Bytes bytes = sight_test::bytesOf(made);
  SetQuery query(*SightFile::fromBytes(bytes, "touched"));
  EXPECT_TRUE(sight_test::seenBy(query, {3.97, 9.45, 1.99}, 0.05)[1])
      << "a line of sight passes beside the wall";
}

// Cells with hand-made sets: what they become when they are merged.
class MergedViewers : public ::testing::Test {
 protected:
  const Scene scene_ = sceneOf({block({0, 0, 0}, {1, 1, 1}), block({3, 3, 3}, {4, 4, 4})});
  const OccluderSet set_ = test::allOccluders(scene_);
  const pvs::BakeScene bake_{
      scene_.view(), set_, {.max_depth = 2, .viewers = {{{0, 0, 0}, {4, 4, 4}}}}, serialFor};
  pvs::BakedCell cell_;

  MergedViewers() {
    for (int i = 0; i < 8; ++i) {
      pvs::BakedCell child;
      child.level = 1;
      child.sets.whole = {{0, 1}};
      cell_.children.push_back(child);
    }
  }
  void setAll(const ViewerBounds& viewers) {
    for (pvs::BakedCell& child : cell_.children) {
      child.viewers = viewers;
    }
  }
  void leaveOut(std::size_t child) {
    cell_.children[child].reason = StopReason::kOutside;
    cell_.children[child].sets.whole = {{0, 2}};
  }
};

TEST_F(MergedViewers, AreThoseOfAllChildren) {
  pvs::mergeChildren(bake_, cell_);
  ASSERT_TRUE(cell_.leaf());
  EXPECT_EQ(cell_.viewers, ViewerBounds{});
}

TEST_F(MergedViewers, DoNotJoinBoxesWithAGapBetween) {
  setAll({{0, 0, 0}, {255, 127, 255}});
  pvs::mergeChildren(bake_, cell_);
  EXPECT_FALSE(cell_.leaf());
}

TEST_F(MergedViewers, AreABoxInTheLowerHalfWhereTheUpperHoldsNone) {
  for (const std::size_t upper : {2u, 3u, 6u, 7u}) {
    leaveOut(upper);
  }
  for (pvs::BakedCell& child : cell_.children) {
    child.viewers = {{0, 64, 0}, {255, 127, 255}};
  }
  pvs::mergeChildren(bake_, cell_);
  ASSERT_TRUE(cell_.leaf());
  EXPECT_EQ(cell_.viewers, (ViewerBounds{{0, 32, 0}, {255, 63, 255}}));
  EXPECT_EQ(cell_.sets.whole.back().end, 1u) << "what holds no viewers adds nothing";
}

TEST_F(MergedViewers, DoNotReachIntoACellThatHoldsNone) {
  leaveOut(5);
  pvs::mergeChildren(bake_, cell_);
  EXPECT_FALSE(cell_.leaf());
}

TEST_F(MergedViewers, AreOfWholeStepsOfTheLargerCell) {
  for (std::size_t upper = 4; upper < 8; ++upper) {
    leaveOut(upper);
  }
  setAll({{0, 0, 0}, {255, 255, 126}});
  pvs::mergeChildren(bake_, cell_);
  EXPECT_FALSE(cell_.leaf());
}

TEST_F(MergedViewers, AreReadAsWritten) {
  setAll({{1, 2, 3}, {4, 5, 6}});
  base::ByteWriter writer;
  pvs::write(cell_, writer);
  const std::vector<std::byte> bytes = writer.take();
  base::ByteReader reader(bytes);
  const std::optional<pvs::BakedCell> read = pvs::readCell(reader, 0, bake_);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->children[7].viewers, cell_.children[7].viewers);
  // The first child: two bytes for what the cell and it are, one for its reason, then where its viewers are.
  std::vector<std::byte> damaged = bytes;
  damaged[3] = std::byte{5};
  base::ByteReader of_damaged(damaged);
  EXPECT_FALSE(pvs::readCell(of_damaged, 0, bake_)) << "viewers that end before they begin";
}

}  // namespace
}  // namespace sightline
