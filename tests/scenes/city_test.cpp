#include <gtest/gtest.h>

#include <map>
#include <string>

#include "scenes/procedural.h"
#include "tests/scenes/scene_checks.h"

namespace sightline {
namespace {

using namespace scene_checks;

struct QuarterCounts {
  std::uint32_t objects = 0, triangles = 0;
};

std::map<int, QuarterCounts> countQuarters(const Scene& scene) {
  std::map<int, QuarterCounts> counts;
  const std::string prefix = "quarter ";
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    if (scene.object_names[i].compare(0, prefix.size(), prefix) == 0) {
      QuarterCounts& quarter = counts[std::stoi(scene.object_names[i].substr(prefix.size()))];
      ++quarter.objects;
      quarter.triangles += scene.objects[i].triangleCount();
    }
  }
  return counts;
}

TEST(City, EveryCopyHasAboutTenThousandTrianglesInSomeHundredObjects) {
  for (const std::uint32_t seed : {1u, 2u, 77u}) {
    const std::map<int, QuarterCounts> counts = countQuarters(makeCity({.copies = 40, .seed = seed}));
    ASSERT_EQ(counts.size(), 40u);
    for (const auto& [number, quarter] : counts) {
      EXPECT_GE(quarter.triangles, 9000u) << "seed " << seed << " quarter " << number;
      EXPECT_LE(quarter.triangles, 11000u) << "seed " << seed << " quarter " << number;
      EXPECT_GE(quarter.objects, 150u) << "seed " << seed << " quarter " << number;
      EXPECT_LE(quarter.objects, 450u) << "seed " << seed << " quarter " << number;
    }
  }
}

TEST(City, ThirtyCopiesHaveAboutThreeHundredThousandTriangles) {
  const Scene scene = makeCity({});
  EXPECT_NEAR(static_cast<double>(scene.triangleCount()), 300000.0, 10000.0);
  EXPECT_EQ(whatIsWrong(scene), "");
  EXPECT_LT(degenerateShare(scene), 0.0001);
  EXPECT_EQ(scene.origin, Vec3d());
}

TEST(City, SolidsAreOutward) {
  const Scene scene = makeCity({.copies = 9, .seed = 5});
  const SolidCounts counts = countSolids(scene);
  EXPECT_EQ(counts.inside_out, 0u);
  EXPECT_GT(counts.closed, scene.objects.size() / 5);
}

TEST(City, ShellsAreClosedAndTheirWallsAreWholeQuads) {
  const Scene scene = makeCity({.copies = 6, .seed = 9});
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    if (scene.object_names[i].find("shell") != std::string::npos) {
      EXPECT_TRUE(isClosed(scene, scene.objects[i])) << scene.object_names[i];
      EXPECT_LE(scene.objects[i].triangleCount(), 4u * 8u) << scene.object_names[i];
    }
  }
}

TEST(City, HasEveryKindOfMaterial) {
  const Scene scene = makeCity({.copies = 16});
  int blended = 0, alpha_tested = 0, opaque = 0;
  for (const Object& object : scene.objects) {
    const Opacity opacity = scene.materials[object.material.value].opacity;
    blended += opacity == Opacity::kBlended;
    alpha_tested += opacity == Opacity::kAlphaTested;
    opaque += opacity == Opacity::kOpaque;
  }
  EXPECT_GT(blended, 100);
  EXPECT_GT(alpha_tested, 100);
  EXPECT_GT(opaque, 2000);
}

TEST(City, WalksAreThoseThatAreDocumented) {
  const Scene scene = makeCity({.copies = 2});
  ASSERT_EQ(scene.paths.size(), 4u);
  const char* names[] = {"smooth", "best", "average", "worst"};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(scene.paths[i].name, names[i]);
    EXPECT_EQ(scene.paths[i].frames.size(), i == 0 ? 400u : 100u);
    EXPECT_EQ(scene.paths[i].z_near, 0.1);
    EXPECT_GT(scene.paths[i].z_far, 200.0);
  }
  EXPECT_NEAR(longestStep(scene.paths[0]), 0.36, 0.02);
  for (const CameraFrame& frame : scene.paths[0].frames) {
    EXPECT_NEAR(frame.eye.y, 1.7, 1e-9);
  }
}

TEST(City, WalksTurnSmoothly) {
  for (const CameraPath& path : makeCity({.copies = 4}).paths) {
    EXPECT_GT(smallestTurnCosine(path), 0.985) << path.name;  // 10 degrees
  }
}

TEST(City, WalksTouchNothing) {
  for (const std::uint32_t copies : {1u, 2u, 4u, 9u}) {
    for (const std::uint32_t seed : {1u, 2u, 3u}) {
      const Scene scene = makeCity({.copies = copies, .seed = seed});
      for (const CameraPath& path : scene.paths) {
        EXPECT_EQ(whatIsHit(scene, path, 0.2), "") << copies << " copies, seed " << seed;
      }
    }
  }
}

TEST(City, TheSameOptionsGiveTheSameBitsEverywhere) {
  EXPECT_EQ(hashOf(makeCity({.copies = 2, .seed = 1})), hashOf(makeCity({.copies = 2, .seed = 1})));
  EXPECT_EQ(hashOf(makeCity({.copies = 2, .seed = 1})), 16591692388632194316ull);
  EXPECT_EQ(hashOf(makeCity({.copies = 5, .seed = 4000000000u})), 906542713218882519ull);
}

}  // namespace
}  // namespace sightline
