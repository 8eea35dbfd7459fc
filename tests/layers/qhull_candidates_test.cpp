#include "src/layers/hull/qhull_candidates.h"

#include <gtest/gtest.h>

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
