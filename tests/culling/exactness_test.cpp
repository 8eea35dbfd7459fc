// Compares every setting of the culler with rays: an object that a ray reaches must not be culled.

#include <gtest/gtest.h>

#include <string>

#include "tests/culling/ray_judge.h"

namespace sightline {
namespace {

using namespace demo_frames;

// Takes a few consecutive frames at several places of each camera path, with a jump from place to place.
void judgeWalks(const DemoScene& demo, std::size_t places, std::size_t steady) {
  Judge judge(demo);
  for (const CameraPath& path : demo.scene.paths) {
    for (std::size_t place = 0; place < places; ++place) {
      const std::size_t first = path.frames.size() * place / places;
      std::size_t frame = first;
      for (const View& view : demo.frames(path, first, steady)) {
        judge.judge(view, "walk " + path.name + " frame " + std::to_string(frame++));
      }
    }
  }
  EXPECT_GT(judge.counts.seen, 100u);
  EXPECT_GT(judge.counts.hidden, 100u);
}

void judgeJumps(const DemoScene& demo, std::uint64_t seed, std::size_t count) {
  Judge judge(demo);
  const std::vector<View> views = jumps(demo, seed, count);
  for (std::size_t i = 0; i < views.size(); ++i) {
    judge.judge(views[i], "seed " + std::to_string(seed) + " jump " + std::to_string(i));
  }
  EXPECT_GT(judge.counts.hidden, 100u);
}

TEST(CullerAgainstRays, NothingSeenOnTheWalksOfTheCityIsCulled) {
  judgeWalks(smallCity(), 6, 4);
}

TEST(CullerAgainstRays, NothingSeenOnTheWalkOfTheBuildingIsCulled) {
  judgeWalks(smallBuilding(), 12, 4);
}

TEST(CullerAgainstRays, NothingSeenAfterJumpsInTheCityIsCulled) {
  judgeJumps(smallCity(), 1, 60);
}

TEST(CullerAgainstRays, NothingSeenAfterJumpsInTheBuildingIsCulled) {
  judgeJumps(smallBuilding(), 2, 60);
}

}  // namespace
}  // namespace sightline
