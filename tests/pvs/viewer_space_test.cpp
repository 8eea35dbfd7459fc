#include "sightline/pvs/bake/viewer_space.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <thread>

#include "oracle/exact_visibility.h"
#include "tests/pvs/bake_scenes.h"
#include "tests/support/hand_made.h"

namespace sightline {
namespace {

using test::block;
using test::sceneOf;

bool within(std::span<const Box> boxes, const Vec3d& p) {
  return std::any_of(boxes.begin(), boxes.end(), [&](const Box& box) {
    return p.x >= static_cast<double>(box.min.x) && p.y >= static_cast<double>(box.min.y) &&
           p.z >= static_cast<double>(box.min.z) && p.x <= static_cast<double>(box.max.x) &&
           p.y <= static_cast<double>(box.max.y) && p.z <= static_cast<double>(box.max.z);
  });
}

double volumeOf(std::span<const Box> boxes) {
  double volume = 0.0;
  for (const Box& box : boxes) {
    const Vec3d extent(box.extent());
    volume += extent.x * extent.y * extent.z;
  }
  return volume;
}

// A closed room of these inner walls, 0.2 m thick, as six slabs.
std::vector<test::Solid> room(const Vec3f& min, const Vec3f& max) {
  std::vector<test::Solid> slabs;
  const Vec3f thick(0.2f, 0.2f, 0.2f);
  const Vec3f low = min - thick, high = max + thick;
  for (int axis = 0; axis < 3; ++axis) {
    Vec3f below = high, above = low;
    below[axis] = min[axis];
    above[axis] = max[axis];
    slabs.push_back(block(low, below));
    slabs.push_back(block(above, high));
  }
  return slabs;
}

const Vec3d kInRoom[] = {{5.0, 1.5, 5.0}};

Result<FreeSpace> found(const Scene& scene, const FreeSpaceSettings& settings = {},
                        std::span<const Vec3d> from = kInRoom) {
  return findFreeSpace(scene.view(), from, settings);
}

TEST(BoxesAlong, HoldWhatIsWithinReachOfEveryPointOfTheLine) {
  std::mt19937 random(1);
  const auto in = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  for (const double reach : {0.0, 0.3, 2.0, 1000.0}) {
    std::vector<Vec3d> eyes;
    for (int i = 0; i < 12; ++i) {
      eyes.push_back({in(-50, 50), in(0, 3), in(-50, 50)});
    }
    const std::vector<Box> boxes = boxesAlong(eyes, reach);
    for (int i = 0; i < 3000; ++i) {
      const auto leg = static_cast<std::size_t>(in(0, 11));
      const Vec3d on_line = eyes[leg] + (eyes[leg + 1] - eyes[leg]) * in(0, 1);
      const Vec3d beside(in(-reach, reach), in(-reach, reach), in(-reach, reach));
      ASSERT_TRUE(within(boxes, on_line + beside)) << reach;
    }
    // And little more: nothing farther than a piece of a line and the reach.
    for (int i = 0; i < 3000 && reach > 0.0 && reach < 10.0; ++i) {
      const Vec3d point(in(-60, 60), in(-10, 10), in(-60, 60));
      double nearest = 1e9;
      for (std::size_t leg = 0; leg + 1 < eyes.size(); ++leg) {
        const Vec3d along = eyes[leg + 1] - eyes[leg];
        const double t = std::clamp(dot(point - eyes[leg], along) / dot(along, along), 0.0, 1.0);
        nearest = std::min(nearest, length(point - eyes[leg] - along * t));
      }
      if (nearest > 3.0 * std::sqrt(3.0) * reach) {
        ASSERT_FALSE(within(boxes, point)) << reach;
      }
    }
  }
}

TEST(BoxesAlong, LeaveOutEyesThatAreNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Vec3d> eyes{{nan, 0, 0}, {1, 1, 1}, {1e300, -1e300, 0}, {0, nan, 0}, {2, 1, 1}};
  EXPECT_TRUE(boxesAlong(std::span(eyes).first(1), 1.0).empty());
  for (const Box& box : boxesAlong(eyes, 1.0)) {
    EXPECT_TRUE(box.wellFormed());
  }
  EXPECT_TRUE(within(boxesAlong(eyes, 1.0), {2, 1, 1}));
}

TEST(FreeSpace, IsAllOfTheRoomAndNothingBeyondItsWalls) {
  std::vector<test::Solid> solids = room({0, 0, 0}, {10, 3, 10});
  for (const test::Solid& slab : room({20, 0, 0}, {30, 3, 10})) {
    solids.push_back(slab);  // another room
  }
  const Scene scene = sceneOf(solids);
  const Result<FreeSpace> space = found(scene);
  ASSERT_TRUE(space) << space.error().message;
  EXPECT_EQ(space->voxel, FreeSpaceSettings::kUsualVoxel);
  for (double x = 0.0; x <= 10.0; x += 0.5) {
    for (double y = 0.0; y <= 3.0; y += 0.25) {
      for (double z = 0.0; z <= 10.0; z += 0.5) {
        EXPECT_TRUE(within(space->boxes, {x, y, z})) << x << ' ' << y << ' ' << z;
      }
    }
  }
  EXPECT_FALSE(within(space->boxes, {25, 1.5, 5}));
  EXPECT_FALSE(within(space->boxes, {15, 1.5, 5}));
  EXPECT_LT(volumeOf(space->boxes), 1.4 * 300.0);
}

TEST(FreeSpace, GoesThroughDoorsAndNotThroughCracks) {
  for (const bool door : {false, true}) {
    // Two rooms in one, with a wall between them at x = 5 that has a door of 1 m, or a crack of 5 cm.
    std::vector<test::Solid> solids = room({0, 0, 0}, {10, 3, 10});
    const float gap = door ? 1.0f : 0.05f;
    solids.push_back(block({4.9f, -0.1f, -0.1f}, {5.1f, 3.1f, 5.0f}));
    solids.push_back(block({4.9f, -0.1f, 5.0f + gap}, {5.1f, 3.1f, 10.1f}));
    const Vec3d from[] = {{2.0, 1.0, 2.0}};
    const Result<FreeSpace> space = found(sceneOf(solids), {}, from);
    ASSERT_TRUE(space);
    EXPECT_TRUE(within(space->boxes, {2, 1, 8}));
    EXPECT_EQ(within(space->boxes, {8, 1, 8}), door);
  }
}

TEST(FreeSpace, OnlyOpaqueTrianglesAreInTheWay) {
  Scene scene = sceneOf(room({0, 0, 0}, {10, 3, 10}));
  scene.materials[0].opacity = Opacity::kAlphaTested;
  const Result<FreeSpace> space = found(scene, {.region = {{-5, -5, -5}, {15, 8, 15}}});
  ASSERT_TRUE(space);
  EXPECT_NEAR(volumeOf(space->boxes), 20.0 * 13.0 * 20.0, 1e-3);
}

TEST(FreeSpace, EndsAtTheHeightAboveTheGround) {
  const Scene scene = sceneOf({block({0, -1, 0}, {40, 0, 40}), block({10, 0, 10}, {20, 5, 20})});
  const Vec3d from[] = {{5, 1.7, 5}};
  const Box region{{0, -1, 0}, {40, 30, 40}};
  const Result<FreeSpace> space = found(scene, {.max_height = 3.0, .region = region}, from);
  ASSERT_TRUE(space) << space.error().message;
  EXPECT_TRUE(within(space->boxes, {5, 2.9, 5}));
  EXPECT_FALSE(within(space->boxes, {5, 4.0, 5}));
  EXPECT_TRUE(within(space->boxes, {15, 7.9, 15})) << "on the roof, which is reached through the air";
  EXPECT_FALSE(within(space->boxes, {15, 9.0, 15}));
  EXPECT_FALSE(within(space->boxes, {15, 2.5, 15})) << "in the house";
}

TEST(FreeSpace, BeginsBesideAPointThatIsTooCloseToAWall) {
  const Scene scene = sceneOf(room({0, 0, 0}, {10, 3, 10}));
  const Vec3d at_wall[] = {{0.05, 0.05, 5.0}};
  const Result<FreeSpace> space = found(scene, {}, at_wall);
  ASSERT_TRUE(space) << space.error().message;
  EXPECT_TRUE(within(space->boxes, {5, 1.5, 5}));
  EXPECT_TRUE(within(space->boxes, at_wall[0]));
}

// A wall through the voxel of the start has free ones on both sides, which is all that is known of them.
TEST(FreeSpace, BeginsOnBothSidesOfAWallThatAPointIsCloseTo) {
  for (const bool mirrored : {false, true}) {
    std::vector<test::Solid> solids = room({0, 0, -5}, {10, 3, 5});
    const float wall = mirrored ? -0.06f : 0.01f;
    solids.push_back(block({-0.1f, -0.1f, wall}, {10.1f, 3.1f, wall + 0.05f}));
    const Vec3d beside[] = {{5, 1.5, mirrored ? -0.08 : 0.08}};
    const Result<FreeSpace> space = found(sceneOf(solids), {.region = {{0, 0, -5}, {10, 3, 5}}}, beside);
    ASSERT_TRUE(space) << space.error().message;
    EXPECT_TRUE(within(space->boxes, {5, 1.5, mirrored ? -4.0 : 4.0})) << "the viewer's room";
  }
}

TEST(FreeSpace, SaysWhatIsWrong) {
  const Scene scene = sceneOf({block({0, 0, 0}, {1, 1, 1})});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Vec3d far[] = {{1e30, 0, 0}, {nan, 0, 0}};
  EXPECT_FALSE(found(scene, {}, far));
  EXPECT_FALSE(found(scene, {}, {}));
  EXPECT_FALSE(found(scene, {.voxel = -1.0}));
  EXPECT_FALSE(found(scene, {.voxel = nan}));
  EXPECT_FALSE(found(scene, {.voxel = 1e-9}));
  EXPECT_FALSE(found(scene, {.max_height = -1.0}));
  EXPECT_FALSE(found(scene, {.max_height = nan}));
  EXPECT_FALSE(found(Scene{}));
}

TEST(FreeSpace, OfAVastRegionHasLargerVoxels) {
  const Scene scene = sceneOf({block({0, 0, 0}, {1, 1, 1})});
  const Vec3d from[] = {{1000, 1000, 1000}};
  const Result<FreeSpace> space = found(scene, {.region = {{-1e6f, -1e3f, -1e6f}, {1e6f, 1e3f, 1e6f}}}, from);
  ASSERT_TRUE(space) << space.error().message;
  EXPECT_GT(space->voxel, 100.0);
  EXPECT_TRUE(within(space->boxes, {-9e5, 0, 9e5}));
}

// Slabs of random places and sizes, slanted ones among them.
Scene clutter(std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto in = [&](float low, float high) {
    return std::uniform_real_distribution<float>(low, high)(random);
  };
  std::vector<test::Solid> solids = room({0, 0, 0}, {12, 4, 12});
  for (int i = 0; i < 14; ++i) {
    const Vec3f at(in(0, 11), in(-1, 3), in(0, 11));
    test::Solid slab = block(at, at + Vec3f(in(0.05f, 6), in(0.05f, 4), in(0.05f, 1)));
    const float lean = in(-0.7f, 0.7f);
    for (Vec3f& point : slab.points) {
      point.x += lean * point.z;
    }
    solids.push_back(std::move(slab));
  }
  return sceneOf(solids);
}

TEST(FreeSpace, HoldsWhereAWanderingViewerGets) {
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    const Scene scene = clutter(seed);
    const ExactVisibility exact(scene.view());
    std::mt19937 random(seed);
    const auto in = [&](double low, double high) {
      return std::uniform_real_distribution<double>(low, high)(random);
    };
    constexpr double kVoxel = 0.1;
    // Far enough from all triangles that every voxel around the viewer is free.
    const auto clear = [&](const Vec3d& p) {
      for (const Object& object : scene.objects) {
        for (std::size_t i = 0; i < object.index_count; i += 3) {
          Box box;
          for (std::size_t c = 0; c < 3; ++c) {
            box.extend(scene.positions[scene.indices[object.first_index + i + c]]);
          }
          if (overlaps(widened(box, 2.0 * kVoxel), Box{Vec3f(p), Vec3f(p)})) {
            return false;
          }
        }
      }
      return true;
    };
    Vec3d at;
    do {
      at = {in(0, 12), in(0, 4), in(0, 12)};
    } while (!clear(at));
    const Vec3d from[] = {at};
    const Result<FreeSpace> space = found(scene, {.voxel = kVoxel}, from);
    ASSERT_TRUE(space) << space.error().message;
    for (int step = 0; step < 3000; ++step) {
      const Vec3d next = at + Vec3d(in(-1, 1), in(-1, 1), in(-1, 1)) * 0.05;
      if (clear(next)) {
        at = next;
        ASSERT_TRUE(within(space->boxes, at)) << "seed " << seed;
      }
    }
  }
}

// What findFreeSpace() gives for rectangles across the axes, searched voxel by voxel: edges of one metre.
class PlainSearch {
 public:
  static constexpr int kSize[3] = {70, 7, 6};

  PlainSearch(std::span<const Box> rectangles, const Vec3d& start, int max_height) {
    forEach([&](int x, int y, int z) {
      const Vec3f low(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
      const Box voxel{low, low + Vec3f(1, 1, 1)};
      blocked(x, y, z) = std::any_of(rectangles.begin(), rectangles.end(),
                                     [&](const Box& box) { return overlaps(voxel, box); });
    });
    const int at[3] = {static_cast<int>(start.x), static_cast<int>(start.y), static_cast<int>(start.z)};
    reach(at[0], at[1], at[2]);
    forEach(
        [&](int x, int y, int z) { kept(x, y, z) = reached(x, y, z) && nearGround(x, y, z, max_height); });
    kept(at[0], at[1], at[2]) = true;
  }

  bool any() const { return std::find(reached_.begin(), reached_.end(), true) != reached_.end(); }
  // Whether the voxel or one beside it is kept.
  bool holds(int x, int y, int z) const {
    for (int i = 0; i < 27; ++i) {
      const int at[3] = {x + i % 3 - 1, y + i / 3 % 3 - 1, z + i / 9 - 1};
      if (inside(at[0], at[1], at[2]) && kept_[indexOf(at[0], at[1], at[2])]) {
        return true;
      }
    }
    return false;
  }
  template <typename Visit>
  static void forEach(Visit&& visit) {
    for (int z = 0; z < kSize[2]; ++z) {
      for (int y = 0; y < kSize[1]; ++y) {
        for (int x = 0; x < kSize[0]; ++x) {
          visit(x, y, z);
        }
      }
    }
  }

 private:
  using Bits = std::vector<bool>;
  static constexpr std::size_t kVoxels = std::size_t{70} * 7 * 6;

  static bool inside(int x, int y, int z) {
    return x >= 0 && y >= 0 && z >= 0 && x < kSize[0] && y < kSize[1] && z < kSize[2];
  }
  static std::size_t indexOf(int x, int y, int z) {
    return static_cast<std::size_t>((z * kSize[1] + y) * kSize[0] + x);
  }
  Bits::reference blocked(int x, int y, int z) { return blocked_[indexOf(x, y, z)]; }
  Bits::reference reached(int x, int y, int z) { return reached_[indexOf(x, y, z)]; }
  Bits::reference kept(int x, int y, int z) { return kept_[indexOf(x, y, z)]; }
  void reach(int x, int y, int z) {
    if (!inside(x, y, z) || blocked(x, y, z) || reached(x, y, z)) {
      return;
    }
    reached(x, y, z) = true;
    for (const int step : {-1, 1}) {
      reach(x + step, y, z);
      reach(x, y + step, z);
      reach(x, y, z + step);
    }
  }
  bool nearGround(int x, int y, int z, int max_height) {
    for (int below = 1; below <= max_height + 1; ++below) {
      if (y - below >= 0 && blocked(x, y - below, z)) {
        return true;
      }
    }
    return false;
  }

  Bits blocked_ = Bits(kVoxels), reached_ = Bits(kVoxels), kept_ = Bits(kVoxels);
};

TEST(FreeSpace, IsWhatAPlainSearchFinds) {
  constexpr int kScenes = 60;
  int found_any = 0;
  for (std::uint32_t seed = 1; seed <= kScenes; ++seed) {
    std::mt19937 random(seed);
    // Halves of a metre: some rectangles lie in the borders of voxels.
    const auto halves = [&](int low, int high) {
      return 0.5f * static_cast<float>(std::uniform_int_distribution<int>(low, high)(random));
    };
    std::vector<Box> rectangles;
    Scene scene;
    scene.materials.emplace_back();
    for (int i = 0; i < 30; ++i) {
      const int across = static_cast<int>(seed + static_cast<std::uint32_t>(i)) % 3;
      const int u = (across + 1) % 3, v = (across + 2) % 3;
      Vec3f low{halves(-4, 144), halves(-4, 18), halves(-4, 16)};
      Vec3f high = low + Vec3f{halves(1, 60), halves(1, 10), halves(1, 8)};
      high[across] = low[across];
      rectangles.push_back({low, high});
      Vec3f second = low, fourth = low;
      second[u] = high[u];
      fourth[v] = high[v];
      hand_made::addTriangles(scene, MaterialId(0u), std::array{low, second, high, low, high, fourth});
    }
    updateBounds(scene);
    const int max_height = static_cast<int>(seed % 8);
    const Vec3d start(0.5 + static_cast<double>(seed % 70), 3.5, 2.5);
    const PlainSearch plain(rectangles, start, max_height);
    const Result<FreeSpace> space = findFreeSpace(scene.view(), std::span(&start, 1),
                                                  {.voxel = 1.0,
                                                   .max_height = static_cast<double>(max_height),
                                                   .region = {{0, 0, 0}, {69.9f, 6.9f, 5.9f}}});
    if (!plain.any()) {
      continue;
    }
    ASSERT_TRUE(space) << "seed " << seed << ": " << space.error().message;
    ++found_any;
    PlainSearch::forEach([&](int x, int y, int z) {
      EXPECT_EQ(within(space->boxes, Vec3d(x, y, z) + Vec3d(0.5, 0.5, 0.5)), plain.holds(x, y, z))
          << "seed " << seed << ": " << x << ' ' << y << ' ' << z;
    });
  }
  EXPECT_GT(found_any, kScenes / 3);
}

TEST(FreeSpace, HasEachPlaceOnceAndIsTheSameForAnyThreads) {
  const ParallelFor reversed = [](std::uint32_t count, const RangeBody& body) {
    for (std::uint32_t i = count; i-- > 0;) {
      body(i, i + 1);
    }
  };
  const ParallelFor two_threads = [](std::uint32_t count, const RangeBody& body) {
    std::thread other([&] { body(0, count / 2); });
    body(count / 2, count);
    other.join();
  };
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    const Scene scene = clutter(seed);
    const Vec3d from[] = {{6, 3.9, 6}, {0.3, 0.3, 0.3}, {11.5, 3.5, 0.5}};
    const Result<FreeSpace> space = found(scene, {}, from);
    ASSERT_TRUE(space);
    for (const ParallelFor& parallel_for : {reversed, two_threads}) {
      EXPECT_EQ(findFreeSpace(scene.view(), from, {}, parallel_for)->boxes, space->boxes);
    }
    for (std::size_t i = 0; i < space->boxes.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        const Box common = intersection(space->boxes[i], space->boxes[j]);
        EXPECT_TRUE(common.empty() || common.extent().x * common.extent().y * common.extent().z == 0.0f);
      }
    }
  }
}

}  // namespace
}  // namespace sightline
