// How to cull: options that belong to methods, and what comes out of them.

#include "tests/tool/run_tool.h"

namespace sightline::tool_test {
namespace {

using nlohmann::json;

const std::string kCity = "demo:city?copies=1";

json culled(std::vector<std::string> options) {
  options.insert(options.begin(), {"cull", kCity, "--frames", "0:40:10", "--json", "-"});
  const Outcome outcome = runTool(options);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  return parse(outcome.out);
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
  EXPECT_EQ(keysOf(culled({"--method", "frustum"})["options"]), (Keys{"hierarchy"}));
  EXPECT_EQ(keysOf(culled({})["options"]),
            (Keys{"area_angle", "coherence", "detail_objects", "hierarchy", "lambda_steps", "min_node_cost",
                  "occluder_count", "occluders", "test_objects", "variant"}));
  EXPECT_EQ(keysOf(culled({"--method", "supporting-planes"})["options"]),
            (Keys{"area_angle", "detail_objects", "hierarchy", "joint", "lambda_steps", "min_node_cost",
                  "occluder_count", "occluders", "planes", "test_objects"}));
  EXPECT_EQ(keysOf(culled({"--method", "supporting-planes", "--planes", "through-box"})["options"]),
            (Keys{"area_angle", "coherence", "detail_objects", "hierarchy", "joint", "lambda_steps",
                  "min_node_cost", "occluder_count", "occluders", "planes", "relation_mib", "tangents",
                  "test_objects"}));
}

TEST(MethodOptions, ValuesComeBackAsTheyWereGiven) {
  const json options = culled({"--method",
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
  EXPECT_EQ(text({}), "occlusion-tree (FME, 64 occluders, bvh, coherence on");
  EXPECT_EQ(text({"--method", "frustum", "--joint", "off"}), "frustum (bvh");
  EXPECT_EQ(text({"--method", "supporting-planes"}), "supporting-planes (64 occluders, bvh");
  EXPECT_EQ(text({"--method", "supporting-planes", "--joint", "off", "--occluders", "database"}),
            "supporting-planes (64 occluders, bvh, occluders database, joint off");
}

TEST(MethodOptions, AnOptionMultipliesOnlyTheMethodsThatHaveIt) {
  const Outcome outcome =
      runTool({"verify",       kCity,     "--frames",         "0",
               "--width",      "64",      "--height",         "36",
               "--aimed-rays", "1",       "--method",         "frustum,occlusion-tree,supporting-planes",
               "--variant",    "FSE,FME", "--occluders",      "area-angle,database",
               "--joint",      "on,off",  "--detail-objects", "on,off",
               "--json",       "-"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const json runs = parse(outcome.out)["runs"];
  EXPECT_EQ(runs.size(), 1u + 2u * 2u * 2u + 2u * 2u * 2u);
  for (const json& run : runs) {
    EXPECT_EQ(run["options"].contains("joint"), run["method"] == "supporting-planes");
    EXPECT_EQ(run["options"].contains("variant"), run["method"] == "occlusion-tree");
  }
}

TEST(MethodOptions, FramesTellOfRelationsWhereTheyAreKept) {
  const json cull = culled({"--method", "supporting-planes", "--planes", "through-box"});
  EXPECT_FALSE(cull.contains("database"));
  for (const json& frame : cull["frames"]) {
    for (const std::string key : {"reused", "unchanged", "rebuilt", "evicted", "dropped", "kept", "bytes"}) {
      EXPECT_TRUE(frame["relations"][key].is_number_unsigned()) << key;
    }
    EXPECT_GT(frame["nodes_tested_share"], 0.0);
    EXPECT_LE(frame["nodes_tested_share"], 1.0);
    EXPECT_FALSE(frame.contains("detail"));
  }
  EXPECT_GT(cull["frames"].back()["relations"]["reused"], 0);
  for (const std::string method : {"occlusion-tree", "supporting-planes"}) {
    const json without = culled({"--method", method});
    for (const json& frame : without["frames"]) {
      EXPECT_FALSE(frame.contains("relations"));
      EXPECT_TRUE(frame.contains("nodes_tested_share"));
    }
  }
}

TEST(MethodOptions, TheDatabaseIsToldOfWhereItIsUsed) {
  const json cull = culled({"--occluders", "database", "--detail-objects", "on", "--no-times"});
  EXPECT_GT(cull["database"]["cells"], 0);
  EXPECT_EQ(cull["database"]["directions"], 32);
  EXPECT_GT(cull["database"]["bytes"], 0);
  EXPECT_EQ(cull["database"]["build_us"], 0.0);
  EXPECT_GT(cull["detail_database"]["bytes"], 0);
  for (const json& frame : cull["frames"]) {
    EXPECT_GE(frame["detail"]["tested"], frame["detail"]["culled"]);
  }
  // What detail objects need is told apart.
  const json without = culled({"--occluders", "database"});
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
  const json roomy = culled(options);
  for (const std::string mebibytes : {"0", "0.01"}) {
    std::vector<std::string> little = options;
    little.insert(little.end(), {"--relation-mib", mebibytes});
    EXPECT_EQ(visible(culled(little)), visible(roomy)) << mebibytes;
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
    const Outcome outcome = runTool({"verify",      scene,
                                     "--method",    "supporting-planes",
                                     "--occluders", "area-angle,database",
                                     "--joint",     "on,off",
                                     "--planes",    "through-eye,through-box",
                                     "--hierarchy", "kd,bvh",
                                     "--coherence", "on,off",
                                     "--frames",    "0:400:25",
                                     "--width",     "640",
                                     "--height",    "360",
                                     "--json",      "-"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const json runs = parse(outcome.out)["runs"];
    ASSERT_EQ(runs.size(), 8u * 3u) << "coherence is of planes through boxes";
    for (const json& run : runs) {
      EXPECT_EQ(run["false_culls"], 0) << scene << " " << run["options"] << " " << run["witnesses"];
    }
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
      << "the occlusion tree has no such option";
}

TEST(MethodOptions, AGivenOptionThatNoMethodHasIsTold) {
  const Outcome outcome =
      runTool({"cull", kCity, "--frames", "0", "--method", "supporting-planes", "--variant", "FSE"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_NE(outcome.err.find("--variant changes nothing here"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace sightline::tool_test
