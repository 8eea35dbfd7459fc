// What RegionProof proves against lines of sight, by a test of segments and triangles that is written for it
// here.

#include "oracle/region_proof.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "oracle/split_mix.h"
#include "tests/support/hand_made.h"
#include "tests/support/rounds.h"

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
  bool provedInParts(std::uint32_t divisions, double near_distance = 0.0) const {
    return RegionProof(scene.view()).provesInParts({region, target, {}, near_distance}, divisions);
  }
};

// Neither of two walls that do not touch hides a target with two ends, each of which one of them hides.
Setting twoEndsBehindTwoWalls(float gap) {
  Setting s;
  addWall(s.scene, s.two_sided, -1, -9, -gap, -9, 9);
  addWall(s.scene, s.two_sided, -1, gap, 9, -9, 9);
  const std::array<Vec3f, 6> ends{
      {{-5, 0, -2}, {-4, 0, -2}, {-4, 1, -2}, {4, 0, -2}, {5, 0, -2}, {5, 1, -2}}};
  s.target = addTriangles(s.scene, s.opaque, ends);
  return s;
}

TEST(RegionProof, ProvesInPartsWhatDifferentThingsHide) {
  const Setting s = twoEndsBehindTwoWalls(0.5f);
  EXPECT_FALSE(s.proved());
  EXPECT_FALSE(s.provedInParts(0));
  EXPECT_TRUE(s.provedInParts(1));
  EXPECT_FALSE(s.provedInParts(1, 1.1)) << "a near plane may clip the walls";
  EXPECT_FALSE(twoEndsBehindTwoWalls(2.9f).provedInParts(8)) << "eyes look through the gap at the ends";
}

TEST(RegionProof, ProvesInPartsOfARegionWhatDifferentThingsHide) {
  // From each half of the region, one of two walls hides the target, and from all of it neither does.
  Setting s;
  s.region = {{-4, -1, 0}, {4, 1, 1}, {}};
  addWall(s.scene, s.two_sided, -1, -9, 0.25f, -9, 9);
  addWall(s.scene, s.two_sided, -2, -0.25f, 9, -9, 9);
  s.target = addWall(s.scene, s.opaque, -40, -0.5f, 0.5f, -1, 1);
  EXPECT_FALSE(s.proved());
  EXPECT_TRUE(s.provedInParts(4));
}

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

// Eyes on both sides of a floor, and before a wall that is joined with it: the floor is too near to hide
// anything. Without it the wall is joined with an overhang, which begins at the same edge and rises behind
// it.
TEST(RegionProof, LeavesOutAFloorThatEyesAreIn) {
  for (const bool overhang : {true, false}) {
    Setting s;
    const auto addQuad = [&](const Vec3f& a, const Vec3f& b, const Vec3f& c, const Vec3f& d) {
      addTriangles(s.scene, s.opaque, std::array{a, b, c, a, c, d});
    };
    addQuad({-9, -0.5f, -1}, {9, -0.5f, -1}, {9, 9, -1}, {-9, 9, -1});
    addQuad({9, -0.5f, -1}, {-9, -0.5f, -1}, {-9, -0.5f, 9}, {9, -0.5f, 9});
    if (overhang) {
      addQuad({9, -0.5f, -1}, {-9, -0.5f, -1}, {-9, 0.5f, -9}, {9, 0.5f, -9});
    }
    s.target = addWall(s.scene, s.opaque, -4, -1, 1, 0, 1);
    EXPECT_EQ(s.proved(0.1), overhang) << "eyes below the floor see the target below the wall";
  }
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

// Eyes with x + y >= 0, in a box whose other half holds a wall that no line of sight meets: at x = 0.1 the
// lines have x + y >= -0.19, for the target has x >= 5 and x + y >= -1, but the wall has -0.35 at most.
TEST(RegionProof, CountsNoLineThatNoEyeHas) {
  Setting s;
  constexpr double kHalfRoot = 0.70710678118654752;
  s.region.sides = {{{kHalfRoot, kHalfRoot, 0}, 0.0}};
  addTriangles(s.scene, s.two_sided,
               std::array<Vec3f, 6>{{{0.1f, -0.65f, 0.2f},
                                     {0.1f, -0.45f, 0.2f},
                                     {0.1f, -0.45f, 1.9f},
                                     {0.1f, -0.65f, 0.2f},
                                     {0.1f, -0.45f, 1.9f},
                                     {0.1f, -0.65f, 1.9f}}});
  s.target = addClosedBox(s.scene, s.two_sided, {5, -6, 0.5f}, {6, -5, 1.5f});
  EXPECT_FALSE(s.proved());
}

// A small box beside the line of sight, from a region so large that products of its coordinates overflow.
TEST(RegionProof, ProvesNothingOfARegionWhoseProductsOverflow) {
  Setting s;
  addClosedBox(s.scene, s.opaque, {-1, -1, -1}, {1, 1, 1});
  s.target = addClosedBox(s.scene, s.opaque, {-5, -5, -5}, {-3, -3, 3});
  for (const double size : {1e3, 1e60, 1e100, 1e150, 1e155, 1e200, 1e305}) {
    s.region = {{-size, -size, 2 * size}, {size, size, 3 * size}, {}};
    EXPECT_FALSE(s.proved()) << size;
  }
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

// A plane through the middle of the region, of a random direction or parallel to a diagonal of it.
HalfSpace randomSide(SplitMix& random) {
  const auto sign = [&] { return random.below(2) == 0 ? -1.0 : 1.0; };
  Vec3d n{random.in(-1, 1), random.in(-1, 1), random.in(-1, 1)};
  if (random.below(2) == 0) {
    n = {sign(), sign(), sign()};
    n[static_cast<int>(random.below(3))] = 0.0;
  }
  const Vec3d normal = n * (1.0 / length(n));
  return {normal, dot(normal, Vec3d{0, 0, 1}) + random.in(-0.2, 0.2)};
}

// A small wall in the box of the region, which may be on the side of the plane without eyes.
void addWallAmongEyes(Scene& scene, MaterialId material, SplitMix& random) {
  const auto in = [&](double low, double high) { return static_cast<float>(random.in(low, high)); };
  const Vec3f low{in(-0.8, 0.6), in(-0.8, 0.6), in(0.2, 1.6)};
  const int axis = static_cast<int>(random.below(3)), turn = 1 + static_cast<int>(random.below(2));
  Vec3f right{}, up{};
  right[axis] = in(0.05, 0.3);
  up[(axis + turn) % 3] = in(0.1, 1.6);
  const Vec3f a = low + right, b = a + up, c = low + up;
  addTriangles(scene, material, std::array<Vec3f, 6>{{low, a, b, low, b, c}});
}

TEST(RegionProof, NeverProvesWhatALineOfSightSees) {
  const std::uint64_t scenes = test::rounds<std::uint64_t>(2000);
  constexpr int kLines = 400;
  int proofs = 0, seen = 0;
  for (std::uint64_t seed = 1; seed <= scenes; ++seed) {
    SplitMix random{seed};
    const auto at = [&](double low, double high) {
      return static_cast<float>(std::round(random.in(low, high) * 2.0) / 2.0);  // ties are common
    };
    Setting s;
    const std::uint32_t things = 1 + random.below(4);
    for (std::uint32_t i = 0; i < things; ++i) {
      const float x = at(-6, 2), y = at(-6, 2), z = at(-4, -1);
      const float right = x + at(0.5, 12), up = y + at(0.5, 12);
      if (random.below(3) == 0) {
        addWallAmongEyes(s.scene, s.two_sided, random);
      } else if (random.below(2) == 0) {
        addClosedBox(s.scene, s.opaque, {x, y, z - at(0.5, 3)}, {right, up, z});
      } else {
        addWall(s.scene, random.below(2) == 0 ? s.opaque : s.two_sided, z, x, right, y, up,
                random.below(4) == 0);
      }
    }
    const float z = at(-12, -5);
    s.target = addClosedBox(s.scene, s.opaque, {at(-4, 0), at(-4, 0), z - 1}, {at(0.5, 3), at(0.5, 3), z});
    if (random.below(2) == 0) {
      s.region.sides = {randomSide(random)};
    }
    const EyePlaces eyes(s.region);
    const bool whole = s.proved(), proved = s.provedInParts(6);
    EXPECT_LE(whole, proved) << "seed " << seed;
    proofs += whole ? 1 : 0;
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
  EXPECT_GT(proofs, test::rounds(20));
  EXPECT_GT(seen, test::rounds(100));
}

// Walls beside each other at several distances overlap or leave gaps, as seen from the region.
TEST(RegionProof, NeverProvesInPartsWhatALineOfSightSees) {
  const std::uint64_t scenes = test::rounds<std::uint64_t>(1000);
  constexpr int kLines = 400;
  int proofs_in_parts = 0, seen = 0;
  for (std::uint64_t seed = 1; seed <= scenes; ++seed) {
    SplitMix random{seed};
    const auto at = [&](double low, double high) { return static_cast<float>(random.in(low, high)); };
    Setting s;
    float left = -30;
    for (int i = 0; i < 3; ++i) {
      const float right = i == 2 ? 30.0f : at(-3, 3), z = -1.0f - 0.5f * static_cast<float>(random.below(3));
      addWall(s.scene, s.two_sided, z, std::min(left, right) - at(-0.6, 0.8),
              std::max(left, right) + at(-0.6, 0.8), -30, 30);
      left = right;
    }
    const float z = at(-12, -5), x = at(-4, 0);
    s.target = addClosedBox(s.scene, s.opaque, {x, at(-4, 0), z - 1}, {x + at(0.5, 6), at(0.5, 3), z});
    if (random.below(4) == 0) {
      s.region.sides = {randomSide(random)};
    }
    const bool proved = s.provedInParts(6);
    proofs_in_parts += proved && !s.proved() ? 1 : 0;
    const EyePlaces eyes(s.region);
    const Box& box = s.scene.objects[s.target.value].bounds;
    for (int line = 0; line < kLines; ++line) {
      const Vec3d to{random.in(box.min.x, box.max.x), random.in(box.min.y, box.max.y),
                     random.in(box.min.z, box.max.z)};
      if (clear(s.scene, s.target, eyes.point(random), to)) {
        seen += 1;
        ASSERT_FALSE(proved) << "seed " << seed;
        break;
      }
    }
  }
  EXPECT_GT(proofs_in_parts, test::rounds(20));
  EXPECT_GT(seen, test::rounds(100));
}

// No wall is wider than 0.3 m, and the target is 1 m wide, so it is seen past them. It is beside the region,
// along the plane that ends it: there a line of sight is nearest to lines from places without eyes.
TEST(RegionProof, NeverProvesByWallsThatAreSmallerThanTheTarget) {
  const std::uint64_t scenes = test::rounds<std::uint64_t>(20000);
  for (std::uint64_t seed = 1; seed <= scenes; ++seed) {
    SplitMix random{seed};
    Setting s;
    s.region.sides = {randomSide(random)};
    for (int i = 0; i < 3; ++i) {
      addWallAmongEyes(s.scene, s.two_sided, random);
    }
    Vec3d across{};
    across[static_cast<int>(random.below(3))] = random.below(2) == 0 ? -8.0 : 8.0;
    const Vec3d aside = cross(s.region.sides[0].normal, across);
    if (length(aside) < 5.0) {
      continue;
    }
    const Vec3f low(Vec3d{-0.5, -0.5, 0.5} + aside);
    s.target = addClosedBox(s.scene, s.opaque, low, low + Vec3f{1, 1, 1});
    ASSERT_FALSE(s.proved()) << "seed " << seed;
  }
}

}  // namespace
}  // namespace sightline
