// What is found by lines of sight must be what asking every occluder about every object finds.

#include "src/pvs/bake/convex/convex_search.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "src/pvs/bake/convex/shadow.h"
#include "tests/pvs/bake_scenes.h"
#include "tests/pvs/convex_scenes.h"
#include "tests/support/instruction_sets.h"
#include "tests/support/rounds.h"

namespace sightline::pvs {
namespace {

using test::allOccluders;
using test::block;
using test::Random;
using test::sceneOf;
using test::Solid;

// Walls, posts and crates around the middle, thick and thin.
Scene randomTown(Random& random, std::uint32_t count) {
  std::vector<Solid> solids;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec3d middle = random.point(40.0);
    const double size = std::pow(10.0, random.in(-0.7, 0.9));
    const Vec3d half(size * random.in(0.1, 1.0), size * random.in(0.3, 2.0), size * random.in(0.1, 1.0));
    solids.push_back(block(Vec3f(middle - half), Vec3f(middle + half)));
  }
  return sceneOf(solids);
}

// By place in BoxTree::objects: whether some occluder that counts hides it from all corners.
std::vector<bool> hiddenByAsking(const BakeScene& bake, std::span<const Vec3d> corners,
                                 const OccluderChoice& choice, const ObjectMask& known) {
  std::vector<bool> hidden(bake.boxes.objects.size());
  std::vector<std::uint32_t> chosen;
  bake.findOccluders(choice.search, choice.level, chosen);
  for (const std::uint32_t i : chosen) {
    const ConvexOccluder& occluder = bake.occluders[i];
    if ((choice.known && intersects(*choice.known, occluder.bounds)) ||
        known.contains(bake.position_of[occluder.object.value]) ||
        !separated(bake.occluders, occluder, corners, bake.settings.near_distance)) {
      continue;
    }
    // Counts, by place, the corners from which the occluder hides it.
    std::vector<std::uint32_t> hidden_from(hidden.size());
    for (const Vec3d& corner : corners) {
      Shadow shadow;
      Runs runs;
      if (makeShadow(bake.occluders, occluder, corner, bake.reach, shadow)) {
        bake.shadow_tree.hiddenBy(shadow, runs);
      }
      for (const ObjectRun& run : runs) {
        for (std::uint32_t at = run.begin; at < run.end; ++at) {
          ++hidden_from[at];
        }
      }
    }
    for (std::uint32_t at = 0; at < hidden.size(); ++at) {
      hidden[at] = hidden[at] || hidden_from[at] == corners.size();
    }
  }
  return hidden;
}

struct Town {
  Scene scene;
  OccluderSet occluders;
  BakeScene bake;

  explicit Town(std::uint64_t seed, bool with_bodies = true)
      : scene(made(seed)),
        occluders(found(scene, with_bodies)),
        bake(scene.view(), occluders,
             {.max_depth = 4, .near_distance = 0.01, .viewers = {{{-40, -40, -40}, {40, 40, 40}}}},
             serialFor) {}
  static OccluderSet found(const Scene& scene, bool with_bodies) {
    OccluderSet occluders = allOccluders(scene);
    if (!with_bodies) {
      occluders.bodies.clear();
    }
    return occluders;
  }
  static Scene made(std::uint64_t seed) {
    Random random(seed);
    Scene scene = randomTown(random, 20 + 40 * static_cast<std::uint32_t>(seed % 10));
    // Nothing hides an object without a box, and its box is none of those around it.
    if (seed % 3 != 0) {
      const float broken = seed % 3 == 1 ? INFINITY : std::numeric_limits<float>::quiet_NaN();
      scene.objects[seed % scene.objects.size()].bounds.max.y = broken;
    }
    return scene;
  }
};

CellBox cellAround(const Vec3d& middle, double half) {
  return {middle - Vec3d{half, half, half}, middle + Vec3d{half, half, half}};
}

TEST(ConvexSearch, FindsWhatAskingAllOccludersFinds) {
  std::size_t hidden_count = 0, seen_count = 0;
  for (std::uint64_t seed = 0; seed < test::rounds(60u); ++seed) {
    const Town town(seed);
    const BakeScene& bake = town.bake;
    const auto count = static_cast<std::uint32_t>(bake.boxes.objects.size());
    ConvexSearch search(bake);
    Random random(seed + 1000);
    for (int trial = 0; trial < 12; ++trial) {
      const CellBox cell = cellAround(random.point(35.0), std::pow(10.0, random.in(-1.0, 0.7)));
      std::vector<Vec3d> corners = cornersOf(cell);
      if (trial % 3 == 1) {
        const Vec3d normal = test::randomDirection(random);
        corners = cornersBefore(cell, normal, dot(normal, cell.centre()));
      } else if (trial % 3 == 2) {
        corners.resize(1);
      }
      OccluderChoice choice{.search = cellAround(cell.centre(), random.in(5.0, 200.0)), .level = 4};
      if (trial % 4 == 3) {
        choice.known = cellAround(cell.centre(), random.in(1.0, 20.0));
      }
      ObjectMask known;
      known.reset(count);
      for (std::uint32_t i = 0; trial % 2 == 1 && i < count; ++i) {
        const ObjectRun run{i, i + 1};
        known.add(std::span(&run, random.below(4) == 0 ? 1 : 0));
      }
      const std::vector<bool> expected = hiddenByAsking(bake, corners, choice, known);
      ObjectMask found;
      found.reset(count);
      for (const ConvexSearch::Found& by_one : search.hiddenFrom(corners, choice, known)) {
        found.add({&by_one.objects, 1});
      }
      for (std::uint32_t i = 0; i < count; ++i) {
        if (known.contains(i)) {
          continue;
        }
        ++(expected[i] ? hidden_count : seen_count);
        EXPECT_EQ(found.contains(i), expected[i])
            << "seed " << seed << ", trial " << trial << ", object " << i;
        EXPECT_EQ(search.hides(corners, choice, known, i), expected[i])
            << "seed " << seed << ", object " << i;
      }
    }
  }
  EXPECT_GT(hidden_count, test::rounds(3000u));
  EXPECT_GT(seen_count, test::rounds(3000u));
}

// A random part of the box.
CellBox partOf(Random& random, const CellBox& box) {
  CellBox part;
  for (int axis = 0; axis < 3; ++axis) {
    const double a = random.in(0.0, 1.0), b = random.in(0.0, 1.0);
    part.min[axis] = box.min[axis] + (box.max[axis] - box.min[axis]) * std::min(a, b);
    part.max[axis] = box.min[axis] + (box.max[axis] - box.min[axis]) * std::max(a, b);
  }
  return part;
}

ObjectMask maskOf(const std::vector<bool>& objects) {
  ObjectMask mask;
  mask.reset(static_cast<std::uint32_t>(objects.size()));
  for (std::uint32_t i = 0; i < objects.size(); ++i) {
    const ObjectRun run{i, i + 1};
    mask.add(std::span(&run, objects[i] ? 1 : 0));
  }
  return mask;
}

// Half of the towns have one-sided walls in place of solids, some of which look away from the cell.
TEST(ConvexSearch, FindsTheSameByListsOfCellsAround) {
  std::size_t hidden_count = 0, seen_count = 0;
  for (std::uint64_t seed = 0; seed < test::rounds(60u); ++seed) {
    const Town town(seed, seed % 2 == 0);
    const BakeScene& bake = town.bake;
    ConvexSearch search(bake);
    CellCandidates outer(bake), lists(bake);
    Random random(seed + 2000);
    for (int trial = 0; trial < 8; ++trial) {
      const CellBox around = cellAround(random.point(35.0), std::pow(10.0, random.in(-0.5, 0.9)));
      const CellBox cell = trial % 2 == 0 ? around : partOf(random, around);
      const CellBox part = partOf(random, cell);
      std::vector<Vec3d> corners = cornersOf(part);
      if (trial % 3 == 1) {
        const Vec3d normal = test::randomDirection(random);
        corners = cornersBefore(part, normal, dot(normal, part.centre()));
      }
      const OccluderChoice choice{.search = cellAround(cell.centre(), random.in(20.0, 200.0)), .level = 4};
      const OccluderChoice all{.search = cellAround({}, 1000.0), .level = 4};
      ObjectMask none;
      none.reset(static_cast<std::uint32_t>(bake.boxes.objects.size()));
      const ObjectMask hidden_around = maskOf(hiddenByAsking(bake, cornersOf(around), all, none)),
                       known = maskOf(hiddenByAsking(bake, cornersOf(cell), all, none));
      ASSERT_TRUE(outer.make(around, hidden_around, nullptr, 1'000'000));
      ASSERT_TRUE(lists.make(cell, known, trial % 4 < 2 ? nullptr : &outer, 1'000'000));
      const std::vector<bool> expected = hiddenByAsking(bake, corners, choice, known);
      ObjectMask found;
      found.reset(static_cast<std::uint32_t>(expected.size()));
      for (const auto& by_one : search.hiddenFrom(corners, choice, known, none, lists)) {
        found.add({&by_one.objects, 1});
      }
      for (std::uint32_t i = 0; i < expected.size(); ++i) {
        if (!known.contains(i)) {
          ++(expected[i] ? hidden_count : seen_count);
          EXPECT_EQ(found.contains(i), expected[i])
              << "seed " << seed << ", trial " << trial << ", object " << i;
        }
      }
      // What is known to be seen is not asked about.
      Runs left;
      found.complement(left);
      ObjectMask seen;
      seen.reset(static_cast<std::uint32_t>(expected.size()));
      seen.add(left);
      ObjectMask again;
      again.reset(static_cast<std::uint32_t>(expected.size()));
      for (const auto& by_one : search.hiddenFrom(corners, choice, known, seen, lists)) {
        again.add({&by_one.objects, 1});
      }
      for (std::uint32_t i = 0; i < expected.size(); ++i) {
        EXPECT_EQ(again.contains(i), found.contains(i)) << "seed " << seed << ", object " << i;
      }
    }
  }
  EXPECT_GT(hidden_count, test::rounds(2000u));
  EXPECT_GT(seen_count, test::rounds(2000u));
}

TEST(CellCandidates, AreRefusedWhereTheyWouldBeTooLong) {
  const Town town(7);
  CellCandidates lists(town.bake);
  ObjectMask none;
  none.reset(static_cast<std::uint32_t>(town.bake.boxes.objects.size()));
  const CellBox cell = cellAround({1.0, 2.0, 3.0}, 4.0);
  ASSERT_TRUE(lists.make(cell, none, nullptr, 1'000'000));
  const std::size_t size = lists.size();
  ASSERT_GT(size, 10u);
  EXPECT_TRUE(lists.make(cell, none, nullptr, size));
  EXPECT_EQ(lists.size(), size);
  EXPECT_FALSE(lists.make(cell, none, nullptr, size - 1));
  EXPECT_TRUE(lists.groups().empty());
}

TEST(ConvexSearch, BoundsWhatAPointSees) {
  std::size_t fewer = 0, enough = 0;
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    const Town town(seed);
    const BakeScene& bake = town.bake;
    ConvexSearch search(bake);
    Random random(seed + 5);
    ObjectMask none;
    none.reset(static_cast<std::uint32_t>(bake.boxes.objects.size()));
    for (int trial = 0; trial < 10; ++trial) {
      const Vec3d eye = random.point(35.0);
      const OccluderChoice choice{.search = cellAround(eye, 100.0), .level = 4};
      const std::vector<bool> hidden = hiddenByAsking(bake, {&eye, 1}, choice, none);
      std::uint64_t seen = 0;
      for (std::uint32_t i = 0; i < hidden.size(); ++i) {
        seen += hidden[i] ? 0 : bake.leafOf(i).triangles;
      }
      for (const double share : {0.1, 0.5, 0.9, 1.0, 1.1}) {
        const double asked = share * static_cast<double>(seen);
        const ConvexSearch::Bounds bounds = search.trianglesSeenFrom(eye, choice, asked);
        EXPECT_LE(bounds.least, seen) << "seed " << seed;
        EXPECT_GE(bounds.most, seen) << "seed " << seed;
        const bool is_fewer = static_cast<double>(seen) < asked;
        ++(is_fewer ? fewer : enough);
        EXPECT_EQ(static_cast<double>(bounds.most) < asked, is_fewer) << "seed " << seed;
        EXPECT_EQ(static_cast<double>(bounds.least) < asked, is_fewer) << "seed " << seed;
      }
    }
  }
  EXPECT_GT(fewer, 100u);
  EXPECT_GT(enough, 100u);
}

TEST(ConvexSearch, FindsTheSameOnEveryInstructionSet) {
  const Town town(8);
  const std::vector<Vec3d> corners = cornersOf(cellAround({3, 2, 1}, 0.5));
  const OccluderChoice choice{.search = cellAround({3, 2, 1}, 60.0), .level = 4};
  ObjectMask none;
  none.reset(static_cast<std::uint32_t>(town.bake.boxes.objects.size()));
  std::vector<std::pair<std::uint32_t, std::uint32_t>> expected;
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    const test::ForcedInstructionSet forced(target);
    ConvexSearch search(town.bake);
    std::vector<std::pair<std::uint32_t, std::uint32_t>> found;
    for (const ConvexSearch::Found& by_one : search.hiddenFrom(corners, choice, none)) {
      found.emplace_back(by_one.occluder, by_one.objects.begin);
    }
    expected = expected.empty() ? found : expected;
    EXPECT_EQ(found, expected) << hwy::TargetName(target);
  }
  EXPECT_GT(expected.size(), 5u);
}

}  // namespace
}  // namespace sightline::pvs
