#include "src/occlusion/planes/eye_planes.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <bit>
#include <cmath>
#include <random>

#include "tests/support/instruction_sets.h"

namespace sightline::occlusion {
namespace {

struct EyeScene {
  std::vector<EyeShape> shapes;
  std::vector<EyeQuad> quads;
  std::vector<std::uint32_t> list;
};

double uniform(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
}

Vec3d direction(std::mt19937_64& random) {
  return normalized(Vec3d(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)));
}

// Returns arbitrary planes: these tests are about the arithmetic only.
EyeScene randomScene(std::mt19937_64& random) {
  EyeScene scene;
  for (std::uint32_t i = 0; i < 40; ++i) {
    EyeShape shape;
    shape.normal = direction(random);
    shape.offset = uniform(random, -1, 8);
    shape.depth_margin = 1e-6;
    shape.reach = 20;
    shape.first_quad = static_cast<std::uint32_t>(scene.quads.size());
    shape.plane_count = static_cast<std::uint16_t>(3 + random() % 14);
    for (std::uint32_t e = 0; e < shape.plane_count; ++e) {
      if (e % 4 == 0) {
        scene.quads.emplace_back();
      }
      const Vec3d n = direction(random);
      EyeQuad& quad = scene.quads.back();
      quad.x[e % 4] = n.x;
      quad.y[e % 4] = n.y;
      quad.z[e % 4] = n.z;
      quad.offset[e % 4] = random() % 2 == 0 ? 0.0 : uniform(random, -20, 4);
    }
    scene.shapes.push_back(shape);
    scene.list.push_back(i);
  }
  return scene;
}

EyeBox randomBox(std::mt19937_64& random) {
  const Vec3d c = direction(random) * uniform(random, 0, 15);
  const Vec3d h(uniform(random, 0, 1), uniform(random, 0, 1), uniform(random, 0, 1));
  return EyeBox::of({Vec3f(c - h), Vec3f(c + h)}, {0.1, 0.2, 0.3});
}

std::vector<EyePlaneTest> testAgainstEyePlanes(const EyeScene& scene, const EyeBox& box) {
  std::vector<EyePlaneTest> tests(scene.list.size());
  tests.resize(occlusion::testAgainstEyePlanes(scene.shapes, scene.quads, scene.list, box, tests));
  return tests;
}

TEST(EyePlanes, EveryInstructionSetGivesTheSameAnswers) {
  std::mt19937_64 random(1);
  const std::vector<std::int64_t> targets = hwy::SupportedAndGeneratedTargets();
  ASSERT_FALSE(targets.empty());
  for (int round = 0; round < 200; ++round) {
    const EyeScene scene = randomScene(random);
    const EyeBox box = randomBox(random);
    const std::vector<EyePlaneTest> first = testAgainstEyePlanes(scene, box);
    for (const std::int64_t target : targets) {
      const test::ForcedInstructionSet forced(target);
      const std::vector<EyePlaneTest> tests = testAgainstEyePlanes(scene, box);
      ASSERT_EQ(tests.size(), first.size()) << hwy::TargetName(target);
      for (std::size_t i = 0; i < tests.size(); ++i) {
        EXPECT_EQ(tests[i].touches, first[i].touches) << hwy::TargetName(target);
        EXPECT_EQ(tests[i].behind, first[i].behind) << hwy::TargetName(target);
        EXPECT_EQ(tests[i].failing, first[i].failing) << hwy::TargetName(target);
      }
    }
  }
}

// Classifies by brute force, corner by corner. Corners within 1e-9 of a plane may give either result.
TEST(EyePlanes, AgreeWithTheEightCorners) {
  std::mt19937_64 random(2);
  int failing_edges = 0, satisfied_edges = 0, touched = 0, behind = 0;
  for (int round = 0; round < 500; ++round) {
    const EyeScene scene = randomScene(random);
    const EyeBox box = randomBox(random);
    const std::vector<EyePlaneTest> tests = testAgainstEyePlanes(scene, box);
    for (std::size_t i = 0; i < tests.size(); ++i) {
      const EyeShape& shape = scene.shapes[i];
      const auto range = [&](const Vec3d& n, double offset) {
        double min = INFINITY, max = -INFINITY;
        for (unsigned c = 0; c < 8; ++c) {
          const Vec3d x(c & 1 ? box.max.x : box.min.x, c & 2 ? box.max.y : box.min.y,
                        c & 4 ? box.max.z : box.min.z);
          min = std::min(min, dot(n, x) + offset);
          max = std::max(max, dot(n, x) + offset);
        }
        return std::pair(min, max);
      };
      const auto [deepest, nearest] = range(shape.normal, shape.offset);
      if (std::abs(deepest) < 1e-5 || std::abs(nearest) < 1e-5) {
        continue;
      }
      EXPECT_EQ(tests[i].behind, nearest < 0.0);
      if (deepest > 0.0) {
        EXPECT_FALSE(tests[i].touches);
        continue;
      }
      bool touches = true, near_tie = false;
      std::uint64_t failing = 0;
      for (std::uint32_t e = 0; e < shape.plane_count; ++e) {
        const EyeQuad& quad = scene.quads[shape.first_quad + e / 4];
        const auto [min, max] = range({quad.x[e % 4], quad.y[e % 4], quad.z[e % 4]}, quad.offset[e % 4]);
        near_tie |= std::abs(min) < 1e-8 || std::abs(max) < 1e-8;
        touches &= min < 0.0;
        failing |= (max < 0.0 ? std::uint64_t{0} : std::uint64_t{1}) << e;
      }
      if (near_tie) {
        continue;
      }
      EXPECT_EQ(tests[i].touches, touches);
      EXPECT_EQ(tests[i].failing, failing);
      touched += touches ? 1 : 0;
      behind += tests[i].behind ? 1 : 0;
      failing_edges += std::popcount(failing);
      satisfied_edges += shape.plane_count - std::popcount(failing);
    }
  }
  EXPECT_GT(touched, 20);
  EXPECT_GT(behind, 1000);
  EXPECT_GT(failing_edges, 1000);
  EXPECT_GT(satisfied_edges, 1000);
}

TEST(EyePlanes, LookingEndsAtTheFirstThatHidesTheBox) {
  // Five half-spaces that have everything behind them at z < -1.
  EyeScene scene;
  for (std::uint32_t i = 0; i < 5; ++i) {
    EyeShape shape;
    shape.normal = {0, 0, 1};
    shape.offset = i < 2 ? 100.0 : 1.0;  // the first two are far behind the box
    shape.reach = 1.0;
    shape.first_quad = i;
    shape.plane_count = 3;
    scene.shapes.push_back(shape);
    EyeQuad quad;
    for (int e = 0; e < 3; ++e) {
      quad.offset[e] = -1.0;
    }
    scene.quads.push_back(quad);
    scene.list.push_back(i);
  }
  const EyeBox box = EyeBox::of({{-1, -1, -5}, {1, 1, -4}}, {0, 0, 0});
  const std::vector<EyePlaneTest> tests = testAgainstEyePlanes(scene, box);
  ASSERT_EQ(tests.size(), 3u);
  EXPECT_FALSE(tests[0].touches);
  EXPECT_TRUE(tests[2].hidden());
}

}  // namespace
}  // namespace sightline::occlusion
