// sightline layers --depth-of-field, --motion-blur: pictures, figures, and what is refused.

#include <utility>

#include "tests/support/pictures.h"
#include "tests/tool/run_tool.h"

namespace sightline::tool_test {
namespace {

using nlohmann::json;

class LayerLens : public ::testing::Test {
 protected:
  void SetUp() override { SIGHTLINE_SKIP_WITHOUT_PICTURES(); }

  // The JSON for one frame of a small picture, unless `more` says otherwise.
  json drawn(const std::vector<std::string>& more) const {
    return toolJson(
        joined({"layers", "demo:toothpicks?n=40", "--width", "160", "--height", "120", "--samples", "2"},
               more))["frames"];
  }
  json lens(const std::vector<std::string>& more) const {
    return drawn(joined(more, {"--frames", "20", "--compare", folder_.file("compare.png")}))[0]["lens"];
  }
  static double rms(const json& lens) { return lens["compare"]["difference"]["rms"]; }

  TemporaryFolder folder_;
};

TEST_F(LayerLens, LayersAreNearerToTheReferenceThanSingleImages) {
  const auto by = [&](const char* method) {
    return lens({"--focus", "2.2", "--aperture", "0.15", "--depth-of-field", method});
  };
  const json layers = by("layers");
  EXPECT_EQ(layers["method"], "layers");
  EXPECT_EQ(layers["focus"], 2.2);
  EXPECT_EQ(layers["compare"]["passes"], 64);
  EXPECT_LT(rms(layers), rms(by("potmesil")));
  EXPECT_LT(rms(layers), rms(by("rokita")));
  EXPECT_EQ(layers["layers"]["drawn"], layers["layers"]["even"].get<int>() +
                                           layers["layers"]["depth"].get<int>() +
                                           layers["layers"]["accumulate"].get<int>());
}

TEST_F(LayerLens, AccumulationWithAsManyPassesIsTheReference) {
  const json accumulated = lens({"--depth-of-field", "accumulation", "--focus", "2", "--aperture", "0.1",
                                 "--passes", "7", "--reference-passes", "7"});
  EXPECT_EQ(accumulated["render_passes"], 7);
  EXPECT_EQ(rms(accumulated), 0.0);
}

TEST_F(LayerLens, LayersAreBlurredAsTheUserChooses) {
  const std::vector<std::string> arguments{"--depth-of-field", "layers", "--focus", "1.9",
                                           "--aperture",       "0.05"};
  const json automatic = lens(arguments);
  const json chosen = lens(
      joined(arguments, {"--blur-layer", "40=accumulate", "--blur-layer", "41=accumulate", "--passes", "5"}));
  // Parts from 40 on are the cube's spheres, small and each a layer of its own or with a neighbour.
  EXPECT_GE(chosen["layers"]["accumulate"], 1);
  EXPECT_LT(chosen["layers"]["even"], automatic["layers"]["even"]);
  EXPECT_GE(chosen["render_passes"].get<int>(), automatic["render_passes"].get<int>() + 5);
}

TEST_F(LayerLens, MotionIsBlurredByLayersOrInTime) {
  const json layers = lens({"--motion-blur", "1"});
  EXPECT_EQ(layers["method"], "layers");
  EXPECT_EQ(layers["aperture"], 0.0);
  EXPECT_GT(layers["layers"]["moved"], 20);
  EXPECT_GT(rms(layers), 0.0);
  const json in_time =
      lens({"--motion-blur", "1", "--depth-of-field", "accumulation", "--focus", "2", "--aperture", "0"});
  EXPECT_LT(rms(in_time), rms(layers));
}

TEST_F(LayerLens, OfSeveralFramesEachHasItsFiles) {
  const json frames =
      drawn({"--frames", "248:250", "--motion-blur", "0.5", "--blurred", folder_.file("a.png"), "--compare",
             folder_.file("b.png"), "--reference-passes", "2"});
  ASSERT_EQ(frames.size(), 2u);
  for (const auto& [i, number] : {std::pair{0u, "0248"}, {1u, "0249"}}) {
    const std::string blurred = folder_.file(std::string("a_") + number + ".png");
    EXPECT_EQ(frames[i]["lens"]["file"], blurred);
    EXPECT_GT(contents(blurred).size(), 100u);
    // Three pictures beside each other, of which one is the other's.
    EXPECT_GT(contents(frames[i]["lens"]["compare"]["file"]).size(), contents(blurred).size());
  }
}

TEST_F(LayerLens, BadUsageIsRefused) {
  const auto refused = [this](const std::vector<std::string>& more, const std::string& about) {
    expectRefused(joined({"layers", "demo:toothpicks?n=5", "--frames", "0"}, more), about);
    EXPECT_EQ(folder_.entries(), 0u);
  };
  const std::string file = folder_.file("x.png");
  refused({"--depth-of-field", "blur", "--focus", "1", "--aperture", "0.1", "--blurred", file},
          "--depth-of-field");
  refused({"--depth-of-field", "layers", "--blurred", file}, "--focus");
  refused({"--focus", "2", "--blurred", file}, "--depth-of-field");
  refused({"--depth-of-field", "layers", "--focus", "1", "--aperture", "0.1"}, "--blurred");
  refused({"--depth-of-field", "layers", "--focus", "0", "--aperture", "0.1", "--blurred", file}, "--focus");
  refused({"--depth-of-field", "layers", "--focus", "1", "--aperture", "-1", "--blurred", file},
          "--aperture");
  refused({"--motion-blur", "1.5", "--blurred", file}, "--motion-blur");
  refused({"--motion-blur", "1", "--passes", "0", "--blurred", file}, "--passes");
  refused({"--passes", "9"}, "--passes");
  refused({"--motion-blur", "1", "--blur-layer", "1=even", "--blur-layer", "1=depth", "--blurred", file},
          "named twice");
  refused({"--motion-blur", "1", "--blurred", folder_.file("x.jpg")}, ".png");
  refused({"--motion-blur", "1", "--blurred", file, "--compare", file}, "--compare");
  refused({"--motion-blur", "1", "--blurred", file, "--blur-layer", "3=soft"}, "3=soft");
  refused({"--motion-blur", "1", "--blurred", file, "--blur-layer", "25=even"}, "no such part");
  refused({"--motion-blur", "1", "--depth-of-field", "potmesil", "--focus", "1", "--aperture", "0.1",
           "--blurred", file},
          "--motion-blur");
  refused({"--blurred", file}, "--depth-of-field");
}

}  // namespace
}  // namespace sightline::tool_test
