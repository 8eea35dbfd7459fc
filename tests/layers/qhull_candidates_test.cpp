#include "src/layers/hull/qhull_candidates.h"

#include <gtest/gtest.h>

#if defined(__unix__) || defined(__APPLE__)
#include <sys/resource.h>
#endif

#include <fstream>
#include <future>
#include <numeric>
#include <vector>

#include "tests/support/layer_shapes.h"

namespace sightline::layers {
namespace {

using shapes::Points;
using shapes::Random;

std::vector<std::uint32_t> numbersBelow(std::uint32_t count) {
  std::vector<std::uint32_t> numbers(count);
  std::iota(numbers.begin(), numbers.end(), 0u);
  return numbers;
}

// Returns the corners of a cube and then points inside it.
Points cubeWithPointsInside(std::uint64_t seed) {
  Random random(seed);
  Points points = shapes::cube();
  for (int i = 0; i < 200; ++i) {
    points.push_back(random.point({-0.9, -0.9, -0.9}, {0.9, 0.9, 0.9}));
  }
  return points;
}

TEST(QhullCandidates, AreTheCornersOfACubeWithPointsInside) {
  EXPECT_EQ(qhullCandidates(cubeWithPointsInside(1), {}), numbersBelow(8));
}

TEST(QhullCandidates, PointsInAPlaneHaveNone) {
  EXPECT_EQ(qhullCandidates(shapes::flatPolygon(8), {}), std::vector<std::uint32_t>());
}

#if defined(__unix__) || defined(__APPLE__)
// A server may have no descriptor left, and a changed root directory has no devices.
TEST(QhullCandidates, NoFileNeedBeOpened) {
  rlimit limit{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &limit), 0);
  rlimit none = limit;
  none.rlim_cur = 0;
  // Skipped where it cannot be tested: some containers forbid a process to change its limit.
  if (setrlimit(RLIMIT_NOFILE, &none) != 0) {
    GTEST_SKIP() << "the system does not let a process limit its open files";
  }
  const bool opens = std::ifstream("/").is_open();
  const std::vector<std::uint32_t> solid = qhullCandidates(cubeWithPointsInside(2), {});
  const std::vector<std::uint32_t> flat = qhullCandidates(shapes::flatPolygon(8), {});
  const bool restored = setrlimit(RLIMIT_NOFILE, &limit) == 0;
  EXPECT_EQ(solid, numbersBelow(8));
  EXPECT_TRUE(flat.empty());
  // The answers are right either way, but prove nothing where the limit is accepted and not held: some
  // containers do that.
  if (opens || !restored) {
    GTEST_SKIP() << "the system does not hold the limit of open files that a process sets";
  }
}
#endif

TEST(QhullCandidates, AreTheSameInSeveralThreadsAtOnce) {
  const auto work = [](std::uint64_t seed) {
    std::vector<std::vector<std::uint32_t>> results;
    for (std::uint64_t i = 0; i < 50; ++i) {
      Random random(seed + i);
      results.push_back(qhullCandidates(shapes::randomBall(random, 60), {}));
      // Qhull reports an error each time.
      results.push_back(qhullCandidates(shapes::flatPolygon(5 + static_cast<std::uint32_t>(i)), {}));
    }
    return results;
  };
  std::vector<std::future<std::vector<std::vector<std::uint32_t>>>> threads;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    threads.push_back(std::async(std::launch::async, work, seed));
  }
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    EXPECT_EQ(threads[seed].get(), work(seed));
  }
}

}  // namespace
}  // namespace sightline::layers
