// The order from which a sort starts: by distance from the eye at first, then that of the last frame (section
// 4).

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/layers/made_parts.h"
#include "tests/layers/moving_sorter.h"
#include "tests/layers/sorter_choices.h"

namespace sightline {
namespace {

using namespace made;

MadePart cubeAt(const Vec3d& centre) {
  return {.hulls = {shapes::cube()}, .world_from_part = translation(centre), .settings = {}, .enabled = true};
}

MadeScene cubesAt(const std::vector<Vec3d>& centres, const Vec3d& eye) {
  MadeScene scene;
  for (const Vec3d& centre : centres) {
    scene.parts.push_back(cubeAt(centre));
  }
  scene.view = viewFrom(eye);
  return scene;
}

LayerSettings unconditioned(SortChoice sort) {
  LayerSettings settings;
  settings.sort = sortOf(sort);
  settings.conditioning = false;
  return settings;
}

std::vector<std::uint32_t> partsOf(const LayerOrder& order) {
  std::vector<std::uint32_t> parts;
  for (const PartId part : order.parts) {
    parts.push_back(part.value);
  }
  return parts;
}

// Returns the part numbers, nearest to the eye first.
std::vector<std::uint32_t> byDistance(const std::vector<Vec3d>& centres, const Vec3d& eye) {
  std::vector<std::uint32_t> parts(centres.size());
  for (std::uint32_t i = 0; i < parts.size(); ++i) {
    parts[i] = i;
  }
  std::sort(parts.begin(), parts.end(), [&](std::uint32_t a, std::uint32_t b) {
    return length(centres[a] - eye) < length(centres[b] - eye);
  });
  return parts;
}

// None of these parts occludes another, from either of the eyes below.
const std::vector<Vec3d> kSideBySide{{20, 0, 0}, {0, 0, 0}, {40, 0, 0}, {10, 0, 0}, {30, 0, 0}};
const Vec3d kLeft{-5, 0, 50}, kRight{45, 0, 50};

TEST(LayerSorterCoherence, TheFirstOrderIsByDistanceWhereNothingIsOccluded) {
  for (const SortChoice sort : kSortChoices) {
    for (const Vec3d& eye : {kLeft, kRight}) {
      LayerSorter sorter = sorterOf(cubesAt(kSideBySide, eye), unconditioned(sort));
      EXPECT_EQ(partsOf(sorter.update(viewFrom(eye))), byDistance(kSideBySide, eye));
    }
  }
}

TEST(LayerSorterCoherence, TheFirstOrderTakesAPartByTheMeanOfItsHulls) {
  MadeScene scene = cubesAt({{}, {12, 0, -16}, {-18, 0, -24}}, {});
  scene.parts[0].hulls = {shapes::cube({0, 0, -10}), shapes::cube({0, 0, -40})};
  for (const SortChoice sort : kSortChoices) {
    LayerSorter sorter = sorterOf(scene, unconditioned(sort));
    EXPECT_EQ(partsOf(sorter.update(scene.view)), (std::vector<std::uint32_t>{1, 0, 2}));
  }
}

// A sort by depth would put parts behind the eye in reverse order.
TEST(LayerSorterCoherence, TheFirstOrderIsRightBehindTheEyeToo) {
  const std::vector<Vec3d> row{{0, 0, 15}, {0, 0, -30}, {0, 0, 5}, {0, 0, -10}, {0, 0, 25}, {0, 0, -20}};
  LayerSorter sorter = sorterOf(cubesAt(row, {}), unconditioned(SortChoice::kIncremental));
  const LayerOrder& order = sorter.update(viewFrom({}));
  EXPECT_EQ(partsOf(order), byDistance(row, {}));
  EXPECT_EQ(order.stats.reinsertions, 0u);
  EXPECT_EQ(order.stats.occluder_queries, row.size());
}

TEST(LayerSorterCoherence, TheFirstOrderOfAnOrthographicViewIsAlongItsDirection) {
  const std::vector<Vec3d> spread{{90, 0, -10}, {0, 0, -30}, {-50, 0, -20}, {20, 0, 5}};
  for (const SortChoice sort : kSortChoices) {
    LayerSorter sorter = sorterOf(cubesAt(spread, {}), unconditioned(sort));
    View view = viewFrom({});
    view.orthographic = true;
    EXPECT_EQ(partsOf(sorter.update(view)), (std::vector<std::uint32_t>{3, 0, 2, 1}));
  }
}

TEST(LayerSorterCoherence, AnOrderThatIsStillRightStaysUntilItIsReset) {
  for (const SortChoice sort : kSortChoices) {
    LayerSorter sorter = sorterOf(cubesAt(kSideBySide, kLeft), unconditioned(sort));
    sorter.update(viewFrom(kLeft));
    EXPECT_EQ(partsOf(sorter.update(viewFrom(kRight))), byDistance(kSideBySide, kLeft));
    EXPECT_EQ(partsOf(sorter.update(viewFrom(kRight))), byDistance(kSideBySide, kLeft));
    sorter.reset();
    EXPECT_EQ(partsOf(sorter.update(viewFrom(kRight))), byDistance(kSideBySide, kRight));
  }
}

TEST(LayerSorterCoherence, WhatIsNewFollowsTheLastOrderByDistance) {
  for (const SortChoice sort : kSortChoices) {
    LayerSorter sorter = sorterOf(cubesAt(kSideBySide, kLeft), unconditioned(sort));
    sorter.setEnabled(PartId(3u), false);
    sorter.setEnabled(PartId(1u), false);
    EXPECT_EQ(partsOf(sorter.update(viewFrom(kLeft))), (std::vector<std::uint32_t>{0, 4, 2}));
    sorter.setEnabled(PartId(3u), true);
    sorter.setEnabled(PartId(1u), true);
    addMade(sorter, cubeAt({50, 0, 0}));
    EXPECT_EQ(partsOf(sorter.update(viewFrom(kRight))), (std::vector<std::uint32_t>{0, 4, 2, 5, 3, 1}));
  }
}

TEST(LayerSorterCoherence, ConditioningBringsTheNearestForwardWhateverTheLastOrder) {
  const std::vector<Vec3d> at{{20, 0, -3}, {0, 0, 9}, {40, 0, -6}, {10, 0, 3}, {30, 0, 6}};
  const std::vector<std::uint32_t> by_depth{1, 4, 3, 0, 2};
  for (const SortChoice sort : kSortChoices) {
    LayerSettings settings = unconditioned(sort);
    LayerSorter plain = sorterOf(cubesAt(at, kLeft), settings);
    ASSERT_EQ(partsOf(plain.update(viewFrom(kLeft))), byDistance(at, kLeft));
    ASSERT_NE(byDistance(at, kLeft), by_depth);
    settings.conditioning = true;
    LayerSorter sorter = sorterOf(cubesAt(at, kLeft), settings);
    const LayerOrder& first = sorter.update(viewFrom(kLeft));
    EXPECT_EQ(partsOf(first), by_depth);
    EXPECT_GT(first.stats.conditioned, 0u);
    // The next sort starts from the conditioned order.
    const LayerOrder& second = sorter.update(viewFrom(kRight));
    EXPECT_EQ(partsOf(second), by_depth);
    EXPECT_EQ(second.stats.conditioned, 0u);
  }
}

TEST(LayerSorterCoherence, TheAxisOfConditioningIsTheCamerasOwnWhereverItStands) {
  const std::vector<Vec3d> at{{20, 0, -3}, {0, 0, 9}, {40, 0, -6}, {10, 0, 3}, {30, 0, 6}};
  const std::vector<ExtentAxis> camera = cameraExtents(), world = worldExtents();
  const std::vector<std::vector<ExtentAxis>> with_depth{
      camera, {camera[2], camera[0], camera[1]}, {world[2], camera[0], camera[2]}};
  for (const std::vector<ExtentAxis>& extents : with_depth) {
    LayerSorter sorter = sorterOf(cubesAt(at, kLeft), {.extents = extents});
    EXPECT_EQ(partsOf(sorter.update(viewFrom(kLeft))), (std::vector<std::uint32_t>{1, 4, 3, 0, 2}));
  }
  const std::vector<std::vector<ExtentAxis>> without{world, {camera[0], camera[1]}, {}};
  for (const std::vector<ExtentAxis>& extents : without) {
    LayerSorter sorter = sorterOf(cubesAt(at, kLeft), {.extents = extents});
    EXPECT_EQ(partsOf(sorter.update(viewFrom(kLeft))), byDistance(at, kLeft));
  }
}

// Two intersecting parts at 23 and 35 m, and single parts at 26 m and 32 m.
TEST(LayerSorterCoherence, ConditioningTakesAGroupByTheMeanOfItsParts) {
  MadeScene scene;
  for (const auto& [x, near, far] : {std::array{80.0, -31.0, -33.0}, std::array{0.0, -25.0, -45.0},
                                     std::array{40.0, -25.0, -27.0}, std::array{0.0, -20.0, -26.0}}) {
    scene.parts.push_back({.hulls = {shapes::box({x - 1, -1, far}, {x + 1, 1, near})},
                           .world_from_part = {},
                           .settings = {},
                           .enabled = true});
  }
  for (const SortChoice sort : kSortChoices) {
    LayerSettings settings;
    settings.sort = sortOf(sort);
    LayerSorter sorter = sorterOf(scene, settings);
    const LayerOrder& order = sorter.update(viewFrom({}));
    ASSERT_EQ(order.groups(), 3u);
    EXPECT_EQ(partsOf(order), (std::vector<std::uint32_t>{2, 3, 1, 0}));
  }
}

// A row of plates across the view's axis that reach far to one side. Each plate occludes all plates behind
// it, and the distance of its middle does not tell its place in the row.
struct Plates {
  static constexpr std::uint32_t kCount = 40;
  MadeScene scene;

  Plates() {
    Random random(4);
    for (std::uint32_t i = 0; i < kCount; ++i) {
      const double reach = random.whole(2, 400);
      scene.parts.push_back({.hulls = {shapes::box({-1, -1, 0}, {reach, 1, 0.5})},
                             .world_from_part = translation({0, 0, depthOf(i)}),
                             .settings = {},
                             .enabled = true});
    }
    scene.view = viewFrom({});
  }
  // Part numbers are not in the order of the row, either.
  static std::uint32_t place(std::uint32_t part) { return part * 17 % kCount; }
  static double depthOf(std::uint32_t part) { return -10.0 - 2.0 * place(part); }
  static std::vector<std::uint32_t> rightOrder() {
    std::vector<std::uint32_t> order(kCount);
    for (std::uint32_t part = 0; part < kCount; ++part) {
      order[place(part)] = part;
    }
    return order;
  }
};

TEST(LayerSorterCoherence, AFrameInWhichNothingChangesFindsItsOrderConfirmed) {
  const Plates plates;
  for (const SortChoice sort : kSortChoices) {
    LayerSorter sorter = sorterOf(plates.scene, unconditioned(sort));
    const LayerOrder& cold = sorter.update(plates.scene.view);
    ASSERT_EQ(partsOf(cold), Plates::rightOrder());
    const LayerStats cold_stats = cold.stats;
    const LayerOrder& warm = sorter.update(plates.scene.view);
    EXPECT_EQ(partsOf(warm), Plates::rightOrder());
    EXPECT_EQ(warm.stats.occluder_queries, Plates::kCount);
    EXPECT_EQ(warm.stats.reinsertions, 0u);
    // All active parts lie behind the part whose occluders are asked for.
    EXPECT_EQ(warm.stats.candidates, 0u);
    EXPECT_EQ(warm.stats.pair_queries, 0u);
    EXPECT_GT(cold_stats.candidates, Plates::kCount);
    EXPECT_EQ(cold_stats.reinsertions > 0, sort == SortChoice::kIncremental);
    sorter.reset();
    EXPECT_EQ(sorter.update(plates.scene.view).stats.candidates, cold_stats.candidates);
  }
}

TEST(LayerSorterCoherence, TwoNeighboursThatChangePlacesCostOneReinsertionAndOneCandidate) {
  const Plates plates;
  const std::vector<std::uint32_t> order = Plates::rightOrder();
  for (const SortChoice sort : kSortChoices) {
    for (const std::size_t at : {std::size_t{0}, std::size_t{20}, order.size() - 2}) {
      LayerSorter sorter = sorterOf(plates.scene, unconditioned(sort));
      sorter.update(plates.scene.view);
      std::vector<std::uint32_t> expected = order;
      std::swap(expected[at], expected[at + 1]);
      ASSERT_TRUE(
          sorter.setTransform(PartId(order[at]), translation({0, 0, Plates::depthOf(order[at + 1])})));
      ASSERT_TRUE(
          sorter.setTransform(PartId(order[at + 1]), translation({0, 0, Plates::depthOf(order[at])})));
      const LayerOrder& warm = sorter.update(plates.scene.view);
      EXPECT_EQ(partsOf(warm), expected);
      EXPECT_EQ(warm.stats.candidates, 1u);
      EXPECT_EQ(warm.stats.pair_queries, 1u);
      EXPECT_EQ(warm.stats.reinsertions, sort == SortChoice::kIncremental ? 1u : 0u);
    }
  }
}

TEST(LayerSorterCoherence, SmallMotionsCostFewerExactTestsThanSortingAnew) {
  const MovingScene scene = makeToothpicks({.count = 200});
  for (const SortChoice sort : kSortChoices) {
    LayerSettings settings;
    settings.sort = sortOf(sort);
    MovingSorter warm(scene, settings), cold(scene, settings);
    LayerStats warm_sum, cold_sum;
    const auto add = [](LayerStats& sum, const LayerStats& stats) {
      sum.candidates += stats.candidates;
      sum.pair_queries += stats.pair_queries;
      sum.reinsertions += stats.reinsertions;
    };
    for (std::uint32_t frame = 0; frame < 30; ++frame) {
      cold.sorter().reset();
      const LayerStats of_warm = warm.update(frame).stats, of_cold = cold.update(frame).stats;
      if (frame > 0) {
        add(warm_sum, of_warm);
        add(cold_sum, of_cold);
      }
    }
    EXPECT_LT(warm_sum.candidates, cold_sum.candidates);
    EXPECT_LT(warm_sum.pair_queries, cold_sum.pair_queries);
    EXPECT_EQ(warm_sum.reinsertions < cold_sum.reinsertions, sort == SortChoice::kIncremental);
  }
}

// The result of a pair is kept for as long as the settings say.
TEST(LayerSorterCoherence, WhatIsKnownOfPairsShortensTheNextFrameUnlessItExpires) {
  const MovingScene scene = makeToothpicks({.count = 200});
  for (const SortChoice sort : kSortChoices) {
    LayerSettings settings;
    settings.sort = sortOf(sort);
    MovingSorter keeping(scene, settings);
    settings.pair_expiry = 0;
    MovingSorter forgetting(scene, settings);
    const auto stepsOf = [](const LayerStats& stats) { return stats.chung_steps + stats.gjk_steps; };
    const std::uint64_t first = stepsOf(keeping.update(0).stats);
    EXPECT_EQ(stepsOf(forgetting.update(0).stats), first);
    const std::uint64_t kept = stepsOf(keeping.update(1).stats),
                        forgotten = stepsOf(forgetting.update(1).stats);
    EXPECT_LT(kept, forgotten);
    EXPECT_GT(keeping.sorter().update(keeping.view(1)).stats.known_pairs, 0u);
  }
}

}  // namespace
}  // namespace sightline
