// Parts that are unions of many hulls: frames of boxes, some linked as the rings of a chain are.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "tests/layers/made_parts.h"

namespace sightline {
namespace {

using namespace made;

// The edges of a square in a plane, each made of three boxes: a ring of 12 hulls.
MadePart squareFrame(Random& random, int reach) {
  const int normal = static_cast<int>(random.below(3)), across = (normal + 1) % 3, along = (normal + 2) % 3;
  const double half = random.whole(3, 6);
  MadePart part;
  for (const double side : {-half, half}) {
    for (const auto& [fixed, running] : {std::pair(across, along), std::pair(along, across)}) {
      for (int piece = 0; piece < 3; ++piece) {
        Vec3d from, to;
        from[normal] = -0.5, to[normal] = 0.5;
        from[fixed] = side - 0.5, to[fixed] = side + 0.5;
        from[running] = -half + piece * half * 0.75, to[running] = -half + (piece + 1) * half * 0.75;
        part.hulls.push_back(shapes::box(from, to));
      }
    }
  }
  part.world_from_part = translation(shapes::randomGrid(random, 1, reach)[0]);
  return part;
}

TEST(LayerSorterUnions, HaveExactlyTheArcsGroupsAndCollisionsOfTheirHulls) {
  std::size_t alone = 0, grouped = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    MadeScene scene;
    for (int i = 0; i < 3; ++i) {
      scene.parts.push_back(squareFrame(random, 6));
    }
    scene.parts.push_back(randomPart(random, 5));
    scene.view = randomView(random, scene, 12);
    const Truth truth = truthOf(scene);
    for (const Group& group : truth.groups) {
      ++(group.size() > 1 ? grouped : alone);
    }
    for (const bool all_arcs : {true, false}) {
      for (const Way& way : allWays(all_arcs)) {
        SCOPED_TRACE(way.name);
        LayerSorter sorter = sorterOf(scene, way.settings);
        // Twice, since the second frame starts from the results of the first.
        for (int frame = 0; frame < 2; ++frame) {
          expectTrue(Answer(sorter.update(scene.view)), truth, all_arcs);
        }
        ASSERT_FALSE(HasFailure());
      }
    }
  }
  EXPECT_GT(alone, 5u);
  EXPECT_GT(grouped, 5u);
}

// A wheel of many wedges around the z axis.
std::vector<HullId> wheel(LayerSorter& sorter, int hulls) {
  std::vector<HullId> ids;
  for (int i = 0; i < hulls; ++i) {
    Points points;
    for (const int end : {i, i + 1}) {
      const double angle = 2.0 * 3.14159265358979 * end / hulls;
      const Vec3d out{std::cos(angle), std::sin(angle), 0.0};
      for (const double radius : {0.9, 1.1}) {
        points.push_back(out * radius + Vec3d{0, 0, -0.1});
        points.push_back(out * radius + Vec3d{0, 0, 0.1});
      }
    }
    ids.push_back(sorter.addHull(*buildHull(points)));
  }
  return ids;
}

// Two wheels whose images cross, one well behind the other: of 4,096 pairs of hulls few have extents that
// overlap.
TEST(LayerSorterUnions, FewPairsOfTheHullsOfTwoPartsAreTested) {
  LayerSorter sorter({.arcs = LayerArcs::kAll});
  const std::vector<HullId> hulls = wheel(sorter, 64);
  const PartId near = sorter.addPart(hulls), far = sorter.addPart(hulls);
  sorter.setTransform(far, translation({0.8, 0.0, -3.0}));
  const LayerOrder& order = sorter.update(viewFrom({0.0, 0.0, 8.0}));
  ASSERT_EQ(order.arcs.size(), 1u);
  EXPECT_EQ(order.arcs[0].front, near);
  EXPECT_EQ(order.arcs[0].back, far);
  EXPECT_LT(order.stats.known_pairs, 200u);
}

}  // namespace
}  // namespace sightline
