// What RegionProof proves against lines of sight, by a test of segments and triangles that is written for it
// here.

#include "oracle/region_proof.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "oracle/split_mix.h"
#include "tests/oracle/hand_made.h"

namespace sightline {
namespace {

using namespace hand_made;

// A closed box whose faces look outwards.
ObjectId addClosedBox(Scene& scene, MaterialId material, const Vec3f& low, const Vec3f& high) {
  std::array<Vec3f, 8> p;
  for (std::uint32_t i = 0; i < 8; ++i) {
    p[i] = {(i & 1) != 0 ? high.x : low.x, (i & 2) != 0 ? high.y : low.y, (i & 4) != 0 ? high.z : low.z};
  }
  const std::array<std::array<int, 4>, 6> faces{
      {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
  std::vector<Vec3f> corners;
  for (const auto& f : faces) {
    for (const int k : {0, 1, 2, 0, 2, 3}) {
      corners.push_back(p[static_cast<std::size_t>(f[static_cast<std::size_t>(k)])]);
    }
  }
  return addTriangles(scene, material, corners);
}

struct Setting {
  Scene scene;
  MaterialId opaque = addMaterial(scene, Opacity::kOpaque, false);
  MaterialId two_sided = addMaterial(scene, Opacity::kOpaque, true);
  EyeRegion region{{-1, -1, 0}, {1, 1, 2}, {}};
  ObjectId target;

  bool proved(double near_distance = 0.0, ObjectId by = {}) const {
    return RegionProof(scene.view()).proves({region, target, by, near_distance});
  }
};

TEST(RegionProof, ProvesWhatOneWallHides) {
  Setting s;
  const ObjectId wall = addWall(s.scene, s.opaque, -1, -9, 9, -9, 9);
  const ObjectId beside = addWall(s.scene, s.opaque, -2, 50, 51, 50, 51);
  s.target = addWall(s.scene, s.opaque, -4, -1, 1, -1, 1);
  EXPECT_TRUE(s.proved());
  EXPECT_TRUE(s.proved(0.9, wall));
  EXPECT_FALSE(s.proved(0.0, beside));
  EXPECT_FALSE(s.proved(1.1)) << "a near plane may clip the wall";
}

TEST(RegionProof, ProvesNothingThroughASlitOfATenThousandthOfAMetre) {
  Setting s;
  addWall(s.scene, s.two_sided, -1, -9, 0.3f, -9, 9);
  addWall(s.scene, s.two_sided, -1, 0.3001f, 9, -9, 9);
  s.target = addWall(s.scene, s.opaque, -4, -1, 1, -1, 1);
  EXPECT_FALSE(s.proved());
}

TEST(RegionProof, ProvesWhatTwoWallsWithACommonEdgeHide) {
  Setting s;
  addWall(s.scene, s.two_sided, -1, -9, 0.3f, -9, 9);
  addWall(s.scene, s.two_sided, -1, 0.3f, 9, -9, 9);
  s.target = addWall(s.scene, s.opaque, -4, -1, 1, -1, 1);
  EXPECT_TRUE(s.proved());
}

TEST(RegionProof, ProvesNothingByTheBackOfASingleSidedWall) {
  Setting s;
  addWall(s.scene, s.opaque, -1, -9, 9, -9, 9, true);
  s.target = addWall(s.scene, s.opaque, -4, -1, 1, -1, 1);
  EXPECT_FALSE(s.proved());
}

TEST(RegionProof, ProvesWhatAClosedBoxHidesAndNotWhatLooksPastIt) {
  Setting s;
  const ObjectId box = addClosedBox(s.scene, s.opaque, {-3, -3, -3}, {3, 3, -1});
  s.target = addWall(s.scene, s.opaque, -6, -1, 1, -1, 1);
  EXPECT_TRUE(s.proved(0.5, box));
  s.target = addWall(s.scene, s.opaque, -6, -1, 9, -1, 1);
  EXPECT_FALSE(s.proved());
}

// The wall ends at x = 0.5. From x <= 0, lines to x <= 0.4 behind it pass it at 0.3 or less; from x = 1, at
// 0.7.
TEST(RegionProof, KnowsTheSideOfAPlane) {
  Setting s;
  addWall(s.scene, s.opaque, -1, -9, 0.5f, -9, 9);
  s.target = addWall(s.scene, s.opaque, -2, 0, 0.4f, -1, 1);
  EXPECT_FALSE(s.proved());
  s.region.sides = {{{-1, 0, 0}, 0.0}};
  EXPECT_TRUE(s.proved());
  s.region.sides = {{{1, 0, 0}, 0.0}};
  EXPECT_FALSE(s.proved());
  s.region.sides = {{{1, 0, 0}, 5.0}};
  EXPECT_TRUE(RegionProof::isEmpty(s.region));
  EXPECT_TRUE(s.proved()) << "there is no eye";
}

TEST(RegionProof, RefutesAnObjectThatALineOfSightMisses) {
  Setting s;
  const ObjectId wall = addWall(s.scene, s.opaque, -1, -9, 9, -9, 9);
  const ObjectId beside = addWall(s.scene, s.opaque, -2, 50, 51, 50, 51);
  s.target = addWall(s.scene, s.opaque, -4, -1, 1, -1, 1);
  const RegionProof proof(s.scene.view());
  EXPECT_FALSE(proof.refutesObject({s.region, s.target, wall}));
  EXPECT_TRUE(proof.refutesObject({s.region, s.target, beside}));
}

// True if the segment clearly crosses no triangle of another object than the target, from its front or, where
// it is double-sided, at all.
bool clear(const Scene& scene, ObjectId target, const Vec3d& from, const Vec3d& to) {
  constexpr double kBeyondDoubt = 1e-7;
  for (std::uint32_t o = 0; o < scene.objects.size(); ++o) {
    if (o == target.value) {
      continue;
    }
    const std::span<const std::uint32_t> indices = scene.view().indicesOf(scene.objects[o]);
    const bool both = scene.view().materialOf(scene.objects[o]).double_sided;
    for (std::size_t i = 0; i < indices.size(); i += 3) {
      const Vec3d a(scene.positions[indices[i]]), b(scene.positions[indices[i + 1]]),
          c(scene.positions[indices[i + 2]]);
      const Vec3d n = cross(b - a, c - a), d = to - from;
      const double down = dot(n, d);
      if (std::abs(down) < 1e-12 || (down > 0.0 && !both)) {
        continue;
      }
      const double t = dot(n, a - from) / down;
      const Vec3d p = from + d * t;
      const double area = dot(n, n);
      const double u = dot(cross(b - a, p - a), n) / area, v = dot(cross(c - b, p - b), n) / area,
                   w = dot(cross(a - c, p - c), n) / area;
      if (t > -kBeyondDoubt && t < 1.0 + kBeyondDoubt && std::min({u, v, w}) > -kBeyondDoubt) {
        return false;
      }
    }
  }
  return true;
}

TEST(RegionProof, NeverProvesWhatALineOfSightSees) {
  constexpr std::uint64_t kScenes = 400;
  constexpr int kLines = 400;
  int proofs = 0, seen = 0;
  for (std::uint64_t seed = 1; seed <= kScenes; ++seed) {
    SplitMix random{seed};
    const auto at = [&](double low, double high) {
      return static_cast<float>(std::round(random.in(low, high) * 2.0) / 2.0);  // ties are common
    };
    Setting s;
    const std::uint32_t things = 1 + random.below(4);
    for (std::uint32_t i = 0; i < things; ++i) {
      const float x = at(-6, 2), y = at(-6, 2), z = at(-4, -1);
      const float right = x + at(0.5, 12), up = y + at(0.5, 12);
      if (random.below(2) == 0) {
        addClosedBox(s.scene, s.opaque, {x, y, z - at(0.5, 3)}, {right, up, z});
      } else {
        addWall(s.scene, random.below(2) == 0 ? s.opaque : s.two_sided, z, x, right, y, up,
                random.below(4) == 0);
      }
    }
    const float z = at(-12, -5);
    s.target = addClosedBox(s.scene, s.opaque, {at(-4, 0), at(-4, 0), z - 1}, {at(0.5, 3), at(0.5, 3), z});
    if (random.below(3) == 0) {
      s.region.sides = {{{0.6, 0.0, 0.8}, random.in(0.2, 1.5)}};
    }
    const EyePlaces eyes(s.region);
    const bool proved = s.proved();
    proofs += proved ? 1 : 0;
    const Box& box = s.scene.objects[s.target.value].bounds;
    for (int line = 0; line < kLines; ++line) {
      const Vec3d to{random.in(box.min.x, box.max.x), random.in(box.min.y, box.max.y),
                     random.in(box.min.z, box.max.z)};
      const Vec3d eye = eyes.point(random);
      if (clear(s.scene, s.target, eye, to)) {
        seen += 1;
        ASSERT_FALSE(proved) << "seed " << seed << ", eye " << eye.x << ' ' << eye.y << ' ' << eye.z;
        break;
      }
    }
  }
  EXPECT_GT(proofs, 20);
  EXPECT_GT(seen, 100);
}

}  // namespace
}  // namespace sightline
