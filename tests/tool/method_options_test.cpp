// How to cull: options that belong to methods, and what comes out of them.

#include "tests/support/rounds.h"
#include "tests/tool/run_tool.h"

namespace sightline::tool_test {
namespace {

using nlohmann::json;

// What `cull` answers, which says nothing beside it.
json culledQuietly(const std::vector<std::string>& scene, const std::vector<std::string>& options) {
  const Outcome outcome = runTool(joined(joined({"cull", "--json", "-"}, scene), options));
  EXPECT_EQ(outcome.err, "");
  return printedJson(outcome);
}
json culledCity(const std::vector<std::string>& options) {
  return culledQuietly({kCity, "--frames", "0:40:10"}, options);
}

std::vector<std::string> keysOf(const json& object) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : object.items()) {
    keys.push_back(key);
  }
  return keys;
}

TEST(MethodOptions, AMethodShowsItsOwnOptionsOnly) {
  using Keys = std::vector<std::string>;  // as parsed: ascending
  EXPECT_EQ(keysOf(culledCity({"--method", "frustum"})["options"]), (Keys{"hierarchy", "object_boxes"}));
  EXPECT_EQ(keysOf(culledCity({"--method", "occlusion-tree"})["options"]),
            (Keys{"area_angle", "coherence", "detail_objects", "draw_object_us", "draw_triangle_us",
                  "hierarchy", "lambda_steps", "min_node_cost", "object_boxes", "occluder_count", "occluders",
                  "test_objects", "variant"}));
  EXPECT_EQ(keysOf(culledCity({"--method", "supporting-planes"})["options"]),
            (Keys{"area_angle", "detail_objects", "draw_object_us", "draw_triangle_us", "hierarchy", "joint",
                  "lambda_steps", "min_node_cost", "object_boxes", "occluder_count", "occluders", "planes",
                  "test_objects"}));
  EXPECT_EQ(keysOf(culledCity({"--method", "supporting-planes", "--planes", "through-box"})["options"]),
            (Keys{"area_angle", "coherence", "detail_objects", "draw_object_us", "draw_triangle_us",
                  "hierarchy", "joint", "lambda_steps", "min_node_cost", "object_boxes", "occluder_count",
                  "occluders", "planes", "relation_mib", "tangents", "test_objects"}));
}

TEST(MethodOptions, ObjectsOfSeveralBoxesAreTheDepthPyramidsUnlessOneIsAskedFor) {
  const auto of = [](const std::string& method, const std::string& boxes) {
    const json cull = toolJson({"cull", "demo:building?floors=1", "--frames", "0:400:40", "--method", method,
                                "--object-boxes", boxes});
    std::size_t sum = 0;
    for (const json& frame : cull["frames"]) {
      sum += frame["visible"].size();
    }
    return sum;
  };
  EXPECT_LT(of("depth-pyramid", "8"), of("depth-pyramid", "1"));
  EXPECT_EQ(of("depth-pyramid", "0"), of("depth-pyramid", "8"));
  EXPECT_EQ(of("occlusion-tree", "0"), of("occlusion-tree", "1"));
  EXPECT_LT(of("occlusion-tree", "8"), of("occlusion-tree", "1"));
}

TEST(MethodOptions, WhereDrawingCostsNothingFramesAreCulledByTheFrustumAlone) {
  const auto givenUp = [](const std::string& option, const std::string& us) {
    const json cull = toolJson(
        {"cull", "demo:building?floors=1", "--method", "depth-pyramid", option, us, "--frames", "0:200"});
    int sum = 0;
    for (const json& frame : cull["frames"]) {
      sum += frame["renderer"]["given_up"].get<int>();
    }
    return sum;
  };
  for (const std::string option : {"--draw-object-us", "--draw-triangle-us"}) {
    EXPECT_GT(givenUp(option, "1e-9"), 100) << option;
    EXPECT_EQ(givenUp(option, "1e9"), 0) << option;
  }
}

TEST(MethodOptions, ValuesComeBackAsTheyWereGiven) {
  const json options = culledCity({"--method",
                                   "supporting-planes",
                                   "--hierarchy",
                                   "kd",
                                   "--occluders",
                                   "database",
                                   "--planes",
                                   "through-box",
                                   "--joint",
                                   "off",
                                   "--relation-mib",
                                   "0.25",
                                   "--tangents",
                                   "all-vertices",
                                   "--detail-objects",
                                   "on",
                                   "--detail-occluder-count",
                                   "3",
                                   "--database-directions",
                                   "6",
                                   "--database-occluder-count",
                                   "20",
                                   "--database-mib",
                                   "2.5"})["options"];
  EXPECT_EQ(options["hierarchy"], "kd");
  EXPECT_EQ(options["occluders"], "database");
  EXPECT_EQ(options["planes"], "through-box");
  EXPECT_EQ(options["joint"], "off");
  EXPECT_EQ(options["coherence"], "on");
  EXPECT_EQ(options["relation_mib"], 0.25);
  EXPECT_EQ(options["tangents"], "all-vertices");
  EXPECT_EQ(options["detail_objects"], "on");
  EXPECT_EQ(options["detail_occluder_count"], 3);
  EXPECT_EQ(options["database_directions"], 6);
  EXPECT_EQ(options["database_occluder_count"], 20);
  EXPECT_EQ(options["database_mib"], 2.5);
}

TEST(MethodOptions, TheTextTellsWhatIsNotAsUsual) {
  const auto text = [](std::vector<std::string> options) {
    options.insert(options.begin(), {"cull", kCity, "--frames", "0"});
    const std::string out = runTool(options).out;
    return out.substr(0, out.find("), 1 frames"));
  };
  EXPECT_EQ(text({}), "depth-pyramid (320x180, surfaces, bvh, coherence on");
  EXPECT_EQ(text({"--occluders", "database"}),
            "depth-pyramid (320x180, 64 occluders, bvh, coherence on, occluders database");
  EXPECT_EQ(text({"--method", "occlusion-tree"}), "occlusion-tree (FME, 64 occluders, bvh, coherence on");
  EXPECT_EQ(text({"--method", "frustum", "--joint", "off"}), "frustum (bvh");
  EXPECT_EQ(text({"--method", "supporting-planes"}), "supporting-planes (64 occluders, bvh");
  EXPECT_EQ(text({"--method", "supporting-planes", "--joint", "off", "--occluders", "database"}),
            "supporting-planes (64 occluders, bvh, occluders database, joint off");
}

TEST(MethodOptions, AnOptionMultipliesOnlyTheMethodsThatHaveIt) {
  const json runs =
      toolJson({"verify",       kCity,     "--frames",         "0",
                "--width",      "64",      "--height",         "36",
                "--aimed-rays", "1",       "--method",         "frustum,occlusion-tree,supporting-planes",
                "--variant",    "FSE,FME", "--occluders",      "area-angle,database",
                "--joint",      "on,off",  "--detail-objects", "on,off"})["runs"];
  EXPECT_EQ(runs.size(), 1u + 2u * 2u * 2u + 2u * 2u * 2u);
  for (const json& run : runs) {
    EXPECT_EQ(run["options"].contains("joint"), run["method"] == "supporting-planes");
    EXPECT_EQ(run["options"].contains("variant"), run["method"] == "occlusion-tree");
  }
}

TEST(MethodOptions, FramesTellOfRelationsWhereTheyAreKept) {
  const json cull = culledCity({"--method", "supporting-planes", "--planes", "through-box"});
  EXPECT_FALSE(cull.contains("database"));
  for (const json& frame : cull["frames"]) {
    for (const std::string key :
         {"reused", "unchanged", "rebuilt", "evicted", "dropped", "kept", "bytes", "node_pairs"}) {
      EXPECT_TRUE(frame["relations"][key].is_number_unsigned()) << key;
    }
    EXPECT_GT(frame["nodes_tested_share"], 0.0);
    EXPECT_LE(frame["nodes_tested_share"], 1.0);
    EXPECT_FALSE(frame.contains("detail"));
  }
  EXPECT_GT(cull["frames"].back()["relations"]["reused"], 0);
  for (const std::string method : {"occlusion-tree", "supporting-planes"}) {
    const json without = culledCity({"--method", method});
    for (const json& frame : without["frames"]) {
      EXPECT_FALSE(frame.contains("relations"));
      EXPECT_TRUE(frame.contains("nodes_tested_share"));
    }
  }
}

TEST(MethodOptions, TheDatabaseIsToldOfWhereItIsUsed) {
  const json cull = culledCity({"--occluders", "database", "--detail-objects", "on", "--no-times"});
  EXPECT_GT(cull["database"]["cells"], 0);
  EXPECT_EQ(cull["database"]["directions"], 32);
  EXPECT_GT(cull["database"]["bytes"], 0);
  EXPECT_EQ(cull["database"]["build_us"], 0.0);
  EXPECT_GT(cull["detail_database"]["bytes"], 0);
  for (const json& frame : cull["frames"]) {
    EXPECT_GE(frame["detail"]["tested"], frame["detail"]["culled"]);
  }
  // What detail objects need is told apart.
  const json without = culledCity({"--occluders", "database"});
  EXPECT_GT(without["database"]["build_us"], 0.0);
  EXPECT_EQ(without["database"]["bytes"], cull["database"]["bytes"]);
  EXPECT_FALSE(without.contains("detail_database"));
}

TEST(MethodOptions, WithoutRoomForRelationsTheAnswerIsTheSame) {
  const auto visible = [](const json& cull) {
    std::vector<json> frames;
    for (const json& frame : cull["frames"]) {
      frames.push_back(frame["visible"]);
    }
    return frames;
  };
  const std::vector<std::string> options{"--method", "supporting-planes", "--planes", "through-box"};
  const json roomy = culledCity(options);
  for (const std::string mebibytes : {"0", "0.01"}) {
    std::vector<std::string> little = options;
    little.insert(little.end(), {"--relation-mib", mebibytes});
    EXPECT_EQ(visible(culledCity(little)), visible(roomy)) << mebibytes;
  }
}

TEST(MethodOptions, SupportingPlanesAreTheSameWithAnyThreads) {
  const std::vector<std::string> one{"cull",        kCity,         "--method", "supporting-planes",
                                     "--occluders", "database",    "--frames", "0:40:5",
                                     "--no-times",  "--json",      "-",        "--detail-objects",
                                     "on",          "--hierarchy", "kd"};
  std::vector<std::string> two = one;
  two.insert(two.end(), {"--threads", "2"});
  const Outcome first = runTool(one);
  EXPECT_EQ(first.code, 0) << first.err;
  EXPECT_EQ(first.out, runTool(two).out);
}

TEST(MethodOptions, SupportingPlanesHideNothingVisible) {
  for (const std::string scene : {"demo:city?copies=1", "demo:building?floors=2"}) {
    const json runs = toolJson({"verify",      scene,
                                "--method",    "supporting-planes",
                                "--occluders", "area-angle,database",
                                "--joint",     "on,off",
                                "--planes",    "through-eye,through-box",
                                "--hierarchy", "kd,bvh",
                                "--coherence", "on,off",
                                "--frames",    "0:400:100",
                                "--width",     "160",
                                "--height",    "90"})["runs"];
    ASSERT_EQ(runs.size(), 8u * 3u) << "coherence is of planes through boxes";
    for (const json& run : runs) {
      EXPECT_EQ(run["false_culls"], 0) << scene << " " << run["options"] << " " << run["witnesses"];
    }
  }
}

TEST(MethodOptions, WhatNeedsABakedFileSaysHowToMakeOne) {
  const std::string remedy = "--baked F.sight; make one with: sightline bake SCENE -o F.sight";
  for (const std::string command : {"cull", "verify"}) {
    for (const auto& [option, value] :
         {std::pair("--method", "visibility-octree"), {"--visible-sets", "on"}}) {
      const Outcome outcome = runTool({command, kCity, option, value});
      EXPECT_EQ(outcome.code, 2);
      EXPECT_EQ(outcome.errorLines(), 1) << outcome.err;
      EXPECT_NE(outcome.err.find(std::string(option) + " " + value + ": "), std::string::npos) << outcome.err;
      EXPECT_NE(outcome.err.find(remedy), std::string::npos) << outcome.err;
      EXPECT_EQ(outcome.out, "");
    }
  }
  expectRefused({"verify", kCity, "--method", "frustum,visibility-octree"}, remedy);
  expectRefused({"cull", kCity, "--path", "cells"}, "--baked");
  EXPECT_EQ(runTool({"cull", kCity, "--frames", "0", "--visible-sets", "off"}).code, 0);
}

TEST(MethodOptions, ABakedFileThatIsNoneIsRefused) {
  const TemporaryFolder folder;
  const std::string none = folder.file("none.sight"), text = folder.write("text.sight", "hello");
  expectRefused({"cull", kCity, "--baked", none}, none);
  expectRefused({"verify", kCity, "--baked", text}, text);
  expectRefused({"verify", kCity, "--baked", "", "--proof"}, "--baked: is empty");
  expectRefused({"check", "", kCity}, "FILE: is empty");
}

TEST(MethodOptions, BakedViewpointsLieNearThePathThatBakeWasGiven) {
  const TemporaryFolder folder;
  const std::string scene = "demo:building?floors=1";
  const std::string path = folder.write("path.json", R"({"frames":[{"eye":[10,1.7,10],"forward":[1,0,0]}]})");
  const auto viewpoints = [&](const std::vector<std::string>& options) {
    const std::string file = folder.file("building.sight");
    const Outcome baked =
        runTool(joined({"bake", scene, "-o", file, "--depth", "1", "--databases", "minimum-sets"}, options));
    EXPECT_EQ(baked.code, 0) << baked.err;
    const json cull =
        toolJson({"cull", scene, "--baked", file, "--occluders", "minimum-sets", "--frames", "0"});
    return cull["viewpoints"]["minimum-sets"];
  };
  const json near_path = viewpoints({"--viewpoint-path", path, "--viewpoint-spacing", "3"});
  EXPECT_EQ(near_path["spacing"], 3.0);
  EXPECT_LE(near_path["points"], 8) << "the corners around one viewpoint";
  EXPECT_GT(viewpoints({"--viewpoint-spacing", "20"})["points"], 8) << "all over the scene";
  expectRefused({"bake", scene, "-o", folder.file("b.sight"), "--viewpoint-path", "nothing.json"},
                "nothing.json");
}

// A baked building, made once.
class BakedMethods : public ::testing::Test {
 protected:
  static constexpr const char* kScene = "demo:building?floors=1";

  static const std::string& file() {
    static const TemporaryFolder folder;
    static const std::string made = [] {
      const std::string name = folder.file("building.sight");
      const Outcome outcome = runTool({"bake", kScene, "-o", name, "--depth", "5", "--triangle-budget", "1"});
      EXPECT_EQ(outcome.code, 0) << outcome.err;
      return name;
    }();
    return made;
  }
  static json culled(const std::vector<std::string>& options) {
    return culledQuietly({kScene, "--baked", file()}, options);
  }
};

TEST_F(BakedMethods, TheOctreeTellsOfItsSets) {
  const json cull = culled({"--method", "visibility-octree", "--frames", "0:400:50"});
  EXPECT_EQ(keysOf(cull["options"]), (std::vector<std::string>{"hierarchy", "object_boxes"}));
  for (const json& frame : cull["frames"]) {
    EXPECT_GE(frame["sets"]["nodes"], 1);
    EXPECT_GE(frame["sets"]["objects"], frame["visible"].size());
    EXPECT_GT(frame["sets"]["look_up_ns"], 0);
    EXPECT_EQ(frame["occluders"], 0);
  }
  const json without_times = culled({"--method", "visibility-octree", "--frames", "0:400:50", "--no-times"});
  for (const json& frame : without_times["frames"]) {
    EXPECT_EQ(frame["sets"]["look_up_ns"], 0);
  }
}

TEST_F(BakedMethods, VisibleSetsAreAnOptionOfTheOtherMethods) {
  const json runs =
      toolJson({"verify", kScene, "--baked", file(), "--frames", "0", "--width", "64", "--height", "36",
                "--aimed-rays", "1", "--method", "frustum,occlusion-tree,depth-pyramid,visibility-octree",
                "--visible-sets", "on,off"})["runs"];
  ASSERT_EQ(runs.size(), 1u + 2u + 2u + 1u);
  for (const json& run : runs) {
    const bool has = run["method"] == "occlusion-tree" || run["method"] == "depth-pyramid";
    EXPECT_EQ(run["options"].contains("visible_sets"), has) << run["method"];
  }
  const std::string text =
      runTool({"cull", kScene, "--baked", file(), "--frames", "0", "--visible-sets", "on"}).out;
  EXPECT_NE(text.find(", visible-sets on)"), std::string::npos) << text;
}

TEST(MethodOptions, DatabasesOfABakedFileAreNotBuiltAgain) {
  const TemporaryFolder folder;
  const std::string made = folder.file("city.sight");
  const Outcome bake = runTool({"bake", kCity, "-o", made, "--depth", "1", "--databases",
                                "area-angle,minimum-sets", "--viewpoint-spacing", "60"});
  ASSERT_EQ(bake.code, 0) << bake.err;
  // They hold the same, but that the file's minimum sets were not made for one walk.
  const std::vector<std::string> database{"--occluders", "database", "--no-times"};
  const json with = culledCity(joined(database, {"--baked", made})), built = culledCity(database);
  EXPECT_EQ(with["database"]["bytes"], built["database"]["bytes"]);
  EXPECT_EQ(with["frames"], built["frames"]);
  EXPECT_GT(
      culledCity({"--occluders", "minimum-sets", "--baked", made})["viewpoints"]["minimum-sets"]["points"],
      0);
}

TEST_F(BakedMethods, AFileOfAnotherSceneIsRefused) {
  expectRefused({"cull", kCity, "--baked", file()}, "building.sight");
}

TEST_F(BakedMethods, TheCellsAreAPath) {
  const json cull = culled({"--method", "visibility-octree", "--path", "cells"});
  EXPECT_GE(cull["frames"].size(), 8u);
  const json some = culled({"--method", "visibility-octree", "--path", "cells", "--frames", "1:8:3"});
  ASSERT_EQ(some["frames"].size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(some["frames"][i]["visible"], cull["frames"][1 + 3 * i]["visible"]);
  }
}

TEST_F(BakedMethods, HideNothingVisibleAtTheBordersOfCells) {
  const json report =
      toolJson({"verify", kScene, "--baked", file(), "--path", "cells", "--frames",
                test::sanitized() ? "0:500:20" : "0:500:10", "--width", "160", "--height", "90", "--method",
                "visibility-octree,occlusion-tree,supporting-planes,opacity-map,depth-pyramid",
                "--visible-sets", "on"});
  for (const json& run : report["runs"]) {
    EXPECT_EQ(run["false_culls"], 0) << run["method"] << " " << run["witnesses"];
  }
}

TEST(MethodOptions, BadValuesAreRefused) {
  for (const std::string option :
       {"joint", "detail-objects", "planes", "tangents", "occluders", "coherence"}) {
    for (const std::string bad : {"maybe", "", "on,", ",off"}) {
      expectRefused({"cull", kCity, "--" + option, bad}, "--" + option);
    }
  }
  expectRefused({"cull", kCity, "--occluders", "nearest"}, "area-angle, database");
  expectRefused({"cull", kCity, "--tangents", "some"}, "tables, all-vertices");
  for (const std::string option :
       {"detail-occluder-count", "database-directions", "database-occluder-count"}) {
    for (const std::string bad :
         {"0", "-1", "70000", "99999999999999999999", "1e3", "nan", "", "8x", "8,16"}) {
      expectRefused({"cull", kCity, "--" + option, bad}, "--" + option);
    }
  }
  for (const std::string option : {"relation-mib", "database-mib"}) {
    for (const std::string bad : {"-1", "nan", "inf", "1e999", "1e9", "", "x", "1,2"}) {
      expectRefused({"verify", kCity, "--" + option, bad}, "--" + option);
    }
  }
  expectRefused({"cull", kCity, "--method", "supporting-planes", "--joint", "on,off"}, "one value");
  EXPECT_EQ(runTool({"cull", kCity, "--frames", "0", "--joint", "on,off"}).code, 0)
      << "the depth pyramid has no such option";
}

TEST(MethodOptions, AGivenOptionThatNoMethodHasIsTold) {
  const Outcome outcome =
      runTool({"cull", kCity, "--frames", "0", "--method", "supporting-planes", "--variant", "FSE"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.err,
            "sightline: --variant changes nothing here: it belongs to --method occlusion-tree\n");
  const Outcome of_other_planes = runTool(
      {"cull", kCity, "--frames", "0", "--method", "supporting-planes", "--tangents", "all-vertices"});
  EXPECT_EQ(of_other_planes.code, 0);
  EXPECT_EQ(of_other_planes.err,
            "sightline: --tangents changes nothing here: it has no meaning beside the other options\n");
}

}  // namespace
}  // namespace sightline::tool_test
