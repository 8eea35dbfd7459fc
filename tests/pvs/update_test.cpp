// A bake that takes over answers of an earlier one gives the bytes of a full bake.

#include <gtest/gtest.h>

#include <cstdlib>

#include "scenes/procedural.h"
#include "tests/pvs/edited_scene.h"
#include "tests/support/rounds.h"

namespace sightline {
namespace {

using test::Answered;
using test::AnsweredBake;
using test::EditedScene;
using test::RandomEdits;
using test::roomScene;
using test::torn;

struct Totals {
  std::uint64_t edits = 0, comparable = 0, questions = 0, asked = 0;
  std::size_t most_parts = 0;  // of a bake
};

// Edits the scene so many times, one edit after the other. After each, the bake that takes over from the one
// before has to give the bytes of a full bake, and the same parts: these are sized by how much is asked, not
// by how much of it an earlier bake has answered.
void judgeEdits(EditedScene scene, const BakeSettings& settings, std::uint32_t seed, int edits,
                Totals& totals) {
  RandomEdits random(seed);
  Answered before = AnsweredBake(scene.scene(), settings).inFull();
  EXPECT_EQ(before.file, sight_test::bytesOf(test::baked(scene.scene(), settings))) << "seed " << seed;
  std::string what = "seed " + std::to_string(seed);
  for (int i = 0; i < edits; ++i) {
    const EditedScene earlier = scene;
    what += "; " + random.edit(scene);
    const Scene now = scene.scene();
    AnsweredBake bake(now, settings);
    const Answered full = bake.inFull();
    Answered made = bake.after(before.answers);
    ASSERT_TRUE(made.file == full.file) << what;
    ASSERT_EQ(made.parts, full.parts) << what;
    totals.most_parts = std::max(totals.most_parts, full.parts.size());
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
      const Answered undone = AnsweredBake(scene.scene(), settings).after(made.answers);
      ASSERT_TRUE(undone.file == before.file) << what;
    } else {
      before = std::move(made);
    }
  }
}

// So many edits of each kind of scene, at least three, of which the last is undone; SIGHTLINE_UPDATE_EDITS
// makes them more.
int editsOf(int usual) {
  const char* more = std::getenv("SIGHTLINE_UPDATE_EDITS");
  return std::max({3, test::rounds(usual), more != nullptr ? std::atoi(more) : 0});
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
    judgeEdits(roomScene(seed),
               {.triangle_budget = 120, .max_depth = seed == 1 ? 4u : 3u, .near_distance = 0.05}, seed,
               editsOf(7), totals);
  }
  expectReuse(totals);
  EXPECT_GT(totals.most_parts, 1u);
}

TEST(Update, GivesTheBytesOfAFullBakeWithSurfaces) {
  Totals totals;
  for (std::uint32_t seed = 11; seed < 11 + test::rounds(3u); ++seed) {
    judgeEdits(roomScene(seed, 2),
               {.occlusion = BakeOcclusion::kFused,
                .triangle_budget = 120,
                .max_depth = 2,
                .near_distance = 0.05,
                .narrowings = seed % 2},
               seed, editsOf(5), totals);
  }
  expectReuse(totals);
}

// Which objects are left out of a question that is asked again must not depend on the numbers of panels,
// which one more object changes all over.
TEST(Update, GivesTheBytesOfAFullBakeWhereNarrowingOrDividingIsAskedFor) {
  Totals totals;
  struct Asked {
    std::uint32_t seed, narrowings, divisions;
  };
  const Asked all[] = {{38, 1, 2}, {37, 0, 1}, {39, 1, 0}};
  for (const Asked& asked : all) {
    judgeEdits(torn(roomScene(asked.seed, 2), asked.seed),
               {.occlusion = BakeOcclusion::kFused,
                .triangle_budget = 120,
                .max_depth = 2,
                .near_distance = 0.05,
                .divisions = asked.divisions,
                .narrowings = asked.narrowings},
               asked.seed, editsOf(5), totals);
  }
  expectReuse(totals);
}

TEST(Update, GivesTheBytesOfAFullBakeWhereViewersAreInPartsOfCells) {
  Totals totals;
  for (std::uint32_t seed = 21; seed <= 22; ++seed) {
    const bool fused = seed % 2 == 0;
    judgeEdits(
        roomScene(seed, 2),
        {.occlusion = fused ? BakeOcclusion::kFused : BakeOcclusion::kConvex,
         .triangle_budget = 120,
         .max_depth = fused ? 2u : 4u,
         .near_distance = 0.05,
         .viewers = {{{0.3f, 0.2f, 0.4f}, {3.1f, 1.7f, 2.2f}}, {{2.6f, 0.3f, 1.1f}, {7.2f, 2.1f, 7.7f}}}},
        seed, editsOf(4), totals);
  }
  expectReuse(totals);
}

test::Piece blockPiece(const Vec3f& low, const Vec3f& high, std::uint32_t material) {
  constexpr int kFaces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  const auto corner = [&](int i) {
    return Vec3f{(i & 1) != 0 ? high.x : low.x, (i & 2) != 0 ? high.y : low.y, (i & 4) != 0 ? high.z : low.z};
  };
  test::Piece piece{.corners = {}, .material = MaterialId(material)};
  for (const auto& face : kFaces) {
    for (const int i : {face[0], face[1], face[2], face[0], face[2], face[3]}) {
      piece.corners.push_back(corner(i));
    }
  }
  return piece;
}

// A wall becomes glass, is said to hide nothing, or loses a corner. Its box and the number of its triangles
// stay what they were, and all else does.
TEST(Update, AWallThatHidesLessIsAnotherThoughItsBoxIsTheSame) {
  EditedScene scene;
  scene.materials = {{"wall", Opacity::kOpaque, false, {}}, {"glass", Opacity::kBlended, false, {}}};
  scene.pieces = {blockPiece({0, -0.25f, 0}, {8, 0, 8}, 0), blockPiece({3.75f, 0, 0}, {4, 3, 8}, 0)};
  for (int i = 0; i < 4; ++i) {
    const auto z = static_cast<float>(2 * i);
    scene.pieces.push_back(blockPiece({6, 1.25f, z + 0.5f}, {6.5f, 1.75f, z + 1}, 0));
  }
  std::vector<EditedScene> edited(3, scene);
  edited[0].pieces[1].material = MaterialId(1u);
  edited[1].pieces[1].mark = OccluderMark::kNever;
  for (Vec3f& corner : edited[2].pieces[1].corners) {
    corner.y = corner.y > 1.0f && corner.z > 1.0f ? 0.25f : corner.y;
  }
  for (const BakeOcclusion occlusion : {BakeOcclusion::kConvex, BakeOcclusion::kFused}) {
    const BakeSettings settings{
        .occlusion = occlusion, .triangle_budget = 12, .max_depth = 2, .near_distance = 0.05};
    const Answered before = AnsweredBake(scene.scene(), settings).inFull();
    std::size_t comparable = 0;
    for (std::size_t i = 0; i < edited.size(); ++i) {
      const Scene now = edited[i].scene();
      AnsweredBake bake(now, settings);
      const Answered full = bake.inFull(), made = bake.after(before.answers);
      comparable += made.taken.difference.empty() ? 1 : 0;
      EXPECT_FALSE(full.file == before.file) << "edit " << i << " shows nothing";
      EXPECT_TRUE(made.file == full.file) << "edit " << i;
    }
    // An edit may change the rounding that holds for all surfaces. Then nothing is taken over.
    EXPECT_GE(comparable, occlusion == BakeOcclusion::kConvex ? edited.size() : 1u);
  }
}

// What narrowing decided depends on all of the shaft, also where that reaches beyond all that hid before.
TEST(Update, AWallThatComesBeyondAllOthersHidesWhereNarrowingIsAllowed) {
  EditedScene scene;
  scene.materials = {{"wall", Opacity::kOpaque, false, {}}, {"glass", Opacity::kBlended, false, {}}};
  scene.pieces = {blockPiece({-50, -50, -50}, {-49, -49, -49}, 0),
                  blockPiece({40, 0.99f, 0.99f}, {40.02f, 1.01f, 1.01f}, 1),
                  blockPiece({60, 0, 0}, {60.5f, 0.5f, 0.5f}, 1),
                  blockPiece({15, -6, 0.6f}, {15.5f, 8, 1.75f}, 0)};
  const BakeSettings settings{.occlusion = BakeOcclusion::kFused,
                              .triangle_budget = 1,
                              .max_depth = 0,
                              .near_distance = 0.01,
                              .viewers = {Box{{0, 0, 0}, {2, 2, 2}}},
                              .narrowings = 1};
  const Answered before = AnsweredBake(scene.scene(), settings).inFull();
  scene.pieces.push_back(blockPiece({30, -6, 0.6f}, {30.5f, 8, 0.93f}, 0));
  AnsweredBake bake(scene.scene(), settings);
  const Answered full = bake.inFull(), made = bake.after(before.answers);
  EXPECT_EQ(made.taken.difference, "");
  EXPECT_EQ(made.taken.come, 1u);
  EXPECT_TRUE(made.file == full.file);
}

TEST(Update, GivesTheBytesOfAFullBakeInDemoScenes) {
  Totals totals;
  for (const char* name : {"demo:ship?decks=3&rooms=4&machinery=0", "demo:city?copies=1"}) {
    const Result<Scene> scene = makeDemoScene(name);
    ASSERT_TRUE(scene);
    for (const std::size_t sample_bytes : {std::size_t{64} << 20, std::size_t{0}}) {
      judgeEdits(
          EditedScene::of(*scene),
          {.triangle_budget = 300, .max_depth = 3, .near_distance = 0.05, .sample_bytes = sample_bytes}, 21,
          editsOf(3), totals);
    }
  }
  expectReuse(totals);
}

TEST(Update, AsksNothingAgainWhereNothingChanged) {
  for (const BakeOcclusion occlusion : {BakeOcclusion::kConvex, BakeOcclusion::kFused}) {
    const BakeSettings settings{
        .occlusion = occlusion, .triangle_budget = 120, .max_depth = 2, .near_distance = 0.05};
    const Scene scene = roomScene(5, 2).scene();
    AnsweredBake bake(scene, settings);
    const Answered first = bake.inFull(), again = bake.after(first.answers);
    EXPECT_EQ(first.stats.asked, first.stats.questions);
    EXPECT_EQ(again.stats.questions, first.stats.questions);
    EXPECT_EQ(again.stats.asked, 0u);
    EXPECT_TRUE(again.file == first.file);
    EXPECT_TRUE(again.answers == first.answers);
  }
}

// What stands far from everything else and is small is asked about, and little else is.
TEST(Update, AsksOnlyAboutWhatMovedWhereItHidesNothing) {
  EditedScene edited = roomScene(6);
  test::Piece crumb =
      EditedScene::of(test::sceneOf({test::block({1, 1.5f, 1}, {1.0625f, 1.5625f, 1.0625f})})).pieces[0];
  edited.pieces.push_back(crumb);
  const BakeSettings settings{.triangle_budget = 120, .max_depth = 4, .near_distance = 0.05};
  const Answered before = AnsweredBake(edited.scene(), settings).inFull();
  edited.pieces.back().move({0.5f, 0, 0.25f});
  const Answered after = AnsweredBake(edited.scene(), settings).after(before.answers);
  EXPECT_EQ(after.taken.come, 1u);
  EXPECT_EQ(after.taken.gone, 1u);
  EXPECT_LT(after.stats.asked * 20, after.stats.questions);
}

TEST(Update, RefusesBytesThatAreNoAnswers) {
  const Scene scene = roomScene(7, 2).scene();
  const BakeSettings settings{.triangle_budget = 120, .max_depth = 2, .answers = true};
  const std::vector<std::byte> answers = AnsweredBake(scene, settings).inFull().answers;
  Result<Bake> bake = Bake::plan(scene.view(), test::allOccluders(scene), settings);
  ASSERT_TRUE(bake);
  for (std::size_t length = 0; length < answers.size(); length += 1 + answers.size() / 97) {
    EXPECT_FALSE(bake->takeOver({answers.begin(), answers.begin() + static_cast<std::ptrdiff_t>(length)}));
  }
  for (std::size_t at = 0; at < answers.size(); at += 1 + answers.size() / 97) {
    std::vector<std::byte> altered = answers;
    altered[at] ^= std::byte{4};
    EXPECT_FALSE(bake->takeOver(std::move(altered))) << at;
  }
  EXPECT_TRUE(bake->takeOver(answers));
}

}  // namespace
}  // namespace sightline
