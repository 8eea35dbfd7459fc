// Paths whose views are off-centre.

#include "tests/tool/run_tool.h"

namespace sightline::tool_test {
namespace {

using nlohmann::json;

std::string pathThroughTheCity(const std::string& more) {
  return R"({"fovy_deg":50,"width":160,"height":90,"near":0.1,"far":2000)" + more +
         R"(,"frames":[{"eye":[0,2,0],"forward":[0,0,-1]},{"eye":[5,30,20],"forward":[1,-0.3,0.5]}]})";
}

TEST(Tool, VerifyFindsNoFalseCullInOffCentreViews) {
  const TemporaryFolder folder;
  std::vector<std::uint64_t> culled;
  for (const std::string shift :
       {"", ",\"shift\":[0.6,-0.4]", ",\"shift\":[-2.5,0.5]", ",\"ortho_height\":40,\"shift\":[1,1]"}) {
    const std::string path = folder.write("walk.json", pathThroughTheCity(shift));
    const json verify = toolJson({"verify", "demo:city?copies=1", "--path", path, "--method",
                                  "frustum,supporting-planes,occlusion-tree,opacity-map,depth-pyramid",
                                  "--width", "160", "--height", "90", "--aimed-rays", "4"});
    ASSERT_EQ(verify["runs"].size(), 5u);
    for (const json& run : verify["runs"]) {
      EXPECT_EQ(run["false_culls"], 0) << shift << run["method"];
    }
    culled.push_back(verify["runs"][0]["frames"][0]["culled"].get<std::uint64_t>());
  }
  EXPECT_NE(culled[0], culled[1]) << "the frustum is another";
  EXPECT_NE(culled[1], culled[2]);
}

}  // namespace
}  // namespace sightline::tool_test
