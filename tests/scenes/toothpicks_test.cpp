#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "scenes/moving_scene.h"
#include "scenes/procedural.h"
#include "tests/scenes/moving_checks.h"
#include "tests/scenes/scene_checks.h"

namespace sightline {
namespace {

using namespace scene_checks;

// Both ends of a toothpick, whose long axis is its own y.
std::array<Vec3d, 2> endsOf(const Mat4& pose, double half_length) {
  return {transformPoint(pose, {0, half_length, 0}), transformPoint(pose, {0, -half_length, 0})};
}

double meanEndMovement(const MovingScene& scene, std::size_t toothpicks, double half_length,
                       std::uint32_t frames) {
  double sum = 0.0;
  std::vector<Mat4> before = posesOf(scene, 0);
  for (std::uint32_t f = 1; f < frames; ++f) {
    const std::vector<Mat4> now = posesOf(scene, f);
    for (std::size_t i = 0; i < toothpicks; ++i) {
      const auto from = endsOf(before[i], half_length), to = endsOf(now[i], half_length);
      sum += length(to[0] - from[0]) + length(to[1] - from[1]);
    }
    before = now;
  }
  return sum / (2.0 * static_cast<double>(toothpicks) * (frames - 1));
}

TEST(Toothpicks, AreAsManyAsAskedForInAFrameOfEightSpheresAndTwelveCylinders) {
  for (const std::uint32_t n : {1u, 25u, 200u}) {
    const MovingScene scene = makeToothpicks({.count = n});
    EXPECT_EQ(scene.parts.size(), n + 20u);
    EXPECT_EQ(scene.hulls.size(), 3u);
    std::array<std::size_t, 3> of_class{};
    for (const MovingPart& part : scene.parts) {
      ++of_class.at(part.class_of);
      EXPECT_EQ(part.settings.is_static, scene.classes[part.class_of] != "toothpick");
    }
    EXPECT_EQ(of_class, (std::array<std::size_t, 3>{n, 8u, 12u}));
    EXPECT_EQ(scene.frames, 250u);
    EXPECT_EQ(whatIsWrongWithParts(scene), "");
    EXPECT_EQ(whatIsWrong(scene.scene), "");
    const SolidCounts counts = countSolids(scene.scene);
    EXPECT_EQ(counts.closed, n + 20u);
    EXPECT_EQ(counts.inside_out, 0u);
  }
}

TEST(Toothpicks, HaveThePapersPolygonsAndSharpEnds) {
  const MovingScene scene = makeToothpicks({.count = 1});
  const Object& toothpick = scene.scene.objects[0];
  std::set<std::uint32_t> vertices;
  for (std::uint32_t i = 0; i < toothpick.index_count; ++i) {
    vertices.insert(scene.scene.indices[toothpick.first_index + i]);
  }
  EXPECT_EQ(vertices.size(), 322u);
  // 328 polygons: 16 triangles and 312 quads.
  EXPECT_EQ(toothpick.triangleCount(), 16u + 2u * 312u);
  EXPECT_EQ(scene.hulls[0].vertices.size(), 322u);
  EXPECT_NEAR(scene.hulls[0].radius, 0.077, 1e-4);
}

TEST(Toothpicks, KeepTheirMeshesWithinTheirHulls) {
  for (const bool uniform_density : {false, true}) {
    const MovingScene scene = makeToothpicks({.count = 800, .uniform_density = uniform_density, .seed = 3});
    EXPECT_EQ(whatSticksOut(scene), "");
  }
}

TEST(Toothpicks, KeepTheirDensityOrTheirSizeAsTheirNumberGrows) {
  const double at_200 = makeToothpicks({.count = 200, .uniform_density = true}).hulls[0].radius;
  const double at_1600 = makeToothpicks({.count = 1600, .uniform_density = true}).hulls[0].radius;
  EXPECT_NEAR(at_1600 * 2.0, at_200, 1e-6);
  EXPECT_NEAR(makeToothpicks({.count = 1600}).hulls[0].radius, at_200, 1e-6);
}

TEST(Toothpicks, MoveTheirEndsByThePapersPartOfTheCubesSideAFrame) {
  for (const std::uint32_t seed : {1u, 2u}) {
    const MovingScene scene = makeToothpicks({.count = 200, .seed = seed});
    EXPECT_NEAR(meanEndMovement(scene, 200, 0.077, scene.frames), 0.00269, 0.00269 * 0.02) << "seed " << seed;
  }
}

TEST(Toothpicks, MoveAsFastAsTheirVelocitySaysAndTheCameraToo) {
  const MovingScene slow = makeToothpicks({.count = 50}),
                    fast = makeToothpicks({.count = 50, .velocity = 4.0});
  for (const std::uint32_t frame : {0u, 1u, 17u, 60u}) {
    const std::vector<Mat4> at_four = posesOf(slow, 4 * frame), quick = posesOf(fast, frame);
    for (std::size_t i = 0; i < at_four.size(); ++i) {
      EXPECT_EQ(at_four[i].m, quick[i].m) << "frame " << frame << " part " << i;
    }
    EXPECT_EQ(slow.scene.paths[0].frames[4 * frame].eye, fast.scene.paths[0].frames[frame].eye);
  }
  const CameraPath& path = slow.scene.paths[0];
  EXPECT_GT(length(path.frames[249].eye - path.frames[0].eye), 0.1);
}

TEST(Toothpicks, StayInTheCubeAtAnyVelocity) {
  for (const double velocity : {1.0, 64.0}) {
    const MovingScene scene = makeToothpicks({.count = 100, .velocity = velocity, .seed = 4});
    Vec3d low(1, 1, 1), high;
    for (std::uint32_t f = 0; f < scene.frames; ++f) {
      const std::vector<Mat4> poses = posesOf(scene, f);
      for (std::size_t i = 0; i < 100; ++i) {
        const Vec3d centre = transformPoint(poses[i], {});
        low = min(low, centre);
        high = max(high, centre);
      }
    }
    // They come close to the sides but do not pass them.
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(low[axis], 0.005, 0.005);
      EXPECT_NEAR(high[axis], 0.995, 0.005);
    }
  }
}

TEST(Toothpicks, BounceOffTheSides) {
  const MovingScene scene = makeToothpicks({.count = 100});
  std::size_t bounced = 0;
  const std::vector<Mat4> p0 = posesOf(scene, 0), p1 = posesOf(scene, 1), p248 = posesOf(scene, 248),
                          p249 = posesOf(scene, 249);
  for (std::size_t i = 0; i < 100; ++i) {
    const Vec3d first = transformPoint(p1[i], {}) - transformPoint(p0[i], {});
    const Vec3d last = transformPoint(p249[i], {}) - transformPoint(p248[i], {});
    bounced += first.x * last.x < 0.0 ? 1 : 0;
    EXPECT_NEAR(std::abs(first.x), std::abs(last.x), 0.006);
  }
  EXPECT_GT(bounced, 5u);
  EXPECT_LT(bounced, 60u);
}

TEST(Toothpicks, AreAllInViewFromOutsideTheCube) {
  for (const double velocity : {1.0, 64.0}) {
    const MovingScene scene = makeToothpicks({.count = 25, .uniform_density = true, .velocity = velocity});
    for (std::uint32_t f = 0; f < scene.frames; f += 10) {
      const View view = scene.scene.paths[0].view(f, scene.scene.origin);
      EXPECT_GT(length(view.eye - Vec3d(0.5, 0.5, 0.5)), 2.0);
      EXPECT_EQ(whatIsOutOfView(scene, f, view), "");
    }
  }
}

TEST(Toothpicks, AreTheSameForTheSameOptionsAndOthersForAnotherSeed) {
  const MovingScene a = makeToothpicks({.count = 30}), b = makeToothpicks({.count = 30}),
                    c = makeToothpicks({.count = 30, .seed = 2});
  EXPECT_EQ(hashOf(a.scene), hashOf(b.scene));
  EXPECT_NE(hashOf(a.scene), hashOf(c.scene));
  const std::vector<Mat4> late = posesOf(a, 200);
  posesOf(b, 3);
  const std::vector<Mat4> again = posesOf(b, 200);
  for (std::size_t i = 0; i < late.size(); ++i) {
    EXPECT_EQ(late[i].m, again[i].m);
  }
}

TEST(Toothpicks, ComeByTheirUrl) {
  EXPECT_TRUE(isMovingDemoUrl("demo:toothpicks?n=30"));
  EXPECT_FALSE(isMovingDemoUrl("demo:city"));
  EXPECT_FALSE(isMovingDemoUrl("toothpicks"));
  const Result<MovingScene> scene = makeMovingDemoScene("demo:toothpicks?scaling=ud&n=30&seed=5");
  ASSERT_TRUE(scene);
  const MovingScene same = makeToothpicks({.count = 30, .uniform_density = true, .seed = 5});
  EXPECT_EQ(hashOf(scene->scene), hashOf(same.scene));
  const Result<Scene> still = makeDemoScene("demo:toothpicks?scaling=us&n=30");
  ASSERT_TRUE(still);
  EXPECT_EQ(hashOf(*still), hashOf(makeToothpicks({.count = 30}).scene));
  EXPECT_FALSE(makeMovingDemoScene("demo:city"));
  const Result<MovingScene> wrong = makeMovingDemoScene("demo:toothpicks?scaling=big");
  ASSERT_FALSE(wrong);
  EXPECT_NE(wrong.error().message.find("us or ud"), std::string::npos) << wrong.error().message;
}

}  // namespace
}  // namespace sightline
