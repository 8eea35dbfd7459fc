// A bake that takes over answers of an earlier one gives the bytes of a full bake.

#include <gtest/gtest.h>

#include <cstdlib>

#include "scenes/procedural.h"
#include "src/pvs/bake/encode_sight.h"
#include "tests/pvs/edited_scene.h"

namespace sightline {
namespace {

using test::EditedScene;
using test::RandomEdits;
using test::roomScene;

// The file of a bake, and what it leaves for the next one.
struct Made {
  std::vector<std::byte> file, answers;
  BakeStats stats{};
  Bake::TakenOver taken{};
};

// answers: of an earlier bake, or none.
Made bakeWith(const Scene& scene, BakeSettings settings, const std::vector<std::byte>& answers) {
  settings.answers = true;
  Result<Bake> bake = Bake::plan(scene.view(), test::allOccluders(scene), settings);
  Made made;
  if (!bake) {
    ADD_FAILURE() << bake.error().message;
    return made;
  }
  if (!answers.empty()) {
    const Result<Bake::TakenOver> taken = bake->takeOver(answers);
    EXPECT_TRUE(taken) << (taken ? "" : taken.error().message);
    made.taken = taken ? *taken : Bake::TakenOver{};
  }
  const BakedParts parts = bake->bakeAll(serialFor, {}, &made.stats);
  const Result<BakedVisibility> baked = bake->assemble(parts);
  EXPECT_TRUE(baked) << (baked ? "" : baked.error().message);
  if (baked) {
    made.file = *pvs::encodeSight(*baked);
    made.answers = bake->answers(parts);
  }
  return made;
}

// The same without anything that concerns updates.
std::vector<std::byte> plainFile(const Scene& scene, const BakeSettings& settings) {
  return *pvs::encodeSight(test::baked(scene, settings));
}

struct Totals {
  std::uint64_t edits = 0, comparable = 0, questions = 0, asked = 0;
};

// Edits the scene so many times, one edit after the other. After each, the bake that takes over from the one
// before has to give the bytes of a plain bake.
void judgeEdits(EditedScene scene, const BakeSettings& settings, std::uint32_t seed, int edits,
                Totals& totals) {
  RandomEdits random(seed);
  Made before = bakeWith(scene.scene(), settings, {});
  EXPECT_EQ(before.file, plainFile(scene.scene(), settings)) << "seed " << seed;
  std::string what = "seed " + std::to_string(seed);
  for (int i = 0; i < edits; ++i) {
    const EditedScene earlier = scene;
    what += "; " + random.edit(scene);
    const Scene now = scene.scene();
    Made made = bakeWith(now, settings, before.answers);
    ASSERT_TRUE(made.file == plainFile(now, settings)) << what;
    totals.edits += 1;
    if (made.taken.difference.empty()) {
      totals.comparable += 1;
      totals.questions += made.stats.questions;
      totals.asked += made.stats.asked;
    }
    // Every third edit is undone.
    if (i % 3 == 2) {
      scene = earlier;
      what += "; undone";
      const Made undone = bakeWith(scene.scene(), settings, made.answers);
      ASSERT_TRUE(undone.file == before.file) << what;
    } else {
      before = std::move(made);
    }
  }
}

// So many edits of each kind of scene; SIGHTLINE_UPDATE_EDITS makes them more.
int editsOf(int usual) {
  const char* more = std::getenv("SIGHTLINE_UPDATE_EDITS");
  return more != nullptr ? std::max(usual, std::atoi(more)) : usual;
}

void expectReuse(const Totals& totals) {
  ::testing::Test::RecordProperty("edits", static_cast<int>(totals.edits));
  EXPECT_GT(totals.comparable, totals.edits / 2) << "the test would prove little";
  EXPECT_LT(totals.asked, totals.questions / 2) << "of " << totals.questions << " questions";
  std::printf(
      "%llu edits, %llu comparable, %llu of %llu questions asked\n",
      static_cast<unsigned long long>(totals.edits), static_cast<unsigned long long>(totals.comparable),
      static_cast<unsigned long long>(totals.asked), static_cast<unsigned long long>(totals.questions));
}

TEST(Update, GivesTheBytesOfAFullBakeWithConvexOccluders) {
  Totals totals;
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    judgeEdits(roomScene(seed), {.triangle_budget = 120, .max_depth = 4, .near_distance = 0.05}, seed,
               editsOf(10), totals);
  }
  expectReuse(totals);
}

TEST(Update, GivesTheBytesOfAFullBakeWithSurfaces) {
  Totals totals;
  for (std::uint32_t seed = 11; seed <= 13; ++seed) {
    judgeEdits(roomScene(seed),
               {.occlusion = BakeOcclusion::kFused,
                .triangle_budget = 120,
                .max_depth = 3,
                .near_distance = 0.05,
                .narrowings = seed % 2},
               seed, editsOf(5), totals);
  }
  expectReuse(totals);
}

}  // namespace
}  // namespace sightline
