#include "src/pvs/bake/convex/samples.h"

#include <gtest/gtest.h>

#include "src/pvs/bake/bake_scene.h"
#include "tests/pvs/bake_scenes.h"

namespace sightline::pvs {
namespace {

using test::allOccluders;
using test::block;
using test::sceneOf;

class Samples : public ::testing::Test {
 protected:
  const Scene scene_ = sceneOf({block({0, -9, -9}, {1, 9, 9}), block({20, 0, 0}, {21, 1, 1})});
  const OccluderSet set_ = allOccluders(scene_);
  const BakeScene bake_{
      scene_.view(), set_, {.max_depth = 1, .viewers = {{{-8, -8, -8}, {8, 8, 8}}}}, serialFor};

  SampleStore store(std::size_t bytes) const {
    return {bake_.occluders, bake_.shadow_tree, bake_.reach, bytes};
  }
};

TEST_F(Samples, AreComputedOnceForAllThatShareTheViewpoint) {
  SampleStore samples = store(1u << 20);
  for (const double zero : {0.0, -0.0}) {
    Sample& sample = samples.at({-5, zero, 0.5});
    for (int i = 0; i < 10; ++i) {
      EXPECT_FALSE(samples.hidden(sample, 0).empty()) << "the wall hides the crate";
    }
  }
  EXPECT_EQ(samples.stats().samples, 1u);
  EXPECT_EQ(samples.stats().shadows, 1u);
}

TEST_F(Samples, RememberThatNothingIsHidden) {
  SampleStore samples = store(1u << 20);
  Sample& sample = samples.at({40, 0.5, 0.5});
  const std::uint32_t crate = bake_.occluders[0].object == ObjectId(1u) ? 0 : bake_.occluders.size() - 1;
  for (int i = 0; i < 100; ++i) {
    EXPECT_TRUE(samples.hidden(sample, crate).empty());
  }
  EXPECT_EQ(samples.stats().shadows, 1u);
  EXPECT_LT(sample.bytes(), 1024u);
}

TEST_F(Samples, AreForgottenOldestFirstAndComputedAgain) {
  SampleStore samples = store(1);
  Sample& first = samples.at({-5, 0, 0});
  const std::span<const ObjectRun> hidden = samples.hidden(first, 0);
  const Runs before(hidden.begin(), hidden.end());
  samples.forgetOldest();
  EXPECT_EQ(samples.stats().forgotten, 1u);
  Sample& again = samples.at({-5, 0, 0});
  EXPECT_TRUE(std::ranges::equal(samples.hidden(again, 0), before));
  EXPECT_EQ(samples.stats().samples, 2u);
  EXPECT_EQ(samples.stats().shadows, 2u);
  EXPECT_GT(samples.stats().max_sample_bytes, 0u);
}

}  // namespace
}  // namespace sightline::pvs
