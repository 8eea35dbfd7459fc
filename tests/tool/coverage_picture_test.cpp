// Pictures of what a depth buffer of occluders covers: their pixels, and where walk writes them.

#include "tools/sightline/walk/coverage_picture.h"

#include <set>

#include "tests/tool/run_tool.h"
#include "tools/sightline/report/depth_legend.h"

namespace sightline::tool_test {
namespace {

using namespace tool;

constexpr float kNone = kUncovered;

DepthColor pixelOf(const Image& image, std::uint32_t x, std::uint32_t y) {
  const std::uint8_t* pixel = &image.rgba[4 * (std::size_t{y} * image.width + x)];
  EXPECT_EQ(pixel[3], 255);
  return {pixel[0], pixel[1], pixel[2]};
}

// Perceived brightness, 0 to 255.
double brightness(const DepthColor& color) {
  return 0.2126 * color[0] + 0.7152 * color[1] + 0.0722 * color[2];
}

TEST(CoveragePicture, CountsPixelsAndTurnsTheLowestRowToTheBottom) {
  const KeptDepthBuffer buffer{3, 2, {0.5f, kNone, 0.1f, kNone, 0.25f, kNone}};
  const CoverageMap map = coverageMap(buffer, {}, CoveredBy::kSurface, false);
  const CoveredBy none = CoveredBy::kNothing, surface = CoveredBy::kSurface;
  EXPECT_EQ(map.covered_by, (std::vector<CoveredBy>{none, surface, none, surface, none, surface}));
  EXPECT_EQ(map.by_surfaces, 3u);
  EXPECT_EQ(map.by_occluders, 0u);
  EXPECT_EQ(map.share(), 0.5);
  EXPECT_EQ(map.metres[1], 4.0);
  EXPECT_EQ(map.scale.nearest, 2.0);
  EXPECT_NEAR(map.scale.farthest, 10.0, 1e-5);
}

TEST(CoveragePicture, TheDepthOfAnOrthographicPixelIsItsDistanceItself) {
  const CoverageMap map = coverageMap({2, 1, {-3.0f, -12.0f}}, {}, CoveredBy::kSurface, true);
  EXPECT_EQ(map.metres, (std::vector<double>{3.0, 12.0}));
}

TEST(CoveragePicture, OnlyWhatIsNearerThanTheOccludersIsTheSurfaces) {
  const KeptDepthBuffer both{4, 1, {0.5f, 0.25f, 0.125f, kNone}},
      occluders{4, 1, {0.25f, 0.25f, kNone, kNone}};
  const CoverageMap map = coverageMap(both, occluders, CoveredBy::kSurface, false);
  EXPECT_EQ(map.covered_by, (std::vector<CoveredBy>{CoveredBy::kSurface, CoveredBy::kOccluder,
                                                    CoveredBy::kSurface, CoveredBy::kNothing}));
  EXPECT_EQ(map.by_occluders, 1u);
}

TEST(CoveragePicture, EveryPixelOfTheMapIsARectangleOfOneColour) {
  const CoverageMap map = coverageMap({4, 2, {0.5f, kNone, 0.1f, kNone, 0.25f, kNone, 0.5f, 0.4f}}, {},
                                      CoveredBy::kSurface, false);
  for (const double aspect : {2.0, 1.0}) {
    const Image image = coverageImage(map, aspect, 30);
    EXPECT_EQ(image.width, 32u) << "four pixels, eight wide";
    const std::uint32_t high = aspect == 2.0 ? 8 : 16;
    ASSERT_GT(image.height, 2 * high) << "the legend is below the map";
    for (std::uint32_t y = 0; y < 2 * high; ++y) {
      for (std::uint32_t x = 0; x < image.width; ++x) {
        const std::size_t pixel = y / high * 4 + x / 8;
        const DepthColor color = map.covered_by[pixel] == CoveredBy::kNothing
                                     ? kUncoveredColor
                                     : colorAt(greenRamp(), map.scale.place(map.metres[pixel]));
        ASSERT_EQ(pixelOf(image, x, y), color) << x << ", " << y;
      }
    }
  }
}

TEST(CoveragePicture, OneThatCoversNothingHasNoLegend) {
  const CoverageMap map = coverageMap({2, 2, {kNone, kNone, kNone, kNone}}, {}, CoveredBy::kSurface, false);
  EXPECT_EQ(map.covered(), 0u);
  const Image image = coverageImage(map, 1.0, 2);
  EXPECT_EQ(image.height, 2u);
  EXPECT_EQ(pixelOf(image, 1, 1), kUncoveredColor);
}

TEST(DepthColors, GetDarkerFromNearToFarInBothRamps) {
  for (const auto ramp : {greenRamp(), redRamp()}) {
    EXPECT_EQ(colorAt(ramp, -1.0), ramp.front());
    EXPECT_EQ(colorAt(ramp, 2.0), ramp.back());
    for (int i = 0; i < 64; ++i) {
      EXPECT_GT(brightness(colorAt(ramp, i / 64.0)), brightness(colorAt(ramp, (i + 1) / 64.0))) << i;
    }
    EXPECT_GT(brightness(kUncoveredColor), brightness(ramp.front()) + 8.0);
  }
}

TEST(DepthColors, EqualRatiosOfDepthsAreEquallyFarApart) {
  const DepthScale scale{2.0, 32.0};
  for (const auto& [metres, place] :
       {std::pair{1.0, 0.0}, {2.0, 0.0}, {4.0, 0.25}, {8.0, 0.5}, {32.0, 1.0}, {1e9, 1.0}}) {
    EXPECT_NEAR(scale.place(metres), place, 1e-12);
  }
  const std::vector<double> ticks = ticksOf({0.15, 60.0});
  EXPECT_EQ(std::set<double>(ticks.begin(), ticks.end()).size(), ticks.size());
  EXPECT_EQ(ticks.size(), 8u) << "0.2, 0.5, 1, 2, 5, 10, 20, 50";
  EXPECT_EQ(ticks.front(), 1.0) << "the roundest first";
}

TEST(DepthLegend, DepthsHaveTwoOrThreeDigits) {
  for (const auto& [metres, text] : {std::pair{0.346, "0.35 m"},
                                     {1.0, "1 m"},
                                     {7.26, "7.3 m"},
                                     {9.97, "10 m"},
                                     {310.4, "310 m"},
                                     {9999.4, "9999 m"},
                                     {12000.0, "12 km"}}) {
    EXPECT_EQ(depthText(metres), text);
  }
}

TEST(DepthLegend, AddsABarOfEachRampFromItsNearestToItsFarthestColour) {
  const Image picture{480, 1, std::vector<std::uint8_t>(480 * 4, 7)};
  const std::vector<std::span<const DepthColor>> both{greenRamp(), redRamp()};
  const Image one = withDepthLegend(picture, {1.0, 100.0}, std::span(both).first(1));
  const Image two = withDepthLegend(picture, {1.0, 100.0}, both);
  EXPECT_EQ(one.width, 480u);
  EXPECT_GT(two.height, one.height);
  for (const Image* image : {&one, &two}) {
    EXPECT_TRUE(std::equal(picture.rgba.begin(), picture.rgba.end(), image->rgba.begin()));
    std::set<DepthColor> colors;
    for (std::uint32_t y = 1; y < image->height; ++y) {
      for (std::uint32_t x = 0; x < image->width; ++x) {
        colors.insert(pixelOf(*image, x, y));
      }
    }
    EXPECT_EQ(colors.count(greenRamp().front()) + colors.count(greenRamp().back()), 2u);
    EXPECT_EQ(colors.count(redRamp().front()) + colors.count(redRamp().back()), image == &two ? 2u : 0u);
  }
}

// A wall 10 metres before the eye. Of 64 x 64 pixels it covers the columns 16 to 47 of the lower half, and a
// third of a pixel on each side, which is not enough to cover more.
constexpr const char* kWall = R"(o wall
v -5.1 -20 -10
v 5.1 -20 -10
v 5.1 0.1 -10
v -5.1 0.1 -10
f 1 2 3
f 1 3 4
o behind
v -1 -2 -20
v 1 -2 -20
v 0 -1 -20
f 5 6 7
)";
constexpr const char* kPath = R"({"fovy_deg":90,"width":64,"height":64,"near":0.1,"far":100,
 "frames":[{"eye":[0,0,0],"forward":[0,0,-1],"up":[0,1,0]}]})";

class WalkWithoutPictures : public ::testing::Test {
 protected:
  Outcome walk(const std::vector<std::string>& method) const {
    return runTool(joined({"walk", folder_.write("wall.obj", kWall), "--path",
                           folder_.write("path.json", kPath), "--no-pictures", "-o", report_},
                          method));
  }
  std::string html() const { return contents(report_ + "/index.html"); }

  TemporaryFolder folder_;
  std::string report_ = folder_.file("report");
};

TEST_F(WalkWithoutPictures, TheCoverageMapShowsAWallWhereItIs) {
  for (const std::string method : {"depth-pyramid", "opacity-map"}) {
    for (const std::string surfaces : {"alone", "none", "with-occluders"}) {
      const std::string what = method + ", " + surfaces;
      const Outcome outcome = walk({"--method", method, "--surfaces", surfaces, "--resolution", "64x64"});
      ASSERT_EQ(outcome.code, 0) << what << outcome.err;
      const Result<Image> image = readPng(report_ + "/coverage_0000.png");
      ASSERT_TRUE(image) << what;
      ASSERT_EQ(image->width, 960u) << what;
      ASSERT_GT(image->height, 960u) << what;
      for (std::uint32_t y = 0; y < 64; ++y) {
        for (std::uint32_t x = 0; x < 64; ++x) {
          const bool wall = y >= 32 && x >= 16 && x < 48;
          ASSERT_EQ(pixelOf(*image, 15 * x + 7, 15 * y + 7) != kUncoveredColor, wall)
              << what << ", pixel " << x << ", " << y;
        }
      }
      const DepthColor color = pixelOf(*image, 480, 720);
      EXPECT_EQ(color[2] > 100, surfaces != "alone") << what << ": cream for near occluders, not yellow";
      EXPECT_NE(html().find("coverage_0000.png"), std::string::npos) << what;
      EXPECT_NE(html().find("1,024 of 4,096 pixels"), std::string::npos) << what;
    }
  }
}

TEST_F(WalkWithoutPictures, AMethodWithoutADepthBufferHasNoCoverageMap) {
  ASSERT_EQ(walk({"--method", "occlusion-tree"}).code, 0);
  EXPECT_FALSE(std::filesystem::exists(report_ + "/coverage_0000.png"));
  EXPECT_EQ(html().find("Coverage map,"), std::string::npos);
}

TEST_F(WalkWithoutPictures, NothingIsDrawnNorSaidToBeEqual) {
  const Outcome outcome = walk({"--method", "depth-pyramid"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  for (const std::string picture : {"frame", "plan"}) {
    EXPECT_FALSE(std::filesystem::exists(report_ + "/" + picture + "_0000.png")) << picture;
  }
  EXPECT_FALSE(std::filesystem::exists(report_ + "/frame_time.svg"));
  EXPECT_NE(contents(report_ + "/cull_time.svg").find("Cull time"), std::string::npos);
  EXPECT_EQ(html().find("equal"), std::string::npos);
  EXPECT_EQ(html().find("the frame rate of"), std::string::npos);
  const nlohmann::json result = parse(contents(report_ + "/walk.json"));
  EXPECT_EQ(result["device"], "");
  EXPECT_FALSE(result.contains("differing_frames"));
  for (const nlohmann::json& run : result["runs"]) {
    EXPECT_FALSE(run.contains("tie_frames"));
    for (const char* key : {"draw_us", "frame_us", "speed_up"}) {
      EXPECT_FALSE(run["mean"].contains(key)) << key;
    }
    for (const char* key : {"draw_us", "differs", "tie"}) {
      EXPECT_FALSE(run["frames"][0].contains(key)) << key;
    }
  }
  EXPECT_EQ(result["runs"][1]["frames"][0]["triangles"], 2) << "what is behind the wall is hidden";
}

TEST_F(WalkWithoutPictures, AWalkThatFindsNoOpenGlNamesTheOption) {
  const Outcome outcome = runProgram("env", {"__EGL_VENDOR_LIBRARY_DIRS=/nowhere", toolFile(), "walk",
                                             "demo:glass", "--frames", "0", "-o", report_});
  // Only libglvnd reads this variable; with another loader of OpenGL there is nothing to test.
  if (outcome.code == 0) {
    GTEST_SKIP() << "the variable does not hide this machine's OpenGL";
  }
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(outcome.errorLines(), 1);
  EXPECT_NE(outcome.err.find("--no-pictures"), std::string::npos) << outcome.err;
  EXPECT_FALSE(std::filesystem::exists(report_));
}

}  // namespace
}  // namespace sightline::tool_test
