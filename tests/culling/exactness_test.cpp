// Compares every setting of the culler with rays: an object that a ray reaches must not be culled.

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/culling/ray_judge.h"
#include "tests/support/rounds.h"

namespace sightline {
namespace {

using namespace demo_frames;

// Takes a few consecutive frames at several places of each camera path, with a jump from place to place. At
// every second place the views are orthographic.
void judgeWalks(const DemoScene& demo, std::size_t places, std::size_t steady) {
  Judge judge(demo);
  places = test::rounds(places);
  std::size_t hidden_orthographic = 0;
  for (const CameraPath& path : demo.scene.paths) {
    for (std::size_t place = 0; place < places; ++place) {
      const std::size_t first = path.frames.size() * place / places;
      std::size_t frame = first;
      for (View view : demo.frames(path, first, steady)) {
        view.orthographic = place % 2 == 1;
        view.ortho_height = 12.0;
        const std::size_t hidden_before = judge.counts.hidden;
        judge.judge(view, "walk " + path.name + " frame " + std::to_string(frame++));
        hidden_orthographic += view.orthographic ? judge.counts.hidden - hidden_before : 0;
      }
    }
  }
  EXPECT_GT(judge.counts.seen, test::rounds(100u));
  EXPECT_GT(judge.counts.hidden, test::rounds(100u));
  EXPECT_GT(hidden_orthographic, 10u);
}

void judgeJumps(const DemoScene& demo, std::uint64_t seed, std::size_t count) {
  Judge judge(demo);
  const std::vector<View> views = jumps(demo, seed, test::rounds(count));
  for (std::size_t i = 0; i < views.size(); ++i) {
    judge.judge(views[i], "seed " + std::to_string(seed) + " jump " + std::to_string(i));
  }
  EXPECT_GT(judge.counts.hidden, test::rounds(100u));
}

// Follows each camera path from several places, so that surfaces know what hid something, what rests and for
// how long, and judges one view in six. Then it turns on the spot, which brings much into view in each step.
void judgeSurfacesAfterWalks(const DemoScene& demo, std::size_t places, std::size_t steady) {
  Judge judge(demo, surfaceCullers(demo));
  for (const CameraPath& path : demo.scene.paths) {
    for (std::size_t place = 0; place < places; ++place) {
      const std::vector<View> views =
          demo.frames(path, path.frames.size() * place / places, test::rounds(steady));
      const auto where = [&](const char* what, std::size_t i) {
        return what + path.name + " place " + std::to_string(place) + " view " + std::to_string(i);
      };
      for (std::size_t i = 0; i < views.size(); ++i) {
        if (i % 6 == 5) {
          judge.judge(views[i], where("walk ", i));
        } else {
          judge.pass(views[i]);
        }
      }
      View view = views.back();
      for (std::size_t i = 0; i < test::rounds(12u); ++i) {
        const double angle = 0.35 * static_cast<double>(i + 1);
        setOrientation(view, {std::cos(angle), std::sin(angle), -0.05}, {0, 0, 1});
        judge.judge(view, where("turn at ", i));
      }
    }
  }
  EXPECT_GT(judge.counts.seen, 100u);
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

TEST(CullerAgainstRays, NothingSeenAfterWalksOfTheCityIsHiddenBySurfaces) {
  judgeSurfacesAfterWalks(smallCity(), 3, 48);
}

TEST(CullerAgainstRays, NothingSeenAfterWalksOfTheBuildingIsHiddenBySurfaces) {
  judgeSurfacesAfterWalks(smallBuilding(), 4, 48);
}

}  // namespace
}  // namespace sightline
