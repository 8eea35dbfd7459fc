// The exact verifier where rounding would matter most, and what must not change its verdicts.

#include <gtest/gtest.h>

#include <random>
#include <thread>

#include "oracle/exact_visibility.h"
#include "tests/support/exact_sight.h"
#include "tests/support/hand_made.h"
#include "tests/support/rounds.h"

namespace sightline {
namespace {

using namespace hand_made;

constexpr std::uint32_t kSteps = 4000;
constexpr ObjectId kTarget(std::uint32_t(0));

std::vector<ObjectId> objectsOf(const Scene& scene) {
  std::vector<ObjectId> all;
  for (std::uint32_t o = 0; o < scene.objects.size(); ++o) {
    all.emplace_back(o);
  }
  return all;
}

std::vector<Verdict> verdicts(const Scene& scene, const View& view, std::uint32_t steps = kSteps) {
  std::vector<Verdict> all;
  for (const Decision& decision : ExactVisibility(scene.view()).decide(view, objectsOf(scene), steps)) {
    all.push_back(decision.verdict);
  }
  return all;
}

std::vector<Verdict> bruteForce(const Scene& scene, const View& view) {
  const test::ExactSight sight(scene.view(), view);
  std::vector<Verdict> all;
  for (const ObjectId object : objectsOf(scene)) {
    all.push_back(sight.isVisible(object) ? Verdict::kVisible : Verdict::kHidden);
  }
  return all;
}

// Walls that cover most of the picture, and triangles around them.
Scene wallsAndTriangles(std::mt19937& random) {
  Scene scene;
  const MaterialId material = addMaterial(scene, Opacity::kOpaque, true);
  const auto grid = [&](int low, int high) {
    return static_cast<float>(low + static_cast<int>(random() % static_cast<std::uint32_t>(high - low + 1)));
  };
  for (int i = 0; i < 3; ++i) {
    const float x = grid(-4, 1), y = grid(-4, 1);
    addWall(scene, material, grid(-4, -2), x, x + grid(2, 5), y, y + grid(2, 5));
  }
  for (int i = 0; i < 4; ++i) {
    const std::array<Vec3f, 3> corners{Vec3f(grid(-3, 3), grid(-3, 3), grid(-6, -2)),
                                       Vec3f(grid(-3, 3), grid(-3, 3), grid(-6, -2)),
                                       Vec3f(grid(-3, 3), grid(-3, 3), grid(-6, -2))};
    addTriangles(scene, material, corners);
  }
  return scene;
}

void scale(Scene& scene, float factor) {
  for (Vec3f& p : scene.positions) {
    p = p * factor;
  }
  updateBounds(scene);
}

TEST(HardProof, AScaleByAPowerOfTwoChangesNoVerdict) {
  for (const bool orthographic : {false, true}) {
    for (std::uint32_t seed = 0; seed < test::rounds(60u); ++seed) {
      std::mt19937 random(seed);
      const Scene scene = wallsAndTriangles(random);
      View view = frontView();
      view.orthographic = orthographic;
      view.z_near = 0.5;
      const std::vector<Verdict> expected = bruteForce(scene, view);
      for (const int exponent : {-100, -13, 0, 20, 100}) {
        Scene scaled = scene;
        const double factor = std::ldexp(1.0, exponent);
        scale(scaled, static_cast<float>(factor));
        View view_scaled = view;
        view_scaled.z_near *= factor;
        view_scaled.z_far *= factor;
        view_scaled.ortho_height *= factor;
        EXPECT_EQ(verdicts(scaled, view_scaled), expected) << "seed " << seed << " scale 2^" << exponent;
      }
    }
  }
}

// Coordinates that are not multiples of a common large power of two, as those of real scenes.
TEST(HardProof, SaysWhatBruteForceSaysOfRoundedCoordinates) {
  for (const float factor : {1e6f / 3.0f, 1e-4f / 3.0f, 1e-30f / 3.0f, 1e30f / 3.0f}) {
    for (std::uint32_t seed = 0; seed < test::rounds(60u); ++seed) {
      std::mt19937 random(seed);
      Scene scene = wallsAndTriangles(random);
      scale(scene, factor);
      View view = frontView();
      view.orthographic = seed % 3 == 0;
      view.z_near = 0.5 * static_cast<double>(factor);
      view.z_far = 100.0 * static_cast<double>(factor);
      view.ortho_height = 8.0 * static_cast<double>(factor);
      view.eye = Vec3d(scene.positions[seed % scene.positions.size()]) * (seed % 2 == 0 ? 0.0 : 1.0 / 3.0);
      EXPECT_EQ(verdicts(scene, view), bruteForce(scene, view)) << "seed " << seed << " scale " << factor;
    }
  }
}

// A distant small triangle behind two walls whose borders are `gap` units in the last place apart.
Scene slit(float at, int gap, float scale_of_all) {
  Scene scene;
  const MaterialId material = addMaterial(scene, Opacity::kOpaque, true);
  const float z = -4.0f * scale_of_all, size = 8.0f * scale_of_all;
  float right = at;
  for (int i = 0; i < std::abs(gap); ++i) {
    right = std::nextafter(right, gap > 0 ? size : -size);
  }
  const std::array<Vec3f, 3> target{Vec3f(3 * at - size / 8, -size / 8, 3 * z),
                                    Vec3f(3 * at + size / 8, -size / 8, 3 * z),
                                    Vec3f(3 * at, size / 8, 3 * z)};
  addTriangles(scene, material, target);
  addWall(scene, material, z, -size, at, -size, size);
  addWall(scene, material, z, right, size, -size, size);
  return scene;
}

TEST(HardProof, ASlitOfOneUlpShowsAndNoSlitHides) {
  for (const float scale_of_all : {1.0f, 1e-4f, 1e-30f, 1e6f, 1e30f}) {
    for (const float at : {1.0f / 3.0f, -0.7f, 0.1f, 1e-7f}) {
      View view = frontView();
      view.z_near = 0.1 * static_cast<double>(scale_of_all);
      view.z_far = 100.0 * static_cast<double>(scale_of_all);
      for (const int gap : {-1, 0, 1, 2, 5}) {
        const Scene scene = slit(at * scale_of_all, gap, scale_of_all);
        const Verdict verdict = verdicts(scene, view)[0];
        EXPECT_EQ(verdict, gap > 0 ? Verdict::kVisible : Verdict::kHidden)
            << "gap of " << gap << " ulp at " << at << " times " << scale_of_all;
      }
    }
  }
}

TEST(HardProof, TooFewStepsLeaveAnObjectUndecidedButNeverWrong) {
  std::size_t undecided = 0, decided = 0;
  for (std::uint32_t seed = 0; seed < test::rounds(200u); ++seed) {
    std::mt19937 random(seed);
    const Scene scene = wallsAndTriangles(random);
    const View view = frontView();
    const std::vector<Verdict> expected = bruteForce(scene, view);
    for (const std::uint32_t steps : {0u, 1u, 2u, 5u}) {
      const std::vector<Verdict> found = verdicts(scene, view, steps);
      for (std::size_t i = 0; i < found.size(); ++i) {
        EXPECT_TRUE(found[i] == Verdict::kUndecided || found[i] == expected[i])
            << "seed " << seed << " object " << i << " steps " << steps;
        (found[i] == Verdict::kUndecided ? undecided : decided) += 1;
      }
    }
  }
  EXPECT_GT(undecided, test::rounds(1000u));
  EXPECT_GT(decided, test::rounds(1000u));
}

void threeThreads(std::uint32_t count, const RangeBody& body) {
  std::vector<std::thread> threads;
  for (std::uint32_t begin = 0; begin < count; begin += 2) {
    threads.emplace_back([&body, begin, end = std::min(count, begin + 2)] { body(begin, end); });
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
}

TEST(HardProof, ThreadsAndTheOrderOfObjectsChangeNothing) {
  for (std::uint32_t seed = 0; seed < 30; ++seed) {
    std::mt19937 random(seed);
    const Scene scene = wallsAndTriangles(random);
    const View view = frontView();
    const ExactVisibility oracle(scene.view());
    std::vector<ObjectId> objects = objectsOf(scene);
    const std::vector<Decision> expected = oracle.decide(view, objects, kSteps);
    const auto expectSame = [&](const std::vector<Decision>& found) {
      for (std::size_t i = 0; i < objects.size(); ++i) {
        EXPECT_EQ(found[i].verdict, expected[objects[i].value].verdict) << "seed " << seed;
        EXPECT_EQ(found[i].witness, expected[objects[i].value].witness) << "seed " << seed;
      }
    };
    expectSame(oracle.decide(view, objects, kSteps, threeThreads));
    std::reverse(objects.begin(), objects.end());
    expectSame(oracle.decide(view, objects, kSteps));
    expectSame(ExactVisibility(scene.view()).decide(view, objects, kSteps, threeThreads));
  }
}

// A wall with its border exactly on the view's border, and one an ulp beyond it.
TEST(HardProof, WhatTouchesTheBorderOfTheViewIsSeen) {
  for (const bool orthographic : {false, true}) {
    View view = frontView();
    view.orthographic = orthographic;
    view.ortho_height = 8.0;
    const auto seenBeside = [&](float x0, float z0, float z1, const Vec3d& forward) {
      View turned = view;
      setOrientation(turned, forward, {0, 1, 0});
      Scene scene;
      const MaterialId material = addMaterial(scene, Opacity::kOpaque, true);
      const auto place = [&](float x, float y, float z) {
        return Vec3f(Vec3d(turned.right) * double(x) + turned.up * double(y) + forward * double(-z));
      };
      const std::array<Vec3f, 3> corners{place(x0, -1, z0), place(x0 + 2, -1, z1), place(x0 + 2, 1, z1)};
      addTriangles(scene, material, corners);
      return verdicts(scene, turned)[0];
    };
    for (const Vec3d& forward : {Vec3d(0, 0, -1), Vec3d(0, 0, 1), Vec3d(1, 0, 0), Vec3d(-1, 0, 0)}) {
      EXPECT_EQ(seenBeside(4.0f, -4, -4, forward), Verdict::kVisible);
      EXPECT_EQ(seenBeside(std::nextafter(4.0f, 5.0f), -4, -4, forward), Verdict::kHidden);
      EXPECT_EQ(seenBeside(std::nextafter(4.0f, 3.0f), -4, -4, forward), Verdict::kVisible);
      EXPECT_EQ(seenBeside(-6.0f, -4, -4, forward), Verdict::kVisible);
      EXPECT_EQ(seenBeside(std::nextafter(-6.0f, -7.0f), -4, -4, forward), Verdict::kHidden);
      view.z_far = 4.0;
      EXPECT_EQ(seenBeside(0.0f, -4, -4, forward), Verdict::kVisible) << "in the far plane";
      EXPECT_EQ(seenBeside(0.0f, -4, -5, forward), Verdict::kVisible) << "a corner in the far plane";
      EXPECT_EQ(seenBeside(0.0f, std::nextafter(-4.0f, -5.0f), -5, forward), Verdict::kHidden);
      view.z_far = 100.0;
      view.z_near = 4.0;
      EXPECT_EQ(seenBeside(0.0f, -4, -4, forward), Verdict::kVisible) << "in the near plane";
      EXPECT_EQ(seenBeside(0.0f, -4, -3, forward), Verdict::kVisible) << "a corner in the near plane";
      EXPECT_EQ(seenBeside(0.0f, std::nextafter(-4.0f, -3.0f), -3, forward), Verdict::kHidden);
      view.z_near = 0.1;
    }
  }
}

// Two blockers that end where they touch the target hide all of it but that one point.
TEST(HardProof, APointThatOnlyTouchingSurfacesCoverIsSeen) {
  View view = frontView();
  const std::array<Vec3f, 3> target{Vec3f(-2, -2, -4), Vec3f(2, -2, -4), Vec3f(0, 2, -4)};
  // Below y = 0 a roof whose ridge touches the target's plane in (0, 0, -4); above it another one.
  for (const bool with_cap : {false, true}) {
    Scene scene;
    const MaterialId material = addMaterial(scene, Opacity::kOpaque, true);
    addTriangles(scene, material, target);
    const Vec3f tip(0, 0, -4);
    for (const auto& [a, b] :
         {std::pair(Vec3f(-6, -6, -3), Vec3f(6, -6, -3)), std::pair(Vec3f(6, -6, -3), Vec3f(6, 6, -3)),
          std::pair(Vec3f(6, 6, -3), Vec3f(-6, 6, -3)), std::pair(Vec3f(-6, 6, -3), Vec3f(-6, -6, -3))}) {
      addTriangles(scene, material, std::array<Vec3f, 3>{a, b, tip});
    }
    if (with_cap) {
      addWall(scene, material, -2, -0.125f, 0.125f, -0.125f, 0.125f);
    }
    EXPECT_EQ(verdicts(scene, view)[kTarget.value], with_cap ? Verdict::kHidden : Verdict::kVisible);
    EXPECT_EQ(verdicts(scene, view), bruteForce(scene, view));
  }
}

}  // namespace
}  // namespace sightline
