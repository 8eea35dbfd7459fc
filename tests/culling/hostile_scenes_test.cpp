// No method culls what can be seen, on scenes made for that: a few seeds of what scripts/fuzz_scenes runs for
// as long as one likes.

#include <gtest/gtest.h>

#include "tests/support/judge_culling.h"
#include "tests/support/rounds.h"

namespace sightline {
namespace {

void expectNoFalseCull(std::uint64_t seed, test::JudgeCounts& counts) {
  const test::HostileScene hostile = test::HostileSceneMaker(seed).make();
  for (const test::FalseCull& wrong : test::CullingJudge(hostile, seed).judge(counts)) {
    ADD_FAILURE() << "seed " << seed << " (" << hostile.family << "), view " << wrong.view << ": object "
                  << wrong.object.value << " is seen at " << wrong.seen_at.x << ' ' << wrong.seen_at.y << ' '
                  << wrong.seen_at.z << ", but culled by " << wrong.method;
  }
}

// Each of these seeds has found a mistake.
TEST(HostileScenes, SeedsThatFoundAFalseCullFindNoneAnyMore) {
  test::JudgeCounts counts;
  // A piece of an occluder that a cut separates from an open edge, closer to it than its inset.
  expectNoFalseCull(40023244, counts);
  // An occluder that is flat up to its slack, cut twice by a near plane to which it is nearly parallel.
  expectNoFalseCull(700063715, counts);
}

TEST(HostileScenes, NothingThatIsCulledCanBeSeen) {
  test::JudgeCounts counts;
  for (std::uint64_t seed = 0; seed < test::rounds(250u); ++seed) {
    expectNoFalseCull(seed, counts);
  }
  // The scenes are worth nothing if little is culled in them, or if little of that is proved.
  EXPECT_GT(counts.culled - counts.frustum, test::rounds(3000u));
  EXPECT_LT(counts.undecided, counts.culled / 100);
  EXPECT_GT(counts.held, test::rounds(200u));
}

TEST(HostileScenes, TheSameSeedMakesTheSameScene) {
  const test::HostileScene a = test::HostileSceneMaker(7).make(), b = test::HostileSceneMaker(7).make();
  EXPECT_EQ(a.scene.positions, b.scene.positions);
  EXPECT_EQ(a.scene.indices, b.scene.indices);
  EXPECT_NE(a.scene.positions, test::HostileSceneMaker(8).make().scene.positions);
}

}  // namespace
}  // namespace sightline
