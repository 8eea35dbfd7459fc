// Object-space structures built from several sets of occluders for one view.

#include <gtest/gtest.h>

#include <string>

#include "sightline/comparison/kept_planes.h"
#include "sightline/occlusion/occlusion_tree.h"
#include "sightline/occlusion/supporting_planes.h"
#include "tests/occlusion/small_scenes.h"

namespace sightline {
namespace {

using test::all, test::kLookingBack, test::lookAt, test::OraclePolygon, test::setOf, test::wall;

// try_with(structure, name)
template <typename Try>
void withEach(Try&& try_with) {
  for (const OcclusionTreeVariant variant : test::kTreeVariants) {
    OcclusionTree tree({.variant = variant});
    try_with(tree, "tree variant " + std::to_string(static_cast<int>(variant)));
  }
  SupportingPlanes planes;
  try_with(planes, "supporting planes");
  KeptPlanes kept_planes;
  try_with(kept_planes, "kept planes");
}

TEST(SeveralSets, EachHidesAsIfItWereAlone) {
  const OccluderSet left = setOf(std::vector{wall(-3, -1, -1, 1, -5)});
  const OccluderSet right = setOf(std::vector{wall(1, 3, -1, 1, -5), wall(6, 7, -1, 1, -5)});
  const std::vector<OccluderId> of_left = all(left), of_right = all(right);
  const Box behind_left{{-4.5f, -1, -11}, {-3.5f, 1, -10}}, behind_right{{3.5f, -1, -11}, {4.5f, 1, -10}},
      between{{-0.5f, -1, -11}, {0.5f, 1, -10}};
  withEach([&](auto& structure, const std::string& name) {
    const ChosenOccluders sets[] = {{&left, of_left}, {&right, of_right}};
    for (int frame = 0; frame < 2; ++frame) {
      structure.build(kLookingBack, sets);
      EXPECT_EQ(structure.classify(behind_left), Visibility::kHidden) << name;
      EXPECT_EQ(structure.classify(behind_right), Visibility::kHidden) << name;
      EXPECT_EQ(structure.classify(between), Visibility::kVisible) << name;
      EXPECT_EQ(structure.stats().occluders, 3u) << name;
      EXPECT_EQ(structure.occluders().size(), 1u) << name << ": of the first set";
      structure.build(kLookingBack, left, of_left);
      EXPECT_EQ(structure.classify(behind_left), Visibility::kHidden) << name;
      EXPECT_NE(structure.classify(behind_right), Visibility::kHidden) << name << ": of the last build only";
    }
  });
}

// Two walls that share an edge, which is watertight within one set.
TEST(SeveralSets, HaveNoWatertightEdgeBetweenThem) {
  const OraclePolygon left = wall(-3, 0, -2, 2, -5), right = wall(0, 3, -2, 2, -5);
  const OccluderSet both = setOf(std::vector{left, right}), first = setOf(std::vector{left}),
                    second = setOf(std::vector{right});
  const std::vector<OccluderId> of_both = all(both), of_first = all(first), of_second = all(second);
  const Box box{{-1, -1, -11}, {1, 1, -10}};
  withEach([&](auto& structure, const std::string& name) {
    structure.build(kLookingBack, both, of_both);
    EXPECT_EQ(structure.classify(box), Visibility::kHidden) << name;
    const ChosenOccluders sets[] = {{&first, of_first}, {&second, of_second}};
    structure.build(kLookingBack, sets);
    EXPECT_EQ(structure.classify(box), Visibility::kPartial) << name;
    // Both ids are in both sets, and each is the other's neighbour in its own set only.
    const ChosenOccluders halves[] = {{&both, std::span(of_both).first(1)},
                                      {&both, std::span(of_both).last(1)}};
    structure.build(kLookingBack, halves);
    EXPECT_EQ(structure.classify(box), Visibility::kPartial) << name;
  });
}

TEST(SeveralSets, AreMergedByTheTreeWhereTheyOverlap) {
  const OccluderSet near = setOf(std::vector{wall(-3, 0.5f, -2, 2, -5)}),
                    far = setOf(std::vector{wall(-0.5f, 4, -3, 3, -6)});
  const std::vector<OccluderId> of_near = all(near), of_far = all(far);
  OcclusionTree tree;
  const ChosenOccluders sets[] = {{&near, of_near}, {&far, of_far}};
  tree.build(kLookingBack, sets);
  EXPECT_EQ(tree.classify(Box{{-1, -1, -11}, {1, 1, -10}}), Visibility::kHidden);
}

TEST(SeveralSets, FindRoomInTheTreeFromTheirFirstOnesOn) {
  const OccluderSet left = setOf(std::vector{wall(-3, -1, -1, 1, -5)});
  const OccluderSet right = setOf(std::vector{wall(1, 3, -1, 1, -5)});
  const std::vector<OccluderId> of_left = all(left), of_right = all(right);
  const ChosenOccluders sets[] = {{&left, of_left}, {&right, of_right}};
  for (const std::uint32_t max_nodes : {0u, 3u, 5u, 8u, 12u, 13u, 100u}) {
    OcclusionTree tree({.max_nodes = max_nodes});
    tree.build(kLookingBack, sets);
    EXPECT_EQ(tree.stats().dropped + tree.stats().unusable + tree.stats().occluders, 2u) << max_nodes;
    EXPECT_EQ(tree.classify(Box{{-0.5f, -1, -11}, {0.5f, 1, -10}}), Visibility::kVisible);
  }
}

TEST(SeveralSets, HideNothingThatARayReaches) {
  std::size_t hidden = 0;
  for (const test::Family& family : test::kFamilies) {
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
      test::RandomScene scene(family, seed);
      // The polygons are distributed to the sets at random, so connected walls get into different sets.
      std::vector<OraclePolygon> parts[2];
      for (const OraclePolygon& polygon : scene.polygons) {
        parts[scene.random.bits() % 2].push_back(polygon);
      }
      const OccluderSet first = setOf(parts[0]), second = setOf(parts[1]);
      const std::vector<OccluderId> of_first = all(first), of_second = all(second);
      const ChosenOccluders sets[] = {{&first, of_first}, {&second, of_second}};
      std::vector<Box> boxes;
      for (int i = 0; i < 25; ++i) {
        boxes.push_back(scene.randomBox());
      }
      withEach([&](auto& structure, const std::string& name) {
        structure.build(scene.view, sets);
        for (const Box& box : boxes) {
          if (structure.classify(box) != Visibility::kHidden) {
            continue;
          }
          ++hidden;
          EXPECT_FALSE(lookAt(box, scene.view, scene.polygons, 60, scene.random.engine()).seen)
              << name << ", " << family.name << ", seed " << seed;
        }
      });
    }
  }
  EXPECT_GT(hidden, 500u);
}

TEST(SeveralSets, RelationsAreKeptOfTheFirstOneOnly) {
  const OccluderSet own = setOf(std::vector{wall(-1, 1, -1, 1, -5)});
  OccluderSet moving = setOf(std::vector{wall(3, 5, -1, 1, -5)});
  const std::vector<OccluderId> of_own = all(own), of_moving = all(moving);
  const ChosenOccluders sets[] = {{&own, of_own}, {&moving, of_moving}};
  KeptPlanes planes;
  const Box behind_own{{-1, -1, -12}, {1, 1, -10}}, behind_moving{{7.5f, -1, -12}, {9, 1, -11}};
  for (int frame = 0; frame < 4; ++frame) {
    // The second set is in the same memory and has the same id and shape: first in front of the box, then
    // elsewhere.
    moving = setOf(std::vector{frame % 2 == 0 ? wall(3, 5, -1, 1, -5) : wall(-5, -3, -1, 1, -5)});
    planes.build(kLookingBack, sets);
    OccluderList touching;
    EXPECT_EQ(planes.classify(behind_own, 0, planes.all(), touching), Visibility::kHidden);
    EXPECT_EQ(planes.classify(behind_moving, 1, planes.all(), touching) == Visibility::kHidden,
              frame % 2 == 0);
    EXPECT_LE(planes.stats().relations.kept, 2u) << "one of each box with its own occluder";
  }
}

}  // namespace
}  // namespace sightline
