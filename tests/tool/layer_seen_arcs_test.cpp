// sightline layers --arcs seen.

#include <algorithm>
#include <string>
#include <vector>

#include "tests/support/pictures.h"
#include "tests/tool/run_tool.h"

namespace sightline::tool_test {
namespace {

using nlohmann::json;

class LayerSeenArcs : public ::testing::Test {
 protected:
  void SetUp() override { SIGHTLINE_SKIP_WITHOUT_PICTURES(); }

  // The JSON of one frame, sorted by these arcs and drawn.
  json draw(const std::string& scene, const std::string& arcs) const {
    return toolJson({"layers", scene, "--width", "160", "--height", "90", "--frames", "60", "--parts", "all",
                     "--tints", "off", "--arcs", arcs, "--image", folder_.file("out.png"),
                     "--no-times"})["frames"][0];
  }
  Outcome refusal(const std::vector<std::string>& more) const {
    return runTool(joined({"layers", "demo:glass", "--frames", "60", "--arcs", "seen"}, more));
  }

  TemporaryFolder folder_;
};

std::size_t largestGroup(const json& frame) {
  std::size_t largest = 0;
  for (const json& group : frame["order"]) {
    largest = std::max(largest, group.size());
  }
  return largest;
}

// The depth buffer, which draws all objects at once, knows nothing of arcs.
TEST_F(LayerSeenArcs, TheirOrderMakesTheDepthBuffersPicture) {
  for (const std::string scene : {"demo:canyon?grid=5", "demo:glass"}) {
    const json difference = draw(scene, "seen")["picture"]["difference"];
    EXPECT_LE(difference["largest"], 1.0) << scene;
    EXPECT_EQ(difference["share_beyond"], 0.0) << scene;
  }
}

TEST_F(LayerSeenArcs, GroupsOfOpaquePartsAreSmallerThanThoseOfHulls) {
  const json hulls = draw("demo:canyon?grid=5", "all"), seen = draw("demo:canyon?grid=5", "seen");
  EXPECT_LT(largestGroup(seen), largestGroup(hulls));
  EXPECT_LT(seen["arcs"].size(), hulls["arcs"].size());
}

TEST_F(LayerSeenArcs, EveryArcIsOneOfTheHulls) {
  const json hulls = draw("demo:glass", "all")["arcs"], seen = draw("demo:glass", "seen")["arcs"];
  ASSERT_FALSE(seen.empty());
  for (const json& arc : seen) {
    EXPECT_NE(std::find(hulls.begin(), hulls.end(), arc), hulls.end()) << arc.dump();
  }
}

TEST_F(LayerSeenArcs, WhatNeedsMoreThanOnePicturesPixelsIsRefused) {
  for (const std::vector<std::string>& more :
       {std::vector<std::string>{"--svg", folder_.file("a.svg"), "--image", folder_.file("a.png")},
        {"--svg", folder_.file("a.svg"), "--plot"},
        {"--stereo", "0.06"},
        {"--order-for", "lens"}}) {
    const Outcome outcome = refusal(more);
    EXPECT_NE(outcome.code, 0);
    EXPECT_NE(outcome.err.find("--arcs seen"), std::string::npos) << outcome.err;
  }
  EXPECT_NE(refusal({"--parts", "see-through"}).code, 0);
}

}  // namespace
}  // namespace sightline::tool_test
