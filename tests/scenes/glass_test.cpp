#include "scenes/glass.h"

#include <gtest/gtest.h>

#include <string>

#include "scenes/procedural.h"
#include "tests/scenes/scene_checks.h"

namespace sightline {
namespace {

using namespace scene_checks;

std::size_t countOf(const Scene& scene, Opacity opacity) {
  std::size_t count = 0;
  for (const Object& object : scene.objects) {
    count += scene.view().materialOf(object).opacity == opacity ? 1 : 0;
  }
  return count;
}

TEST(Glass, IsInOrder) {
  for (const GlassOptions& options : {GlassOptions{}, GlassOptions{.panes = 0, .bottles = 0},
                                      GlassOptions{.panes = 200, .bottles = 100, .seed = 77}}) {
    const Scene scene = makeGlass(options);
    EXPECT_EQ(whatIsWrong(scene), "");
    EXPECT_EQ(degenerateShare(scene), 0.0);
    ASSERT_EQ(scene.paths.size(), 1u);
    EXPECT_EQ(scene.paths[0].frames.size(), 240u);
    EXPECT_EQ(whatIsHit(scene, scene.paths[0], 0.3), "") << options.panes;
  }
}

TEST(Glass, OptionsCountWhatIsSeenThrough) {
  const std::size_t without = countOf(makeGlass({.panes = 0, .bottles = 0}), Opacity::kBlended);
  EXPECT_GT(without, 20u);
  EXPECT_EQ(countOf(makeGlass({.panes = 31, .bottles = 0}), Opacity::kBlended), without + 31);
  EXPECT_EQ(countOf(makeGlass({.panes = 0, .bottles = 17}), Opacity::kBlended), without + 17);
}

TEST(Glass, EverythingButFilmsIsASolidWithItsFrontsOutside) {
  const Scene scene = makeGlass({});
  std::size_t films = 0;
  for (const Object& object : scene.objects) {
    films += scene.view().materialOf(object).double_sided ? 1 : 0;
  }
  EXPECT_EQ(films, 6u);
  const SolidCounts solids = countSolids(scene);
  EXPECT_EQ(solids.closed, scene.objects.size() - films);
  EXPECT_EQ(solids.inside_out, 0u);
}

TEST(Glass, TheSameOptionsGiveTheSameBitsAndAnotherSeedOthers) {
  EXPECT_EQ(hashOf(makeGlass({})), hashOf(makeGlass({})));
  EXPECT_NE(hashOf(makeGlass({})), hashOf(makeGlass({.seed = 2})));
}

TEST(Glass, IsADemoScene) {
  const Result<Scene> scene = makeDemoScene("demo:glass?panes=5&bottles=3&seed=9");
  ASSERT_TRUE(scene);
  EXPECT_EQ(hashOf(*scene), hashOf(makeGlass({.panes = 5, .bottles = 3, .seed = 9})));
  const Result<Scene> wrong = makeDemoScene("demo:glass?copies=1");
  ASSERT_FALSE(wrong);
  EXPECT_NE(wrong.error().message.find("bottles"), std::string::npos);
}

}  // namespace
}  // namespace sightline
