// The stable JSON forms.

#include "tests/tool/run_tool.h"

namespace sightline::tool_test {
namespace {

using nlohmann::json;

json jsonOf(const std::vector<std::string>& arguments, int code = 0) {
  const Outcome outcome = runTool(joined(arguments, {"--json", "-"}));
  EXPECT_EQ(outcome.err, "");
  return printedJson(outcome, code);
}

void expectKeys(const json& object, const std::vector<std::string>& keys) {
  for (const std::string& key : keys) {
    EXPECT_TRUE(object.contains(key)) << key << " in " << object.dump().substr(0, 200);
  }
}

TEST(Tool, InfoCountsAddUp) {
  const json info = jsonOf({"info", kCity});
  expectKeys(info, {"objects", "triangles", "occluders", "hierarchies", "materials", "min", "max", "origin",
                    "paths"});
  std::uint64_t triangles = 0, id = 0, explained = 0;
  for (const json& object : info["objects"]) {
    expectKeys(object, {"id", "name", "triangles", "min", "max"});
    EXPECT_EQ(object["id"], id++);
    EXPECT_EQ(object["min"].size(), 3u);
    triangles += object["triangles"].get<std::uint64_t>();
  }
  EXPECT_EQ(info["triangles"], triangles);
  EXPECT_EQ(info["scene"]["objects"], id);
  for (const auto& [reason, count] : info["occluders"]["triangles"].items()) {
    explained += count.get<std::uint64_t>();
  }
  EXPECT_EQ(explained, triangles) << "every triangle is in an occluder or there is a reason";
  EXPECT_GT(info["occluders"]["count"], 0);
  EXPECT_GT(info["occluders"]["area"], 0.0);
  for (const std::string kind : {"kd", "bvh"}) {
    const json& hierarchy = info["hierarchies"][kind];
    expectKeys(hierarchy, {"nodes", "leaves", "depth", "duplicates", "bytes_per_node", "bytes_per_object"});
    EXPECT_LE(hierarchy["bytes_per_node"], 32);
    EXPECT_LE(hierarchy["bytes_per_object"], 64);
  }
  EXPECT_EQ(info["hierarchies"]["bvh"]["duplicates"], 0);
  const std::size_t several = info["object_boxes"]["objects"], boxes = info["object_boxes"]["boxes"];
  EXPECT_GT(several, 0u);
  EXPECT_LE(several, id);
  EXPECT_GE(boxes, 2 * several);
  EXPECT_LE(boxes, 8 * several);
}

TEST(Tool, CullListsVisibleObjectsAscending) {
  for (const std::string method : {"frustum", "supporting-planes", "occlusion-tree"}) {
    const json cull = jsonOf({"cull", kCity, "--method", method, "--frames", "0:400:80"});
    expectKeys(cull, {"scene", "method", "options", "frames"});
    expectKeys(cull["scene"], {"objects", "triangles"});
    EXPECT_EQ(cull["method"], method);
    ASSERT_EQ(cull["frames"].size(), 5u);
    for (const json& frame : cull["frames"]) {
      expectKeys(frame, {"visible", "cull_us", "nodes_tested", "occluders"});
      const auto visible = frame["visible"].get<std::vector<std::uint32_t>>();
      EXPECT_FALSE(visible.empty());
      EXPECT_TRUE(std::is_sorted(visible.begin(), visible.end()));
      EXPECT_EQ(std::adjacent_find(visible.begin(), visible.end()), visible.end());
      EXPECT_LT(visible.back(), cull["scene"]["objects"]);
      EXPECT_GT(frame["cull_us"], 0.0);
    }
  }
}

TEST(Tool, OcclusionCullingKeepsASubsetOfFrustumCulling) {
  const json all = jsonOf({"cull", kCity, "--method", "frustum", "--frames", "0:400:40"});
  const json fewer = jsonOf({"cull", kCity, "--frames", "0:400:40"});
  for (std::size_t i = 0; i < all["frames"].size(); ++i) {
    const auto frustum = all["frames"][i]["visible"].get<std::vector<int>>(),
               kept = fewer["frames"][i]["visible"].get<std::vector<int>>();
    EXPECT_TRUE(std::includes(frustum.begin(), frustum.end(), kept.begin(), kept.end())) << "frame " << i;
  }
}

TEST(Tool, CullIsTheSameBitForBitInEveryRunAndWithAnyThreads) {
  const std::vector<std::string> arguments = {
      "cull", "demo:city?copies=2", "--frames", "0:60", "--no-times", "--json", "-"};
  std::vector<std::string> two_threads = arguments;
  two_threads.insert(two_threads.end(), {"--threads", "2"});
  const Outcome first = runTool(arguments);
  EXPECT_EQ(first.code, 0) << first.err;
  EXPECT_EQ(first.out, runTool(arguments).out);
  EXPECT_EQ(first.out, runTool(two_threads).out);
  EXPECT_EQ(parse(first.out)["frames"][0]["cull_us"], 0.0);
}

const std::vector<std::string> kFewRays = {"--width",      "160", "--height", "90",
                                           "--aimed-rays", "4",   "--frames", "0:400:100"};

std::vector<std::string> withFewRays(std::vector<std::string> arguments) {
  arguments.insert(arguments.end(), kFewRays.begin(), kFewRays.end());
  return arguments;
}

TEST(Tool, VerifyOfOneSettingHasThePlainForm) {
  const json verify = jsonOf(withFewRays({"verify", kCity}));
  expectKeys(verify, {"false_culls", "proved", "undecided", "frames", "overestimate", "overestimate_at_least",
                      "method", "options"});
  EXPECT_EQ(verify["false_culls"], 0);
  const std::uint64_t objects = jsonOf({"info", kCity})["scene"]["objects"];
  double kept = 0.0, exact = 0.0;
  for (const json& frame : verify["frames"]) {
    expectKeys(frame, {"culled", "kept", "exact", "exact_at_most", "proved", "undecided"});
    EXPECT_EQ(frame["proved"].get<std::uint64_t>() + frame["undecided"].get<std::uint64_t>(),
              frame["culled"].get<std::uint64_t>());
    EXPECT_EQ(frame["culled"].get<std::uint64_t>() + frame["kept"].get<std::uint64_t>(), objects);
    EXPECT_LE(frame["exact"], frame["kept"]);
    kept += frame["kept"].get<double>();
    exact += frame["exact"].get<double>();
  }
  EXPECT_DOUBLE_EQ(verify["overestimate"], kept / exact);
}

TEST(Tool, VerifyOfSeveralSettingsHasARunForEach) {
  const json verify =
      jsonOf(withFewRays({"verify", kCity, "--method", "frustum,occlusion-tree", "--variant", "FSE,FMC",
                          "--occluder-count", "8,32", "--hierarchy", "kd,bvh", "--coherence", "on,off"}));
  ASSERT_EQ(verify["runs"].size(), 2u + 16u)
      << "options of the occlusion tree do not multiply the frustum's runs";
  for (const json& run : verify["runs"]) {
    expectKeys(run, {"method", "options", "false_culls", "frames", "overestimate"});
    EXPECT_EQ(run["frames"].size(), 4u);
    EXPECT_GE(run["overestimate"], 1.0);
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_EQ(run["frames"][i]["exact"], verify["runs"][0]["frames"][i]["exact"]);
    }
  }
  EXPECT_EQ(verify["runs"][2]["options"]["variant"], "FSE");
}

TEST(Tool, VerifyIsTheSameWithAnyThreads) {
  const std::vector<std::string> one = withFewRays({"verify", kCity, "--json", "-"});
  std::vector<std::string> two = one;
  two.insert(two.end(), {"--threads", "2"});
  EXPECT_EQ(runTool(one).out, runTool(two).out);
}

TEST(Tool, NothingVisibleIsEverCulled) {
  for (const std::string scene : {"demo:city?copies=1", "demo:building?floors=2"}) {
    const json verify = jsonOf({"verify", scene, "--method", "occlusion-tree", "--variant", "FSE,FSC,FME,FMC",
                                "--hierarchy", "kd,bvh", "--coherence", "on,off", "--frames", "0:400:100",
                                "--width", "160", "--height", "90"});
    ASSERT_EQ(verify["runs"].size(), 16u);
    for (const json& run : verify["runs"]) {
      EXPECT_EQ(run["false_culls"], 0) << scene << " " << run["options"] << " " << run["witnesses"];
    }
  }
}

}  // namespace
}  // namespace sightline::tool_test
