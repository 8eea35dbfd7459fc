// Tests `verify --baked FILE --proof`: true sets stand, false ones are contradicted.

#include <gtest/gtest.h>

#include <memory>

#include "oracle/exact_visibility.h"
#include "sightline/pvs/bake/write_sight.h"
#include "sightline/pvs/query/sight_file.h"
#include "tests/tool/formats_page.h"
#include "tests/tool/sight_contents.h"
#include "tools/sightline/input/load.h"

namespace sightline::tool_test {
namespace {

using nlohmann::json;

const std::string kRegionScene = "demo:ship?decks=3&rooms=4&machinery=0";

class VerifyRegions : public ::testing::Test {
 protected:
  // The bake is made once for all tests.
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    file_ = folder_->file("ship.sight");
    const Outcome outcome =
        runTool({"bake", kRegionScene, "-o", file_, "--depth", "4", "--triangle-budget", "300"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
  }
  static void TearDownTestSuite() { folder_.reset(); }
  static Outcome verify(const std::string& file, const std::vector<std::string>& more) {
    return runTool(joined({"verify", kRegionScene, "--baked", file, "--proof"}, more));
  }

  inline static std::unique_ptr<TemporaryFolder> folder_;
  inline static std::string file_;
};

TEST_F(VerifyRegions, ContradictsNothingThatIsTrueWhateverTheThreads) {
  const Outcome one = verify(file_, {"--pairs", "80", "--json", "-"});
  const json report = printedJson(one);
  EXPECT_EQ(report["pairs"], 80);
  EXPECT_EQ(report["false_culls"], 0);
  EXPECT_EQ(report["witnesses"], json::array());
  EXPECT_GT(report["hidden_views"], 0);
  expectDocumented(report, {"verify of a baked file's cells"});
  EXPECT_EQ(verify(file_, {"--pairs", "80", "--json", "-", "--threads", "3"}).out, one.out);
  EXPECT_NE(verify(file_, {"--pairs", "80", "--json", "-", "--seed", "2"}).out, one.out);
}

TEST_F(VerifyRegions, ContradictsSetsFromWhichVisibleObjectsAreRemoved) {
  const Result<SightFile> sight = SightFile::open(file_);
  ASSERT_TRUE(sight);
  BakedVisibility baked = contentsOf(*sight);
  for (OctreeLeaf& leaf : baked.octree.leaves) {
    leaf.set = leaf.front_set = leaf.back_set = 0;
  }
  baked.sets = {{0, 0}, {}};
  const std::string tampered = folder_->file("tampered.sight");
  const Status written = writeSight(tampered, baked);
  ASSERT_TRUE(written) << written.error().message;
  const Outcome outcome = verify(tampered, {"--pairs", "80", "--json", "-", "--threads", "2"});
  const json report = printedJson(outcome, 1);
  ASSERT_GT(report["false_culls"], 0);
  EXPECT_EQ(report["false_culls"], report["witnesses"].size());
  expectDocumented(report, {"verify of a baked file's cells"});

  const Result<Scene> scene = tool::loadScene(kRegionScene);
  ASSERT_TRUE(scene);
  const ExactVisibility oracle(scene->view());
  for (const json& witness : report["witnesses"]) {
    const auto vec = [](const json& v) { return Vec3d(v[0], v[1], v[2]); };
    const Vec3d point = vec(witness["point"]) - scene->origin;
    View view;
    view.eye = vec(witness["eye"]) - scene->origin;
    setOrientation(view, point - view.eye, {0, 1, 0});
    view.tan_half_fovy = 1e-4;
    view.z_near = 0.999 * baked.record.near_distance;
    const ObjectId object(witness["object"].get<std::uint32_t>());
    EXPECT_TRUE(oracle.confirm(view, {object, point})) << witness;
  }
  const std::string text = verify(tampered, {"--pairs", "80"}).out;
  EXPECT_NE(text.find("false cull: object "), std::string::npos) << text;
}

TEST_F(VerifyRegions, RefusesWhatItCannotCompare) {
  expectRefused({"verify", kRegionScene, "--baked", file_, "--proof", "--pairs", "0"}, "--pairs");
  expectRefused({"verify", kRegionScene, "--baked", file_, "--proof", "--seed", "-1"}, "--seed");
  expectRefused({"verify", kRegionScene, "--proof", "--pairs", "10"}, "--baked");
  expectRefused({"verify", kRegionScene, "--baked", file_, "--pairs", "10"}, "--proof");
  expectRefused({"verify", kRegionScene, "--baked", file_, "--proof", "--seed", "3", "--method", "frustum"},
                "--method");
  expectRefused({"verify", "demo:ship?decks=4", "--baked", file_, "--proof"}, "baked from another scene");
  expectRefused({"verify", kRegionScene, "--baked", file_, "--proof", "--json", file_}, "--json");
}

}  // namespace
}  // namespace sightline::tool_test
