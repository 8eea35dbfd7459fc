// Tests `check`: true claims are proved or stand, forged claims are contradicted, forged witnesses refused.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <memory>
#include <set>
#include <span>

#include "scenes/procedural.h"
#include "sightline/pvs/bake/write_sight.h"
#include "sightline/pvs/format/witness.h"
#include "tests/tool/formats_page.h"
#include "tests/tool/sight_contents.h"

namespace sightline::tool_test {
namespace {

using nlohmann::json;

// Single occluders hide much of this ship. Where surfaces have to hide something, the tests bake a small
// city.
const std::string kCheckShip = "demo:ship?decks=3&rooms=4&machinery=0";

// Bakes and checks in a folder of its own.
class CheckedBake : public ::testing::Test {
 protected:
  static void bake(const std::string& scene, const std::string& file, const std::vector<std::string>& more) {
    const Outcome outcome = runTool(joined({"bake", scene, "-o", file, "--triangle-budget", "300"}, more));
    ASSERT_EQ(outcome.code, 0) << outcome.err;
  }
  Outcome check(const std::vector<std::string>& more = {}) const {
    return runTool(joined({"check", file_, scene_, "--witnesses", witnesses_}, more));
  }

  TemporaryFolder folder_;
  std::string scene_ = kCheckShip;
  const std::string file_ = folder_.file("made.sight"), witnesses_ = folder_.file("made.witnesses");
};

class Check : public CheckedBake {
 protected:
  // Each kind of bake is made once, and every test has a copy.
  static void SetUpTestSuite() {
    made_ = std::make_unique<TemporaryFolder>();
    bakeConvex(made_->file("convex"), {"--witnesses", made_->file("convex.witnesses")});
    bake(kCity, made_->file("fused"),
         {"--witnesses", made_->file("fused.witnesses"), "--occlusion", "fused", "--depth", "2"});
  }
  static void TearDownTestSuite() { made_.reset(); }
  void SetUp() override { use("convex"); }

  static void bakeConvex(const std::string& file, const std::vector<std::string>& more) {
    bake(kCheckShip, file, joined({"--depth", "2", "--region=40,3,-5,75,13,9"}, more));
  }
  void use(const std::string& kind) {
    const auto over = std::filesystem::copy_options::overwrite_existing;
    std::filesystem::copy_file(made_->file(kind), file_, over);
    std::filesystem::copy_file(made_->file(kind + ".witnesses"), witnesses_, over);
    scene_ = kind == "convex" ? kCheckShip : kCity;
  }
  Witnesses readBack() const {
    const std::string bytes = contents(witnesses_);
    const Result<Witnesses> witnesses = readWitnesses(std::as_bytes(std::span(bytes)), witnesses_);
    EXPECT_TRUE(witnesses) << witnesses.error().message;
    return *witnesses;
  }
  void writeBack(const Witnesses& witnesses) const {
    const std::vector<std::byte> bytes = witnessBytes(witnesses);
    std::ofstream(witnesses_, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  }
  void expectRefusedWithOneLine(const std::string& about) const {
    const Outcome outcome = check();
    EXPECT_EQ(outcome.code, 2) << outcome.out;
    EXPECT_NE(outcome.err.find(about), std::string::npos) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  }

  static inline std::unique_ptr<TemporaryFolder> made_;
};

TEST_F(Check, AccountsForEveryClaimWhateverTheThreads) {
  const Outcome one = check({"--json", "-"});
  const json report = printedJson(one);
  expectDocumented(report, {"check"});
  EXPECT_EQ(report["contradicted"], 0);
  EXPECT_EQ(report["claims"].get<std::uint64_t>(),
            report["proved"].get<std::uint64_t>() + report["survived"].get<std::uint64_t>());
  EXPECT_EQ(report["kinds"]["without"]["claims"], 0) << "a claim has no witness";
  EXPECT_GT(report["kinds"]["convex"]["proved"], 0);
  EXPECT_EQ(check({"--json", "-", "--threads", "3"}).out, one.out);

  // The claims are the objects that the sets leave out.
  const Result<SightFile> sight = SightFile::open(file_);
  ASSERT_TRUE(sight);
  const BakedVisibility baked = contentsOf(*sight);
  std::uint64_t left_out = 0;
  const auto countLeftOut = [&](std::uint32_t set) {
    left_out += baked.boxes.objects.size();
    for (auto i = baked.sets.first[set]; i < baked.sets.first[set + 1]; ++i) {
      left_out -= baked.boxes.nodes[baked.sets.nodes[i]].object_count;
    }
  };
  for (const OctreeLeaf& leaf : baked.octree.leaves) {
    countLeftOut(leaf.set);
    if (leaf.plane != OctreeLeaf::kNoPlane) {
      countLeftOut(leaf.front_set);
      countLeftOut(leaf.back_set);
    }
  }
  EXPECT_EQ(report["claims"], left_out);
}

// Two boxes of viewers that end anywhere in cells, one of them beside the other: cells around are asked about
// for the box around both, merged ones for what their parts were asked about.
TEST_F(CheckedBake, ClaimsAreThoseOfWhereViewersAreInACell) {
  // The boxes are given as shares of the scene's.
  struct Viewers {
    std::string scene;
    const char* occlusion;
    Vec3d first_min, first_max, second_min, second_max;
    int partial_cells;
  };
  for (const Viewers& viewers :
       {Viewers{kCheckShip,
                "convex",
                {0.32, 0.1, 0.1},
                {0.43, 0.53, 0.47},
                {0.4, 0.3, 0.2},
                {0.51, 0.6, 0.6},
                10},
        Viewers{
            kCity, "fused", {0.07, 0.1, 0.1}, {0.43, 0.83, 0.77}, {0.4, 0.3, 0.2}, {0.61, 0.9, 0.9}, 5}}) {
    scene_ = viewers.scene;
    const char* const occlusion = viewers.occlusion;
    const Result<Scene> scene = makeDemoScene(scene_);
    ASSERT_TRUE(scene);
    const Box bounds = sceneBounds(scene->view());
    const auto region = [&](const Vec3d& from, const Vec3d& to) {
      const Vec3d min(bounds.min), extent = Vec3d(bounds.max) - min;
      return fmt::format("--region={},{},{},{},{},{}", min.x + from.x * extent.x, min.y + from.y * extent.y,
                         min.z + from.z * extent.z, min.x + to.x * extent.x, min.y + to.y * extent.y,
                         min.z + to.z * extent.z);
    };
    bake(scene_, file_,
         {"--depth", "2", "--witnesses", witnesses_, "--occlusion", occlusion, "--merge-tolerance", "0.5",
          region(viewers.first_min, viewers.first_max), region(viewers.second_min, viewers.second_max)});
    const json report = printedJson(check({"--json", "-"}));
    EXPECT_GT(report["claims"], 100) << occlusion;
    EXPECT_EQ(report["contradicted"], 0) << occlusion;
    EXPECT_EQ(report["kinds"]["without"]["claims"], 0) << occlusion << ": a claim has no witness";
    EXPECT_GT(report["proved"], report["survived"]) << occlusion;
    const json info = toolJson({"info", file_});
    EXPECT_GT(info["partial_cells"], viewers.partial_cells) << occlusion;
    const Outcome pairs = runTool({"verify", scene_, "--baked", file_, "--proof", "--pairs", "60"});
    EXPECT_EQ(pairs.code, 0) << pairs.out << pairs.err;
  }
}

// Fewer and larger cells rest on the same witnesses.
TEST_F(CheckedBake, ABudgetInBytesLeavesWitnessesTrue) {
  const std::vector<std::string> regions{"--region=40.3,7.7,1.1,60.8,12.5,9.2",
                                         "--region=55.1,3.4,-3.2,72.6,6.8,5.9"};
  bake(kCheckShip, file_, joined({"--depth", "0"}, regions));
  const auto fewest = static_cast<double>(std::filesystem::file_size(file_));
  bake(kCheckShip, file_, joined({"--depth", "3"}, regions));
  const auto most = static_cast<double>(std::filesystem::file_size(file_));
  for (const double part : {0.6, 0.9, 0.3}) {
    const auto budget = static_cast<std::uintmax_t>(fewest + part * (most - fewest));
    bake(kCheckShip, file_,
         joined({"--depth", "3", "--witnesses", witnesses_, "--byte-budget", std::to_string(budget)},
                regions));
    const json report = printedJson(check({"--json", "-"}));
    EXPECT_GT(report["kinds"]["cells below"]["claims"], 0) << "some cells became one";
    EXPECT_GT(report["inherited"], 100);
    EXPECT_EQ(report["contradicted"], 0);
  }
}

TEST_F(Check, RecordingWitnessesChangesNothingInTheFile) {
  const std::string plain = folder_.file("plain.sight");
  bakeConvex(plain, {});
  EXPECT_TRUE(contents(plain) == contents(file_));
  const std::string again = folder_.file("again.sight"), same = folder_.file("again.witnesses");
  bakeConvex(again, {"--witnesses", same, "--threads", "3"});
  EXPECT_TRUE(contents(same) == contents(witnesses_));
}

// A cell that was divided and whose parts became one again has the plane of these, not its own.
TEST_F(Check, WitnessesOfASideAreOfCellsThatWereNotDivided) {
  for (const char* kind : {"convex", "fused"}) {
    use(kind);
    std::set<std::uint64_t> divided;
    const Witnesses witnesses = readBack();
    for (const HidingWitness& witness : witnesses.all) {
      for (std::uint64_t above = witness.cell / 8; above > 0; above /= 8) {
        divided.insert(above);
      }
    }
    EXPECT_FALSE(divided.empty());
    std::size_t of_sides = 0;
    for (const HidingWitness& witness : witnesses.all) {
      if (witness.part != WitnessPart::kWhole) {
        EXPECT_FALSE(divided.contains(witness.cell)) << kind << ", cell " << witness.cell;
        ++of_sides;
      }
    }
    EXPECT_GT(of_sides, 0u) << kind;
  }
}

TEST_F(Check, WitnessesOfSurfacesAreKnownByTheirKind) {
  use("fused");
  const Outcome outcome = check({"--json", "-"});
  const json report = printedJson(outcome);
  EXPECT_EQ(report["kinds"]["without"]["claims"], 0);
  EXPECT_GT(report["kinds"]["surfaces"]["proved"], 0);
  EXPECT_GT(report["survived"], 0);
  EXPECT_EQ(check({"--json", "-", "--threads", "3"}).out, outcome.out) << "rays depend on the threads";
  const json whole = printedJson(check({"--json", "-", "--divisions", "0"}));
  EXPECT_EQ(whole["claims"], report["claims"]);
  EXPECT_LT(whole["proved"], report["proved"]) << "nothing is proved in parts";
}

TEST_F(Check, ContradictsAForgedClaim) {
  const Result<SightFile> sight = SightFile::open(file_);
  ASSERT_TRUE(sight);
  BakedVisibility baked = contentsOf(*sight);
  // Nothing is seen from the cell in the middle: a lie.
  baked.sets.first.push_back(baked.sets.first.back());
  OctreeLeaf& leaf = baked.octree.leaves[baked.octree.leaves.size() / 2];
  leaf.set = leaf.front_set = leaf.back_set = static_cast<std::uint32_t>(baked.sets.first.size() - 2);
  ASSERT_TRUE(writeSight(file_, baked));
  const Outcome outcome = check();
  EXPECT_EQ(outcome.code, 1) << outcome.err;
  EXPECT_NE(outcome.out.find("contradicted: object "), std::string::npos) << outcome.out;
}

// Each witness names the object of another one, far from it in the file. What stands side by side may hide
// the same, but hardly all of them.
TEST_F(Check, RefusesForgedWitnesses) {
  const Witnesses witnesses = readBack();
  Witnesses forged = witnesses;
  const std::size_t count = witnesses.all.size();
  ASSERT_GT(count, 100u);
  for (std::size_t i = 0; i < count; ++i) {
    forged.all[i].object = witnesses.all[(i + count / 2) % count].object;
  }
  writeBack(forged);
  expectRefusedWithOneLine("is false");
}

TEST_F(Check, RefusesAForgedWitnessOfSurfaces) {
  use("fused");
  const Witnesses witnesses = readBack();
  const auto surfaces = [](const HidingWitness& witness) { return witness.kind == WitnessKind::kSurfaces; };
  const auto at = std::find_if(witnesses.all.begin(), witnesses.all.end(), surfaces) - witnesses.all.begin();
  ASSERT_LT(static_cast<std::size_t>(at), witnesses.all.size());
  const auto forge = [&](const auto& change) {
    Witnesses forged = witnesses;
    change(forged.all[static_cast<std::size_t>(at)]);
    writeBack(forged);
    expectRefusedWithOneLine("is false");
  };
  // The line begins outside of the cell; it is so short that it crosses nothing.
  forge([](HidingWitness& witness) { witness.from = witness.from + Vec3d{1e6, 0.0, 0.0}; });
  forge([](HidingWitness& witness) { witness.to = witness.from; });
}

// A bake asks about the box around a side of a cell's plane, so that a line may begin beyond the plane.
TEST_F(Check, AcceptsALineThatBeginsInTheCellBeyondTheSideThatItIsOf) {
  const std::string sight = folder_.file("cell.sight"), own = folder_.file("cell.witnesses");
  bake(kCheckShip, sight,
       {"--depth", "0", "--witnesses", own, "--occlusion", "fused", "--region",
        "90,5.625,1.875,95.625,11.25,7.5"});
  const Outcome outcome = runTool({"check", sight, kCheckShip, "--witnesses", own});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
}

TEST_F(Check, RefusesAWitnessThatNamesWhatIsNotThere) {
  Witnesses witnesses = readBack();
  ASSERT_FALSE(witnesses.all.empty());
  witnesses.all.back().object = ObjectId(1000000u);
  writeBack(witnesses);
  expectRefusedWithOneLine("names an object that the scene does not have");
}

TEST_F(Check, ClaimsWithoutWitnessesAreCountedAsSuch) {
  use("fused");  // of the smaller scene
  Witnesses witnesses = readBack();
  witnesses.all.clear();
  writeBack(witnesses);
  const json report = printedJson(check({"--json", "-"}));
  EXPECT_GT(report["kinds"]["without"]["claims"], 0);
  EXPECT_EQ(report["kinds"]["without"]["claims"].get<int>() + report["kinds"]["no eyes"]["claims"].get<int>(),
            report["claims"]);
  EXPECT_EQ(report["contradicted"], 0);
}

TEST_F(Check, RefusesDamagedFilesAndThoseOfOtherScenes) {
  const std::string whole = contents(witnesses_);
  for (const std::size_t length : {std::size_t{0}, std::size_t{7}, std::size_t{60}, whole.size() - 1}) {
    std::ofstream(witnesses_, std::ios::binary | std::ios::trunc) << whole.substr(0, length);
    expectRefusedWithOneLine("made.witnesses");
  }
  std::string altered = whole;
  altered[altered.size() / 2] = static_cast<char>(altered[altered.size() / 2] ^ 1);
  std::ofstream(witnesses_, std::ios::binary | std::ios::trunc) << altered;
  expectRefusedWithOneLine("damaged");

  std::ofstream(witnesses_, std::ios::binary | std::ios::trunc) << whole;
  Witnesses other = readBack();
  other.scene.hash += 1;
  writeBack(other);
  expectRefusedWithOneLine("another bake");
  expectRefused({"check", file_, "demo:ship?decks=4"}, "baked from another scene");
  expectRefused({"check", witnesses_, kCheckShip}, "made.witnesses");
  expectRefused({"check", file_, kCheckShip, "--json", file_}, "--json");
}

}  // namespace
}  // namespace sightline::tool_test
