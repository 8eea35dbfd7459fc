// The experiments of the papers, on scenes that take a moment.

#include "tests/tool/run_tool.h"

namespace sightline::tool_test {
namespace {

using nlohmann::json;

std::vector<std::string> tiny(std::vector<std::string> more) {
  std::vector<std::string> arguments{"reproduce", "coorg-teller", "--short",  "--frames", "0:400:80",
                                     "--width",   "160",          "--height", "90"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

json reproduced(const std::vector<std::string>& more) {
  std::vector<std::string> arguments = tiny(more);
  arguments.insert(arguments.end(), {"--json", "-"});
  const Outcome outcome = runTool(arguments);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  return parse(outcome.out);
}

TEST(Reproduce, CoorgTellerHasATableForEachExperiment) {
  const json result = reproduced({"--scene", "demo:city?copies=1"});
  EXPECT_EQ(result["paper"], "coorg-teller");
  EXPECT_EQ(result["scenes"], json::array({"demo:city?copies=1"}));
  const std::vector<std::pair<std::string, std::vector<std::string>>> tables{
      {"polygons_drawn", {"scene", "culling", "triangles", "percent", "percent_of_frustum"}},
      {"frame_time", {"scene", "culling", "cull_ms"}},
      {"visibility_time",
       {"scene", "speed", "frames", "visibility_us", "visibility_us_nothing_kept", "reused", "unchanged",
        "rebuilt"}},
      {"nodes_tested", {"scene", "culling", "height", "nodes", "nodes_tested", "percent"}},
      {"memory", {"scene", "objects", "triangles", "relations", "relation_mib", "database_mib"}}};
  EXPECT_EQ(result["experiments"].size(), tables.size());
  for (const auto& [name, keys] : tables) {
    const json& table = result["experiments"][name];
    ASSERT_FALSE(table["rows"].empty()) << name;
    EXPECT_TRUE(table["title"].is_string() && table["claim"].is_string()) << name;
    for (const json& row : table["rows"]) {
      for (const std::string& key : keys) {
        EXPECT_TRUE(row.contains(key)) << name << " has no " << key;
      }
    }
  }
}

TEST(Reproduce, OcclusionCullingDrawsFewerPolygons) {
  const json result = reproduced({"--scene", "demo:city?copies=1", "--scene", "demo:building?floors=1"});
  const json& rows = result["experiments"]["polygons_drawn"]["rows"];
  constexpr std::size_t kCullings = 5;  // the first is the baseline
  ASSERT_EQ(rows.size(), 2 * kCullings);
  for (std::size_t scene = 0; scene < 2; ++scene) {
    const json& frustum = rows[kCullings * scene];
    EXPECT_EQ(frustum["culling"], "frustum");
    EXPECT_EQ(frustum["percent_of_frustum"], 100.0);
    for (std::size_t other = 1; other < kCullings; ++other) {
      EXPECT_LT(rows[kCullings * scene + other]["percent"], frustum["percent"])
          << rows[kCullings * scene + other];
    }
  }
}

TEST(Reproduce, AFastObserverRebuildsMoreRelations) {
  const json result = reproduced({"--scene", "demo:city?copies=1"});
  const json& rows = result["experiments"]["visibility_time"]["rows"];
  ASSERT_EQ(rows.size(), 6u);
  EXPECT_EQ(rows.front()["speed"], 1);
  EXPECT_EQ(rows.back()["speed"], 32);
  EXPECT_GT(rows.back()["rebuilt"], rows.front()["rebuilt"]);
  EXPECT_LT(rows.back()["unchanged"], rows.front()["unchanged"]);
}

TEST(Reproduce, WritesTablesAndAReportOfEachScene) {
  const TemporaryFolder folder;
  const std::string out = folder.file("new/folder");
  const Outcome outcome = runTool(tiny({"--scene", "demo:city?copies=1", "-o", out}));
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(contents(out + "/tables.txt"), outcome.out);
  EXPECT_TRUE(parse(contents(out + "/reproduce.json")).is_object());
  const std::string html = contents(out + "/1-demo-city-copies-1/index.html");
  EXPECT_NE(html.find("Coorg and Teller 1997: demo:city?copies=1"), std::string::npos);
  EXPECT_NE(html.find("reproduce coorg-teller"), std::string::npos) << "the command line";
}

TEST(Reproduce, APathThatStandsStillHasNoSpeeds) {
  const TemporaryFolder folder;
  const std::string path =
      folder.write("still.json",
                   "{\"fovy_deg\":60,\"width\":64,\"height\":36,\"near\":0.1,\"far\":100,"
                   "\"frames\":[{\"eye\":[0,2,0],\"forward\":[0,0,-1],\"up\":[0,1,0]}]}");
  const Outcome outcome =
      runTool({"reproduce", "coorg-teller", "--scene", "demo:city?copies=1", "--path", path, "--json", "-"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const json result = parse(outcome.out);
  EXPECT_TRUE(result["experiments"]["visibility_time"]["rows"].empty());
  EXPECT_NE(result["notes"].dump().find("too short"), std::string::npos);
}

TEST(Reproduce, WhatIsNotThereIsRefused) {
  expectRefused({"reproduce"}, "PAPER");
  expectRefused({"reproduce", "nobody"}, "coorg-teller");
  expectRefused({"reproduce", "coorg-teller", "--scene", "demo:nothing"}, "city");
  expectRefused({"reproduce", "coorg-teller", "--scene", "demo:city?copies=1", "--scene", "missing.glb"},
                "missing.glb");
  expectRefused({"reproduce", "coorg-teller", "--scene", "demo:city?copies=1", "--frames", "9:1"},
                "--frames");
  const TemporaryFolder folder;
  const std::string file = folder.write("there", "old");
  expectRefused(tiny({"--scene", "demo:city?copies=1", "-o", file}), "there");
  EXPECT_EQ(contents(file), "old");
}

}  // namespace
}  // namespace sightline::tool_test
