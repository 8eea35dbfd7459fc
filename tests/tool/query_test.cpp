// `query` and `info` of baked files, against a file made by hand.

#include <cmath>

#include "sightline/pvs/bake/write_sight.h"
#include "tests/tool/run_tool.h"

namespace sightline::tool_test {
namespace {

using nlohmann::json;

// Four objects with 20, 40, 10 and 30 triangles; node 1 of their tree holds the objects 2 and 0, then come 3
// and 1. The root of the octree, from 0 to 8, has eight children; the first is divided again, the last has a
// plane. World space begins at x = 100.
BakedVisibility handmade() {
  BakedVisibility baked;
  baked.scene = {.hash = 7, .objects = 4, .triangles = 100};
  baked.record = {
      .near_distance = 0.5, .triangle_budget = 10, .max_depth = 2, .settings = R"({"origin":[100,0,0]})"};
  const Box box{{0, 0, 0}, {8, 8, 8}};
  baked.boxes.nodes = {{box, 6, 0, 4, 100}, {box, 4, 0, 2, 30}, {box, 3, 0, 1, 10},
                       {box, 4, 1, 1, 20},  {box, 5, 2, 1, 30}, {box, 6, 3, 1, 40}};
  for (const std::uint32_t object : {2u, 0u, 3u, 1u}) {
    baked.boxes.objects.push_back(ObjectId(object));
  }
  baked.sets.first = {0, 1, 2, 4, 5, 5};
  baked.sets.nodes = {0, 1, 3, 4, 5};
  VisibilityOctree& octree = baked.octree;
  octree.min = {0, 0, 0};
  octree.max = {8, 8, 8};
  octree.nodes = {1, 9};
  for (std::uint32_t leaf = 0; leaf < 15; ++leaf) {
    octree.nodes.push_back(kOctreeLeaf | leaf);
    octree.leaves.push_back({.set = leaf == 0 ? 4u : leaf == 1 || (leaf >= 7 && leaf != 8) ? 3u : 0u});
    octree.depths.push_back(leaf < 7 ? 1 : 2);
    octree.reasons.push_back(static_cast<std::uint8_t>(leaf % 4));
  }
  octree.leaves[6] = {.set = 0, .plane = 0, .front_set = 1, .back_set = 2};
  octree.planes = {{.normal = {1, 0, 0}, .front = 6.5, .back = 5.5}};
  return baked;
}

class HandmadeSight : public ::testing::Test {
 protected:
  void SetUp() override {
    const Status written = writeSight(file_, handmade());
    ASSERT_TRUE(written) << written.error().message;
  }

  TemporaryFolder folder_;
  std::string file_ = folder_.file("F.sight");
};

struct Expected {
  const char* point;
  int cell, level;  // -1 outside the octree
  const char* side;
  std::vector<int> visible;
};
const std::vector<Expected> kExpected = {
    {"101,1,1", 7, 2, nullptr, {1}},
    {"100,0,0", 7, 2, nullptr, {1}},  // a corner of the root
    {"105,5,5", 6, 1, "back", {0, 3}},
    {"105.5,5,5", 6, 1, "back", {0, 3}},
    {"106,5,5", 6, 1, "between", {0, 1, 2, 3}},
    {"106.5,5,5", 6, 1, "front", {0, 2}},
    {"108,8,8", 6, 1, "front", {0, 2}},
    {"104,1,1", 0, 1, nullptr, {}},  // on the border of cells: the upper one
    {"109,1,1", -1, -1, nullptr, {0, 1, 2, 3}},
    {"1,1,1", -1, -1, nullptr, {0, 1, 2, 3}},  // scene space
    {"-1e300,0,0", -1, -1, nullptr, {0, 1, 2, 3}},
};

TEST_F(HandmadeSight, IsAnsweredFromInWorldSpace) {
  std::vector<std::string> arguments{"query", "--json", "-"};
  for (const Expected& expected : kExpected) {
    arguments.push_back("--points");
    arguments.push_back(expected.point);
  }
  arguments.push_back(file_);
  const Outcome outcome = runTool(arguments);
  EXPECT_EQ(outcome.err, "");
  const json answer = printedJson(outcome);
  EXPECT_EQ(answer["outside"], 3);
  ASSERT_EQ(answer["points"].size(), kExpected.size());
  for (std::size_t i = 0; i < kExpected.size(); ++i) {
    const Expected& expected = kExpected[i];
    const json& point = answer["points"][i];
    EXPECT_EQ(point["visible"], json(expected.visible)) << expected.point;
    EXPECT_EQ(point["cell"], expected.cell < 0 ? json() : json(expected.cell)) << expected.point;
    EXPECT_EQ(point["level"], expected.level < 0 ? json() : json(expected.level)) << expected.point;
    EXPECT_EQ(point["side"], expected.side == nullptr ? json() : json(expected.side)) << expected.point;
  }
  EXPECT_EQ(answer["points"][2]["triangles"], 50);
}

TEST_F(HandmadeSight, SaysWhereNoViewerIsExpectedInACell) {
  BakedVisibility baked = handmade();
  baked.octree.viewers.resize(baked.octree.leaves.size());
  // The lower half of each cell along x.
  for (ViewerBounds& viewers : baked.octree.viewers) {
    viewers.last[0] = 127;
  }
  const std::string partly = folder_.file("partly.sight");
  ASSERT_TRUE(writeSight(partly, baked));
  const auto pointOf = [](const std::string& file, const char* point) {
    return toolJson({"query", file, "--points", point})["points"][0];
  };
  EXPECT_EQ(pointOf(partly, "101,1,5"), pointOf(file_, "101,1,5"));
  const json beside = pointOf(partly, "103,1,5");
  EXPECT_EQ(beside["cell"], pointOf(file_, "103,1,5")["cell"]);
  EXPECT_EQ(beside["set"], json());
  EXPECT_EQ(beside["visible"].size(), 4u) << "all objects";
  EXPECT_EQ(toolJson({"info", partly})["partial_cells"], 15);
}

TEST_F(HandmadeSight, IsAnsweredFromAlikeForFilesOfPointsAndCameraPaths) {
  const std::string points = folder_.write("points.json", R"({"points":[[101,1,1],[107,5,5]]})");
  const std::string path = folder_.write(
      "path.json",
      R"({"frames":[{"eye":[101,1,1],"forward":[0,0,-1]},{"eye":[107,5,5],"forward":[1,0,0]}]})");
  const Outcome literal =
      runTool({"query", file_, "--points", "101,1,1", "--points", "107,5,5", "--json", "-"});
  ASSERT_EQ(literal.code, 0) << literal.err;
  EXPECT_EQ(runTool({"query", file_, "--points", points, "--json", "-"}).out, literal.out);
  EXPECT_EQ(runTool({"query", file_, "--points", path, "--json", "-"}).out, literal.out);
  const Outcome both = runTool({"query", file_, "--points", path, "--points", "1,2,3"});
  EXPECT_NE(both.out.find("3 points in 2 cells"), std::string::npos) << both.out;
  EXPECT_NE(both.out.find("1 points are outside"), std::string::npos) << both.out;
}

TEST_F(HandmadeSight, IsDescribed) {
  const Outcome outcome = runTool({"info", file_, "--json", "-"});
  const json info = printedJson(outcome);
  EXPECT_EQ(info["scene"], json({{"hash", "0000000000000007"}, {"objects", 4}, {"triangles", 100}}));
  EXPECT_EQ(info["settings"]["near_distance"], 0.5);
  EXPECT_EQ(info["min"], json({100.0, 0.0, 0.0}));
  EXPECT_EQ(info["max"], json({108.0, 8.0, 8.0}));
  EXPECT_EQ(info["cells"], 15);
  EXPECT_EQ(info["deepest_level"], 2);
  EXPECT_EQ(info["grid_cells"], 64);
  EXPECT_EQ(info["planes"], 1);
  EXPECT_EQ(info["cells_with_plane"], 1);
  EXPECT_EQ(info["different_sets"], 5);
  EXPECT_EQ(
      info["stop_reasons"],
      json({{"budget_met", 4}, {"nothing_gained", 4}, {"max_depth", 4}, {"merged", 3}, {"outside", 0}}));
  ASSERT_EQ(info["levels"].size(), 3u);
  EXPECT_EQ(info["levels"][0]["cells"], 0);
  // Level 1: six cells with 0, 40 and four times 100 triangles; the sides of the seventh with 30 and 50.
  const json& first = info["levels"][1];
  EXPECT_EQ(first["cells"], 7);
  EXPECT_EQ(first["sets"]["count"], 8);
  EXPECT_NEAR(first["sets"]["triangles"]["mean"], 65.0, 1e-9);
  EXPECT_EQ(first["sets"]["triangles"]["min"], 0.0);
  EXPECT_EQ(first["sets"]["triangles"]["max"], 100.0);
  EXPECT_EQ(first["sets"]["histogram"], json({1, 0, 0, 1, 1, 1, 0, 0, 0, 4}));
  EXPECT_NEAR(first["sets"]["objects"]["mean"], (0 + 1 + 4 * 4 + 2 + 2) / 8.0, 1e-9);
  // Level 2: eight cells, seven with 40 and one with 100.
  const json& second = info["levels"][2]["sets"]["triangles"];
  EXPECT_NEAR(second["mean"], 47.5, 1e-9);
  EXPECT_NEAR(second["deviation"], std::sqrt((7 * 7.5 * 7.5 + 52.5 * 52.5) / 8.0), 1e-9);
  EXPECT_NEAR(info["mean_triangles_by_volume"], (0 + 40 + 400 + 40) / 8.0 + 380 / 64.0, 1e-9);
  std::uint64_t bytes = 0;
  for (const json& section : info["sections"]) {
    bytes += section["bytes"].get<std::uint64_t>();
  }
  EXPECT_LE(bytes, std::filesystem::file_size(file_));
  EXPECT_EQ(info["bytes"], std::filesystem::file_size(file_));
  EXPECT_EQ(info["databases"], json::array());
  // Known by its content, too.
  const std::string other_name = folder_.write("baked", contents(file_));
  EXPECT_EQ(runTool({"info", other_name, "--json", "-"}).out, outcome.out);
  EXPECT_NE(runTool({"info", file_}).out.find("a uniform grid of the smallest would have 64"),
            std::string::npos);
}

TEST_F(HandmadeSight, IsRefusedWhenDamaged) {
  const std::string whole = contents(file_);
  const std::string cut = folder_.write("cut.sight", whole.substr(0, whole.size() / 2));
  expectRefused({"query", cut, "--points", "1,1,1"}, "cut.sight");
  expectRefused({"info", cut}, "cut.sight");
  const std::string empty = folder_.write("empty.sight", "");
  expectRefused({"query", empty, "--points", "1,1,1"}, "empty.sight");
  for (std::size_t at = 0; at < whole.size(); at += std::max<std::size_t>(whole.size() / 16, 1)) {
    std::string altered = whole;
    altered[at] = static_cast<char>(altered[at] ^ 0x10);
    const std::string file = folder_.write("altered.sight", altered);
    const Outcome outcome = runTool({"query", file, "--points", "101,1,1", "--json", "-"});
    EXPECT_TRUE(outcome.code == 2 ||
                (outcome.code == 0 && parse(outcome.out)["points"][0]["visible"] == json::array({1})))
        << "byte " << at << ": " << outcome.err << outcome.out;
  }
}

TEST_F(HandmadeSight, IsNotAskedForWhatIsNoPoint) {
  const auto refuse = [&](const std::string& points, const std::string& about) {
    expectRefused({"query", file_, "--points", points}, about);
  };
  for (const std::string bad : {"1,2", "1,2,3,4", "nan,0,0", "inf,0,0", "1e999,0,0", "a,b,c", "1,2,", ",,"}) {
    refuse(bad, bad);
  }
  refuse("missing.json", "missing.json");
  refuse(folder_.file(""), folder_.file(""));
  const std::vector<std::pair<std::string, std::string>> bad = {
      {"empty", ""},
      {"cut", "{\"points\":[[1,2"},
      {"none", "{\"points\":[]}"},
      {"list", "[[1,2,3]]"},
      {"no_points", "{}"},
      {"nan", "{\"points\":[[NaN,0,0]]}"},
      {"huge", "{\"points\":[[1e999,0,0]]}"},
      {"null", "{\"points\":[[1,2,3],[null,0,0]]}"},
      {"short", "{\"points\":[[1,2]]}"},
      {"text", "{\"points\":\"here\"}"},
      {"no_frames", "{\"frames\":[]}"},
      {"no_eye", "{\"frames\":[{\"forward\":[0,0,-1]}]}"},
  };
  for (const auto& [name, text] : bad) {
    refuse(folder_.write(name + ".json", text), name == "none" ? "there are none" : name);
  }
  expectRefused({"query", file_}, "--points");
  expectRefused({"query", file_, "--points", "1,1,1", "--json", folder_.file("no/such/file")}, "file");
  EXPECT_EQ(runTool({"query", "--help"}).code, 0);
}

TEST(Query, OfOtherFilesIsRefused) {
  const TemporaryFolder folder;
  expectRefused({"query", folder.file("missing.sight"), "--points", "1,1,1"}, "missing.sight");
  expectRefused({"query", folder.file(""), "--points", "1,1,1"}, folder.file(""));
  const std::string scene = folder.write("scene.obj", "v 0 0 -5\nv 1 0 -5\nv 0 1 -5\nf 1 2 3\n");
  expectRefused({"query", scene, "--points", "1,1,1"}, "scene.obj");
  expectRefused({"info", folder.write("letter.sight", "dear reader, this is no baked file")}, "letter.sight");
}

}  // namespace
}  // namespace sightline::tool_test
