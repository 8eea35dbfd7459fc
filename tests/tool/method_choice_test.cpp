// --method auto: what its rules choose, and that every output says so.

#include "tools/sightline/methods/method_choice.h"
#include "tests/tool/formats_page.h"
#include "tests/tool/run_tool.h"

namespace sightline::tool_test {
namespace {

using nlohmann::json;
using tool::chooseMethod;
using tool::MethodChoice;
using tool::SceneFacts;

std::string optionOf(const MethodChoice& choice, const std::string& name) {
  for (const auto& [option, value] : choice.options) {
    if (option == name) {
      return value;
    }
  }
  return "";
}

json culled(const std::vector<std::string>& words) {
  return toolJson(joined({"cull", "--frames", "0:400:100", "--no-times"}, words));
}

TEST(MethodChoice, IsFrustumCullingWhereNothingCanPay) {
  EXPECT_EQ(chooseMethod({.occluder_area = 2.0, .in_frustum = 20.0}).method, "frustum");
  EXPECT_EQ(chooseMethod({.see_through = 0.95, .occluder_area = 2.0, .in_frustum = 900.0}).method, "frustum");
  EXPECT_EQ(chooseMethod({.occluder_area = 0.1, .in_frustum = 900.0}).method, "frustum");
}

TEST(MethodChoice, IsWholeSurfacesWhereThereIsSomethingToHideBehind) {
  for (const double area : {0.6, 3.0}) {
    for (const double in_frustum : {100.0, 1000.0, 5000.0}) {
      const MethodChoice choice = chooseMethod({.occluder_area = area, .in_frustum = in_frustum});
      EXPECT_EQ(choice.method, "depth-pyramid");
      EXPECT_EQ(optionOf(choice, "surfaces"), "alone");
    }
  }
}

TEST(MethodChoice, TakesBakedSetsIfThereAreAny) {
  const SceneFacts walls{.occluder_area = 3.0, .in_frustum = 100.0};
  EXPECT_EQ(optionOf(chooseMethod(walls), "visible-sets"), "");
  SceneFacts baked = walls;
  baked.baked = true;
  EXPECT_EQ(optionOf(chooseMethod(baked), "visible-sets"), "on");
}

TEST(MethodChoice, KeepsWhatTheChosenOptionsKeepAndTellsThem) {
  const json by_rules = culled({"demo:ship", "--method", "auto"});
  ASSERT_TRUE(by_rules.contains("chosen")) << by_rules.dump().substr(0, 500);
  EXPECT_EQ(by_rules["method"], "depth-pyramid");
  EXPECT_EQ(by_rules["chosen"]["by"], "auto");
  EXPECT_GT(by_rules["chosen"]["why"].get<std::string>().size(), 20u);
  const json by_name = culled({"demo:ship", "--method", "depth-pyramid", "--surfaces",
                               by_rules["options"]["surfaces"].get<std::string>()});
  EXPECT_EQ(by_rules["frames"], by_name["frames"]);
  EXPECT_EQ(by_rules["options"], by_name["options"]);
  EXPECT_FALSE(by_name.contains("chosen"));
}

TEST(MethodChoice, CountsTheSameWhateverTheThreads) {
  const json one = culled({"demo:jungle", "--method", "auto"});
  EXPECT_EQ(one, culled({"demo:jungle", "--method", "auto", "--threads", "3"}));
  EXPECT_GT(one["chosen"]["see_through_share"], 0.2);
}

TEST(MethodChoice, TheUsersOwnOptionsWin) {
  const json own = culled(
      {"demo:ship", "--method", "auto", "--surfaces", "none", "--occluder-count", "17", "--hierarchy", "kd"});
  EXPECT_EQ(own["options"]["occluder_count"], 17);
  EXPECT_EQ(own["options"]["hierarchy"], "kd");
  EXPECT_EQ(own["options"]["surfaces"], "none");
}

// The rules choose `alone` for the ship, and the default is `auto`.
TEST(MethodChoice, TheUsersOwnOptionsWinEvenIfTheyAreTheDefaults) {
  const json by_rules = culled({"demo:ship", "--method", "auto"});
  const json usual = culled({"demo:ship", "--method", "depth-pyramid"});
  ASSERT_NE(by_rules["options"]["surfaces"], usual["options"]["surfaces"]);
  const json own = culled(
      {"demo:ship", "--method", "auto", "--surfaces", usual["options"]["surfaces"].get<std::string>()});
  EXPECT_EQ(own["chosen"]["by"], "auto");
  EXPECT_EQ(own["options"], usual["options"]);
}

TEST(MethodChoice, AnOptionThatTheChosenMethodLacksIsNamed) {
  const Outcome outcome =
      runTool({"cull", "demo:glass", "--method", "auto", "--variant", "FSE", "--frames", "0"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.err,
            "sightline: --variant changes nothing here: it belongs to --method occlusion-tree\n");
  EXPECT_EQ(outcome.out.rfind("auto is frustum (", 0), 0u) << outcome.out;
}

TEST(MethodChoice, WalkAndVerifyChooseAmongOthers) {
  const TemporaryFolder folder;
  const std::string report = folder.file("report");
  const std::vector<std::string> of{"demo:building?floors=1", "--frames", "0:400:100", "--method",
                                    "occlusion-tree,auto"};
  const Outcome walked = runTool(joined(joined({"walk"}, of), {"--no-pictures", "-o", report}));
  ASSERT_EQ(walked.code, 0) << walked.err;
  EXPECT_NE(walked.out.find("auto is "), std::string::npos) << walked.out;
  const json walk = parse(contents(report + "/walk.json"));
  ASSERT_EQ(walk["runs"].size(), 3u);
  EXPECT_FALSE(walk["runs"][0].contains("chosen"));
  EXPECT_FALSE(walk["runs"][1].contains("chosen"));
  EXPECT_EQ(walk["runs"][2]["chosen"]["by"], "auto");
  expectDocumented(walk, {"walk"});
  EXPECT_NE(contents(report + "/index.html").find("--method auto is "), std::string::npos);

  const json verify = toolJson(joined(joined({"verify"}, of), {"--width", "160", "--height", "90"}));
  EXPECT_EQ(verify["runs"][1]["chosen"], walk["runs"][2]["chosen"]);
  expectDocumented(verify, {"verify"});
}

TEST(MethodChoice, BenchMeasuresMethodsByName) {
  expectRefused({"bench", "demo:glass", "--method", "auto", "--no-cache"}, "--method auto");
}

}  // namespace
}  // namespace sightline::tool_test
