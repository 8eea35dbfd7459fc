// The experiments of the papers, on scenes that take a moment.

#include <cmath>
#include <cstdlib>
#include <map>
#include <set>

#include "tests/support/pictures.h"
#include "tests/tool/formats_page.h"
#include "tests/tool/run_tool.h"

namespace sightline::tool_test {
namespace {

using nlohmann::json;

// What `reproduce` with -o prints and writes.
struct Reproduced {
  TemporaryFolder folder;  // also that of the tool's temporary files
  std::string out = folder.file("new/report");
  Outcome outcome;
  json result;
};

// Runs the tool once in a process for the same arguments.
const Reproduced& reproduced(const std::vector<std::string>& arguments) {
  static std::map<std::vector<std::string>, Reproduced> made;
  const auto [found, is_new] = made.try_emplace(arguments);
  Reproduced& all = found->second;
  if (is_new) {
    const char* const before = std::getenv("TMPDIR");
    const std::string old = before != nullptr ? before : "";
    setenv("TMPDIR", all.folder.file("").c_str(), 1);
    all.outcome = runTool(joined(arguments, {"-o", all.out}));
    before != nullptr ? setenv("TMPDIR", old.c_str(), 1) : unsetenv("TMPDIR");
    all.result = parse(contents(all.out + "/reproduce.json"));
  }
  EXPECT_EQ(all.outcome.code, 0) << all.outcome.err;
  EXPECT_EQ(all.outcome.err, "");
  return all;
}

const Reproduced& reproducedCity() {
  return reproduced({"reproduce", "coorg-teller", "--short", "--scene", kCity, "--frames", "0:400:80",
                     "--width", "160", "--height", "90"});
}

// An observer who stands still and looks around, which leaves out what takes longest.
json reproducedFromOnePlace(const std::vector<std::string>& scenes) {
  const TemporaryFolder folder;
  const std::string path =
      folder.write("still.json", R"({"fovy_deg":60,"width":64,"height":36,"near":0.1,"far":2000,)"
                                 R"("frames":[{"eye":[0,2,0],"forward":[0,0,-1]},)"
                                 R"({"eye":[0,2,0],"forward":[1,0,0]},)"
                                 R"({"eye":[0,2,0],"forward":[0,0,1]},)"
                                 R"({"eye":[0,2,0],"forward":[-1,0,0]}]})");
  std::vector<std::string> arguments{"reproduce", "coorg-teller", "--path", path, "--json", "-"};
  for (const std::string& scene : scenes) {
    arguments.insert(arguments.end(), {"--scene", scene});
  }
  const Outcome outcome = runTool(arguments);
  EXPECT_EQ(outcome.err, "");
  return printedJson(outcome);
}

TEST(Reproduce, CoorgTellerHasATableForEachExperiment) {
  const json& result = reproducedCity().result;
  expectDocumented(result, {"reproduce"});
  EXPECT_EQ(result["paper"], "coorg-teller");
  EXPECT_EQ(result["scenes"], json::array({kCity}));
  const std::vector<std::pair<std::string, std::vector<std::string>>> tables{
      {"polygons_drawn", {"scene", "culling", "triangles", "percent", "percent_of_frustum"}},
      {"frame_time", {"scene", "culling", "cull_ms"}},
      {"renderer_models", {"scene", "culling", "triangle_us", "total_ms", "speed_up"}},
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
  const std::vector<std::string> scenes{kCity, "demo:building?floors=1"};
  const json result = reproducedFromOnePlace(scenes);
  const json& rows = result["experiments"]["polygons_drawn"]["rows"];
  constexpr std::size_t kCullings = 5;  // the first is the baseline
  ASSERT_EQ(rows.size(), scenes.size() * kCullings);
  for (std::size_t scene = 0; scene < scenes.size(); ++scene) {
    const json& frustum = rows[kCullings * scene];
    EXPECT_EQ(frustum["culling"], "frustum");
    EXPECT_EQ(frustum["percent_of_frustum"], 100.0);
    for (std::size_t other = 1; other < kCullings; ++other) {
      EXPECT_LT(rows[kCullings * scene + other]["percent"], frustum["percent"])
          << rows[kCullings * scene + other];
    }
  }
}

TEST(Reproduce, ASlowerRendererGainsMore) {
  const json& result = reproducedCity().result;
  const json& rows = result["experiments"]["renderer_models"]["rows"];
  ASSERT_EQ(rows.size(), 5u * 4) << "five cullings, four renderers";
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const json& row = rows[r];
    EXPECT_NEAR(row["total_ms"].get<double>(), row["cull_ms"].get<double>() + row["draw_ms"].get<double>(),
                1e-9);
    if (row["culling"] == "frustum") {
      EXPECT_DOUBLE_EQ(row["speed_up"], 1.0);
    } else if (r % 4 > 0) {
      EXPECT_GT(row["triangle_us"], rows[r - 1]["triangle_us"]);
      EXPECT_GT(row["speed_up"], rows[r - 1]["speed_up"]) << row;
    }
  }
}

TEST(Reproduce, OnlyAFractionOfTheOccluderNodePairsIsCompared) {
  const json& result = reproducedCity().result;
  const json& kept = result["experiments"]["nodes_tested"]["rows"][0];
  EXPECT_GT(kept["node_pairs"], kept["nodes_tested"])
      << "each tested node is compared with an occluder at least";
  const double all = kept["nodes"].get<double>() * kept["occluders"].get<double>();
  EXPECT_NEAR(kept["pairs_percent"].get<double>(), 100.0 * kept["node_pairs"].get<double>() / all, 1e-6);
  EXPECT_LT(kept["pairs_percent"], 100.0 * kept["nodes_tested"].get<double>() / kept["nodes"].get<double>())
      << "a node is compared with fewer occluders than its parent";
  EXPECT_FALSE(result["experiments"]["nodes_tested"]["rows"][1].contains("node_pairs"));
}

TEST(Reproduce, AFastObserverRebuildsMoreRelations) {
  const json& result = reproducedCity().result;
  const json& rows = result["experiments"]["visibility_time"]["rows"];
  ASSERT_EQ(rows.size(), 6u);
  EXPECT_EQ(rows.front()["speed"], 1);
  EXPECT_EQ(rows.back()["speed"], 32);
  EXPECT_GT(rows.back()["rebuilt"], rows.front()["rebuilt"]);
  EXPECT_LT(rows.back()["unchanged"], rows.front()["unchanged"]);
}

TEST(Reproduce, WritesTablesAndAReportOfEachScene) {
  const auto& [folder, out, outcome, result] = reproducedCity();
  EXPECT_EQ(contents(out + "/tables.txt"), outcome.out);
  EXPECT_TRUE(result.is_object());
  const std::string html = contents(out + "/1-demo-city-copies-1/index.html");
  EXPECT_NE(html.find("Coorg and Teller 1997: demo:city?copies=1"), std::string::npos);
  EXPECT_NE(html.find("reproduce coorg-teller"), std::string::npos) << "the command line";
}

TEST(Reproduce, CoorgTellersColourPlateShowsFramesBesideTheirPlans) {
  SIGHTLINE_SKIP_WITHOUT_PICTURES();
  const auto& [folder, out, outcome, result] = reproducedCity();
  const std::string page = out + "/1-demo-city-copies-1/";
  const std::string html = contents(page + "index.html");
  EXPECT_NE(html.find("Colour plate: frame 0 of the walk through demo:city?copies=1"), std::string::npos);
  EXPECT_NE(html.find("hidden: culled by occluders"), std::string::npos) << "what the plan's colours mean";
  for (const std::string picture : {"frame_0000.png", "plan_0000.png"}) {
    EXPECT_NE(html.find(picture), std::string::npos);
    EXPECT_EQ(contents(page + picture).substr(1, 3), "PNG");
  }
  EXPECT_NE(outcome.out.find("colour plate: "), std::string::npos) << "a sentence on it";
}

TEST(Reproduce, APathThatStandsStillHasNoSpeeds) {
  const json result = reproducedFromOnePlace({kCity});
  EXPECT_TRUE(result["experiments"]["visibility_time"]["rows"].empty());
  EXPECT_NE(result["notes"].dump().find("too short"), std::string::npos);
}

constexpr const char* kShipWithMachinery = "demo:ship?decks=3&rooms=4&machinery=8";

const Reproduced& reproducedShip(const std::vector<std::string>& more = {}) {
  return reproduced(
      joined({"reproduce", "saona-vazquez", "--scene", kShipWithMachinery, "--depth", "4",
              "--triangle-budget", "3000", "--frames", "0:200:50", "--width", "160", "--height", "90"},
             more));
}

TEST(Reproduce, SaonaVazquezHasATableForEachExperiment) {
  const json& result = reproducedShip().result;
  expectDocumented(result, {"reproduce"});
  const std::vector<std::string> spread{"mean", "deviation", "min", "max"};
  const std::vector<std::pair<std::string, std::vector<std::string>>> tables{
      {"leaves", spread},
      {"levels", spread},
      {"histograms", {"level", "to_10", "to_100"}},
      {"uniform_grid", {"leaves", "with_viewers", "voxels_in_box", "voxels_in_root", "percent"}},
      {"budgets", {"budget_percent", "budget", "leaves", "met_percent", "depth", "triangles", "bake_s"}},
      {"polygons_sent", {"navigation", "culling", "mean", "deviation", "percent_of_frustum"}},
      {"frame_rate", {}},  // none without OpenGL
      {"look_up", {"frustum_us", "octree_us", "look_up_us", "first_find_us", "find_ns"}},
      {"bake", {"plan_s", "bake_s", "samples", "sample_mib", "peak_mib", "file_mib", "samples_to_file"}},
      {"pieces",
       {"parts", "part_ms", "part_deviation_ms", "part_max_ms", "part_mib", "part_deviation_mib",
        "part_max_mib", "whole_s", "apart_s", "whole_samples", "apart_samples"}}};
  EXPECT_EQ(result["experiments"].size(), tables.size());
  for (const auto& [name, keys] : tables) {
    const json& table = result["experiments"][name];
    EXPECT_TRUE(table["title"].is_string() && table["claim"].is_string()) << name;
    EXPECT_TRUE(keys.empty() || !table["rows"].empty()) << name;
    for (const json& row : table["rows"]) {
      for (const std::string& key : keys) {
        EXPECT_TRUE(row.contains(key)) << name << " has no " << key;
      }
    }
  }
}

TEST(Reproduce, TheOctreeIsTheOneThatBakeMakes) {
  const json& result = reproducedShip().result;
  // The near plane's corner: 0.1 m, 60 degrees, 16 : 9.
  const double near_distance = 0.1 * std::sqrt(1.0 + (1.0 + 256.0 / 81.0) / 3.0);
  const TemporaryFolder folder;
  const json baked =
      toolJson({"bake", kShipWithMachinery, "-o", folder.file("F.sight"), "--depth", "4", "--triangle-budget",
                "3000", "--near-distance", std::to_string(near_distance + 1e-6)});
  const json& tables = result["experiments"];
  const json& grid = tables["uniform_grid"]["rows"][0];
  EXPECT_EQ(grid["leaves"], baked["cells"]);
  EXPECT_EQ(grid["with_viewers"], baked["cells"].get<int>() - baked["stop_reasons"]["outside"].get<int>());
  EXPECT_EQ(grid["voxels_in_root"], baked["grid_cells"]);
  EXPECT_EQ(grid["different_sets"], baked["different_sets"]);
  std::map<std::string, int> reasons;
  int leaves = 0;
  for (const json& row : tables["levels"]["rows"]) {
    const json& level = baked["levels"][row["level"].get<std::size_t>()]["sets"]["triangles"];
    for (const char* key : {"mean", "deviation", "min", "max"}) {
      EXPECT_DOUBLE_EQ(row[key], level[key]) << row;
    }
    for (const char* key : {"budget_met", "nothing_gained", "max_depth", "merged"}) {
      reasons[key] += row[key].get<int>();
    }
    leaves += row["leaves"].get<int>();
  }
  EXPECT_EQ(leaves, grid["with_viewers"]);
  for (const auto& [key, count] : reasons) {
    EXPECT_EQ(count, baked["stop_reasons"][key]) << key;
  }
}

TEST(Reproduce, LeavesMeetLargerBudgetsAndAreFewerThen) {
  const json& result = reproducedShip().result;
  const json& rows = result["experiments"]["budgets"]["rows"];
  ASSERT_EQ(rows.size(), 3u);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_GT(rows[i]["met_percent"], 0.0) << rows[i];
    if (i > 0) {
      EXPECT_GT(rows[i]["budget"], rows[i - 1]["budget"]);
      EXPECT_LE(rows[i]["leaves"], rows[i - 1]["leaves"]);
      EXPECT_LE(rows[i]["depth"], rows[i - 1]["depth"]);
    }
  }
}

TEST(Reproduce, PiecesOfABakeComputeSamplesAgainAndHoldFewerAtATime) {
  const json& result = reproducedShip().result;
  const json& pieces = result["experiments"]["pieces"]["rows"][0];
  const json& bake = result["experiments"]["bake"]["rows"][0];
  EXPECT_GT(pieces["parts"], 1);
  EXPECT_GT(pieces["apart_samples"], pieces["whole_samples"]);
  EXPECT_EQ(pieces["whole_samples"], bake["samples"]);
  EXPECT_GE(pieces["part_max_mib"], pieces["part_mib"]);
  EXPECT_GT(pieces["part_mib"], 0.0);
  EXPECT_LT(pieces["part_max_mib"], bake["sample_mib"]);
  EXPECT_GE(pieces["part_max_ms"], pieces["part_ms"]);
}

TEST(Reproduce, EachOfSaonaVazquezsTablesHasASentenceOnWhatAgrees) {
  std::string claims;
  const json& result = reproducedShip().result;
  for (const json& finding : result["findings"]) {
    claims += finding["claim"].get<std::string>() + "\n";
    EXPECT_GT(finding["text"].get<std::string>().size(), 20u) << finding["claim"];
  }
  for (const std::string table : {"table 2", "table 3", "histograms", "uniform grid", "budget", "table 4",
                                  "navigation", "samples", "pieces"}) {
    EXPECT_NE(claims.find(table), std::string::npos) << table;
  }
}

TEST(Reproduce, TheOctreeSendsFewerPolygonsOnEveryNavigation) {
  const json& result = reproducedShip().result;
  const json& rows = result["experiments"]["polygons_sent"]["rows"];
  ASSERT_EQ(rows.size(), 4u);
  for (std::size_t navigation = 0; navigation < 2; ++navigation) {
    const json &frustum = rows[2 * navigation], &octree = rows[2 * navigation + 1];
    EXPECT_EQ(frustum["navigation"], navigation == 0 ? "walk" : "random");
    EXPECT_EQ(octree["navigation"], frustum["navigation"]);
    EXPECT_EQ(frustum["percent_of_frustum"], 100.0);
    EXPECT_LT(octree["mean"], frustum["mean"]);
    EXPECT_LE(octree["max"], frustum["max"]);
  }
}

TEST(Reproduce, ThreadsMakeTheSameOctree) {
  const json &one = reproducedShip().result, &three = reproducedShip({"--threads", "3"}).result;
  for (const char* table : {"leaves", "levels", "histograms", "uniform_grid", "polygons_sent"}) {
    EXPECT_EQ(one["experiments"][table], three["experiments"][table]);
  }
}

TEST(Reproduce, TheBakedFileIsGoneAfterwards) {
  const Reproduced& ship = reproducedShip();
  EXPECT_EQ(ship.folder.entries(), 1u) << "the report alone";
  const std::string html = contents(ship.out + "/1-demo-ship-decks-3-rooms-4-machinery-8/index.html");
  EXPECT_NE(html.find("Leaves by depth"), std::string::npos);
  EXPECT_NE(html.find("Triangles that may be seen, by depth"), std::string::npos);
}

TEST(Reproduce, ShortTakesASmallShipAndFewFrames) {
  const json result = toolJson({"reproduce", "saona-vazquez", "--short", "--width", "64", "--height", "36"});
  EXPECT_EQ(result["experiments"]["bake"]["rows"][0]["depth"], 4);
  EXPECT_EQ(result["scenes"], json::array({"demo:ship?decks=3&rooms=4&machinery=8"}));
  EXPECT_EQ(result["experiments"]["look_up"]["rows"][1]["frames"], 20);
}

const Reproduced& reproducedRoutes() {
  return reproduced({"reproduce", "poon-wang", "--short", "--scene", "demo:city?copies=2", "--frames",
                     "0:60:20", "--width", "64", "--height", "64"});
}

TEST(Reproduce, PoonWangHasATableForEachExperiment) {
  const json& result = reproducedRoutes().result;
  expectDocumented(result, {"reproduce"});
  const json& tables = result["experiments"];
  EXPECT_EQ(tables.size(), 5u);
  EXPECT_EQ(tables["occluder_counts"]["rows"].size(), 3u * 9) << "three criteria, nine numbers of occluders";
  EXPECT_EQ(tables["criteria"]["rows"].size(), 4u);
  EXPECT_EQ(tables["picture_sizes"]["rows"].size(), 2u * 3);
  std::set<std::string> routes;
  for (const json& row : tables["routes"]["rows"]) {
    routes.insert(row["route"]);
    EXPECT_GE(row["cull_ms"], 0.0);
  }
  EXPECT_EQ(routes, (std::set<std::string>{"best", "average", "worst"}));
  for (const json& row : tables["occluder_counts"]["rows"]) {
    EXPECT_GE(row["culled_percent"], 0.0) << row;
    EXPECT_LE(row["culled_percent"], 100.0) << row;
  }
  std::string claims;
  for (const json& finding : result["findings"]) {
    claims += finding["claim"].get<std::string>() + "\n";
  }
  for (const char* figure : {"figure 6:", "figure 8:", "peaks", "figure 9:", "figure 10:"}) {
    EXPECT_NE(claims.find(figure), std::string::npos) << figure;
  }
}

TEST(Reproduce, PoonWangsTopViewsAndBirdsEyeViewAreInTheReport) {
  SIGHTLINE_SKIP_WITHOUT_PICTURES();
  const auto& [folder, out, outcome, result] = reproducedRoutes();
  const std::string page = out + "/1-demo-city-copies-2/";
  const std::string html = contents(page + "index.html");
  for (const std::string picture :
       {"figure7_projected-size.png", "figure7_minimum-sets.png", "figure7_first-hit.png", "figure11.png"}) {
    EXPECT_NE(html.find(picture), std::string::npos) << picture;
    EXPECT_EQ(contents(page + picture).substr(1, 3), "PNG") << picture;
  }
  EXPECT_NE(html.find("Figure 7: top view of the model"), std::string::npos);
  EXPECT_NE(html.find("Figure 11: bird"), std::string::npos);
  EXPECT_NE(result["findings"].dump().find("figure 7:"), std::string::npos) << "a sentence on it";
}

TEST(Reproduce, TheAdaptiveOverlapTestFollowsTheMeasuredRendererOnEachRoute) {
  SIGHTLINE_SKIP_WITHOUT_PICTURES();
  const json& result = reproducedRoutes().result;
  std::set<std::string> routes;
  for (const json& row : result["experiments"]["routes"]["rows"]) {
    if (row["culling"] == "OM, adaptive") {
      routes.insert(row["route"]);
    }
  }
  EXPECT_EQ(routes.size(), 3u);
  const std::string notes = result["notes"].dump();
  for (const std::string& route : routes) {
    EXPECT_NE(notes.find("route " + route + ": the adaptive overlap test followed the renderer"),
              std::string::npos)
        << route;
  }
}

TEST(Reproduce, PoonWangsFiguresStandBesideOurs) {
  const json& tables = reproducedRoutes().result["experiments"];
  std::map<std::string, json> published;  // by table, culling and what else tells rows apart
  for (const char* table : {"routes", "criteria", "occluder_counts"}) {
    for (const json& row : tables[table]["rows"]) {
      const std::string what = row.value("route", "") + std::to_string(row.value("occluders", 0));
      published[std::string(table) + " " + row["culling"].get<std::string>() + " " + what] = row;
    }
  }
  EXPECT_EQ(published["routes OM best0"]["published_speed_up"], 14.6);
  EXPECT_EQ(published["routes PC worst0"]["published_fps"], 28.8);
  EXPECT_FALSE(published["routes VF best0"].contains("published_fps"));
  EXPECT_EQ(published["criteria projected-size best0"]["published_fps"], 5.4);
  EXPECT_EQ(published["occluder_counts minimum-sets 192"]["published_culled_percent"], 94.0);
  EXPECT_EQ(tables["picture_sizes"]["rows"][5]["published_speed_up"], 11.6);
}

TEST(Reproduce, ThePeaksOfTheSparseDepthMapAreUsedWhereTheyAreForced) {
  const json& tables = reproducedRoutes().result["experiments"];
  const json& rows = tables["depth_comparison"]["rows"];
  ASSERT_EQ(rows.size(), 3u * 3) << "three routes, three comparisons";
  for (std::size_t route = 0; route < 3; ++route) {
    const json &pixelwise = rows[3 * route], &where_paying = rows[3 * route + 1],
               &always = rows[3 * route + 2];
    EXPECT_EQ(pixelwise["sparse_rows"], 0.0);
    EXPECT_EQ(pixelwise["percent_of_pixelwise"], 100.0);
    EXPECT_GT(always["sparse_rows"], 0.0);
    EXPECT_LT(always["depths_compared"], pixelwise["depths_compared"]);
    EXPECT_LE(where_paying["depths_compared"], pixelwise["depths_compared"]);
    EXPECT_EQ(always["depth_tests"], pixelwise["depth_tests"]) << "the same answers, so the same questions";
    EXPECT_EQ(where_paying["depth_tests"], pixelwise["depth_tests"]);
  }
}

TEST(Reproduce, OptionsOfABakeAreOfPapersThatBake) {
  expectRefused({"reproduce", "coorg-teller", "--depth", "4"}, "coorg-teller");
  expectRefused({"reproduce", "poon-wang", "--triangle-budget", "1000"}, "poon-wang");
  expectRefused({"reproduce", "saona-vazquez", "--depth", "21"}, "--depth");
  expectRefused({"reproduce", "saona-vazquez", "--frames", "9:1"}, "--frames");
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
  expectRefused({"reproduce", "coorg-teller", "--scene", "demo:city?copies=1", "-o", file}, "there");
  EXPECT_EQ(contents(file), "old");
}

}  // namespace
}  // namespace sightline::tool_test
