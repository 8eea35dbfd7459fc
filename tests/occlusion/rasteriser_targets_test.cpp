// Results are equal bit for bit for all instruction sets, divisions of the work and orders of execution.

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <bit>
#include <thread>

#include "sightline/comparison/centre_coverage.h"
#include "sightline/occlusion/rasteriser.h"
#include "tests/occlusion/small_scenes.h"
#include "tests/support/instruction_sets.h"
#include "tests/support/rounds.h"

namespace sightline {
namespace {

const CoverageRule* const kCoverageRules[] = {nullptr, centreCoverage()};

using namespace test;

// The bits of a buffer, without what lies beyond its width.
std::vector<std::uint32_t> bitsOf(const DepthBufferView& buffer) {
  std::vector<std::uint32_t> bits;
  bits.reserve(std::size_t{buffer.width} * buffer.height);
  for (std::uint32_t y = 0; y < buffer.height; ++y) {
    for (const float reciprocal_depth : buffer.row(y)) {
      bits.push_back(std::bit_cast<std::uint32_t>(reciprocal_depth));
    }
  }
  return bits;
}

struct Look {
  std::vector<std::uint32_t> bits;
  RasterStats stats;
  std::vector<std::uint32_t> ids;
};

Look look(const Rasteriser& rasteriser) {
  Look result{bitsOf(rasteriser.depthBuffer()), rasteriser.stats(), {}};
  for (const OccluderId id : rasteriser.occluders()) {
    result.ids.push_back(id.value);
  }
  std::ranges::sort(result.ids);
  return result;
}

Look drawn(const View& view, const OccluderSet& set, std::span<const OccluderId> chosen,
           const RasterSettings& settings, const ParallelFor& parallel_for = serialFor) {
  Rasteriser rasteriser(settings);
  rasteriser.begin(view);
  rasteriser.draw(set, chosen, parallel_for);
  return look(rasteriser);
}

void expectSame(const Look& a, const Look& b, const std::string& what) {
  EXPECT_TRUE(a.bits == b.bits) << what;
  EXPECT_EQ(a.stats.occluders, b.stats.occluders) << what;
  EXPECT_EQ(a.stats.unusable, b.stats.unusable) << what;
  EXPECT_EQ(a.stats.hidden, b.stats.hidden) << what;
  EXPECT_EQ(a.ids, b.ids) << what;
}

// Calls the body for each index, the last one first.
void backwards(std::uint32_t count, const RangeBody& body) {
  for (std::uint32_t i = count; i > 0; --i) {
    body(i - 1, i);
  }
}

// Calls the body for uneven ranges, the odd ones first and then the even ones, and for an empty one.
void uneven(std::uint32_t count, const RangeBody& body) {
  body(count, count);
  for (const std::uint32_t first : {1u, 0u}) {
    for (std::uint32_t begin = 3 * first; begin < count; begin += 6) {
      body(begin, std::min(begin + 3, count));
    }
  }
}

void threads(std::uint32_t count, const RangeBody& body) {
  std::vector<std::thread> running;
  for (std::uint32_t i = 0; i < 4; ++i) {
    running.emplace_back([&body, begin = count * i / 4, end = count * (i + 1) / 4] {
      if (begin < end) {
        body(begin, end);
      }
    });
  }
  for (std::thread& thread : running) {
    thread.join();
  }
}

// A wall of triangles over a grid: many shared edges.
std::vector<OraclePolygon> bumpyWall(Random& random, const Vec3d& origin, double scale) {
  constexpr std::size_t kSide = 9;
  std::vector<Vec3f> points;
  for (std::size_t i = 0; i < kSide * kSide; ++i) {
    const Vec3d at(static_cast<double>(i % kSide) - 4.0, static_cast<double>(i / kSide) - 4.0,
                   random.in(-0.3, 0.3));
    points.push_back(Vec3f(origin + at * scale));
  }
  std::vector<OraclePolygon> polygons;
  for (std::size_t y = 0; y + 1 < kSide; ++y) {
    for (std::size_t x = 0; x + 1 < kSide; ++x) {
      const std::size_t a = y * kSide + x, b = a + 1, c = b + kSide, d = a + kSide;
      polygons.push_back({{points[a], points[b], points[c]}, true});
      polygons.push_back({{points[a], points[c], points[d]}, true});
    }
  }
  return polygons;
}

constexpr std::pair<std::uint32_t, std::uint32_t> kTargetSizes[] = {{1, 1},   {7, 5},    {17, 9},
                                                                    {33, 17}, {321, 64}, {128, 200}};

// Calls look(view, polygons, settings, what) for scenes of all families, with both kinds of coverage.
template <typename Call>
void forEachScene(std::uint64_t seeds, Call&& call) {
  for (const Family& family : kFamilies) {
    for (std::uint64_t seed = 0; seed < seeds; ++seed) {
      RandomScene scene(family, seed);
      if (seed % 2 == 1) {
        const std::vector<OraclePolygon> bumpy = bumpyWall(scene.random, scene.origin, family.scale);
        scene.polygons.insert(scene.polygons.end(), bumpy.begin(), bumpy.end());
        setOrientation(scene.view, scene.origin - scene.view.eye, {0, 1, 0});
      }
      const auto& [width, height] = kTargetSizes[seed % std::size(kTargetSizes)];
      for (const CoverageRule* coverage : kCoverageRules) {
        call(scene.view, scene.polygons, RasterSettings{width, height, coverage},
             std::string(family.name) + ", seed " + std::to_string(seed) +
                 (coverage != nullptr ? ", centres" : ""));
      }
    }
  }
}

TEST(RasteriserBits, AreTheSameWithEveryInstructionSet) {
  const std::vector<std::int64_t> targets = hwy::SupportedAndGeneratedTargets();
  ASSERT_GE(targets.size(), test::kMinInstructionSets);
  std::size_t covered = 0;
  forEachScene(test::rounds(60), [&](const View& view, const std::vector<OraclePolygon>& polygons,
                                     const RasterSettings& settings, const std::string& what) {
    const OccluderSet set = setOf(polygons);
    const Look first = drawn(view, set, all(set), settings);
    for (const std::uint32_t bits : first.bits) {
      covered += std::bit_cast<float>(bits) > kUncovered ? 1 : 0;
    }
    for (const std::int64_t target : targets) {
      const test::ForcedInstructionSet forced(target);
      const Look other = drawn(view, set, all(set), settings);
      expectSame(first, other, what + ", " + hwy::TargetName(target));
    }
  });
  EXPECT_GT(covered, test::rounds(500'000u));
}

TEST(RasteriserBits, AreTheSameHoweverTheWorkIsCut) {
  forEachScene(36, [](const View& view, const std::vector<OraclePolygon>& polygons,
                      const RasterSettings& settings, const std::string& what) {
    const OccluderSet set = setOf(polygons);
    const Look first = drawn(view, set, all(set), settings);
    expectSame(first, drawn(view, set, all(set), settings, backwards), what + ", backwards");
    expectSame(first, drawn(view, set, all(set), settings, uneven), what + ", uneven");
    expectSame(first, drawn(view, set, all(set), settings, threads), what + ", threads");
  });
}

TEST(RasteriserBits, AreTheSameInAnyOrderOfTheChosenOccluders) {
  std::mt19937_64 random(5);
  forEachScene(36, [&](const View& view, const std::vector<OraclePolygon>& polygons,
                       const RasterSettings& settings, const std::string& what) {
    const OccluderSet set = setOf(polygons);
    std::vector<OccluderId> ids = all(set);
    const Look first = drawn(view, set, ids, settings);
    std::reverse(ids.begin(), ids.end());
    EXPECT_TRUE(first.bits == drawn(view, set, ids, settings).bits) << what;
    for (int i = 0; i < 3; ++i) {
      std::shuffle(ids.begin(), ids.end(), random);
      EXPECT_TRUE(first.bits == drawn(view, set, ids, settings).bits) << what;
    }
  });
}

TEST(RasteriserBits, DoNotChangeWhenTheSameIsDrawnAgain) {
  forEachScene(36, [](const View& view, const std::vector<OraclePolygon>& polygons,
                      const RasterSettings& settings, const std::string& what) {
    const OccluderSet set = setOf(polygons);
    Rasteriser rasteriser(settings);
    rasteriser.begin(view);
    rasteriser.draw(set, all(set));
    const std::vector<std::uint32_t> first = bitsOf(rasteriser.depthBuffer());
    rasteriser.draw(set, all(set));
    EXPECT_TRUE(bitsOf(rasteriser.depthBuffer()) == first) << what;
    // Drawing the polygons one by one has fewer shared edges, so it must cover no other pixels.
    for (const OccluderId id : all(set)) {
      rasteriser.draw(set, std::span(&id, 1));
    }
    EXPECT_TRUE(bitsOf(rasteriser.depthBuffer()) == first) << what;
    // Another view is drawn first, which must not affect the result.
    View other = view;
    other.forward = -view.forward;
    other.right = -view.right;
    rasteriser.begin(other);
    rasteriser.draw(set, all(set));
    rasteriser.begin(view);
    rasteriser.draw(set, all(set));
    EXPECT_TRUE(bitsOf(rasteriser.depthBuffer()) == first) << what;
  });
}

// Polygons that cross the near plane are cut at one depth per call, which depends on all of them.
bool crossesNearPlane(const View& view, const OraclePolygon& polygon) {
  bool before = false, beyond = false;
  for (const Vec3f& vertex : polygon.vertices) {
    const double depth = dot(view.forward, Vec3d(vertex) - view.eye);
    before |= depth < 2.0 * view.z_near;
    beyond |= depth > view.z_near;
  }
  return before && beyond;
}

TEST(RasteriserBits, AreTheSameWhenWhatIsNotConnectedIsDrawnInSeveralCalls) {
  int scenes = 0;
  for (const Family& family : kFamilies) {
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
      RandomScene scene(family, seed);
      std::size_t singles = 8;  // the others are connected
      for (std::size_t i = singles; i > 0; --i) {
        if (crossesNearPlane(scene.view, scene.polygons[i - 1])) {
          scene.polygons.erase(scene.polygons.begin() + static_cast<std::ptrdiff_t>(i - 1));
          --singles;
        }
      }
      const std::span polygons(scene.polygons);
      if (std::ranges::any_of(polygons.subspan(singles), [&](const OraclePolygon& polygon) {
            return crossesNearPlane(scene.view, polygon);
          })) {
        continue;
      }
      ++scenes;
      const OccluderSet together = setOf(polygons);
      const OccluderSet single = setOf(polygons.first(singles)), connected = setOf(polygons.subspan(singles));
      for (const CoverageRule* coverage : kCoverageRules) {
        const RasterSettings settings{65, 43, coverage};
        const Look first = drawn(scene.view, together, all(together), settings);
        Rasteriser rasteriser(settings);
        rasteriser.begin(scene.view);
        for (std::size_t i = single.occluders.size(); i > 0; --i) {
          const OccluderId id(i - 1);
          rasteriser.draw(single, std::span(&id, 1), backwards);
        }
        rasteriser.draw(connected, all(connected));
        EXPECT_TRUE(bitsOf(rasteriser.depthBuffer()) == first.bits) << family.name << ", seed " << seed;
        const RasterStats& stats = rasteriser.stats();
        EXPECT_EQ(stats.occluders, first.stats.occluders) << family.name << ", seed " << seed;
        EXPECT_EQ(stats.unusable, first.stats.unusable) << family.name << ", seed " << seed;
        EXPECT_EQ(rasteriser.occluders().size(), stats.occluders) << family.name << ", seed " << seed;
      }
    }
  }
  EXPECT_GT(scenes, 100);
}

TEST(RasteriserBits, AreTheSameInAMovedRasteriser) {
  const OccluderSet set = setOf(std::vector{wall(-2, 3, -1, 2, -5), wall(-9, 9, -9, 0, -8)});
  const RasterSettings settings{33, 17};
  const Look first = drawn(kLookingBack, set, all(set), settings);
  Rasteriser rasteriser(settings);
  rasteriser.begin(kLookingBack);
  Rasteriser moved(std::move(rasteriser));
  moved.draw(set, all(set));
  expectSame(first, look(moved), "moved");
  EXPECT_EQ(moved.settings().width, 33u);
}

}  // namespace
}  // namespace sightline
