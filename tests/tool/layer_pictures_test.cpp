// sightline layers --image, --by-distance.

#include <algorithm>
#include <cstdlib>
#include <string>
#include <vector>

#include "sightline/io/image.h"
#include "tests/support/pictures.h"
#include "tests/tool/run_tool.h"

namespace sightline::tool_test {
namespace {

using nlohmann::json;

std::vector<std::string> layersOf(const std::string& scene, const std::vector<std::string>& more) {
  return joined({"layers", scene, "--width", "160", "--height", "90"}, more);
}

class LayerPictures : public ::testing::Test {
 protected:
  void SetUp() override { SIGHTLINE_SKIP_WITHOUT_PICTURES(); }

  // The frames' JSON.
  json draw(const std::string& scene, const std::vector<std::string>& more) const {
    return toolJson(layersOf(scene, joined(more, {"--no-times"})))["frames"];
  }
  Image read(const std::string& name) const {
    const Result<Image> image = readPng(folder_.file(name));
    EXPECT_TRUE(image) << (image ? "" : image.error().message);
    return image ? *image : Image{};
  }

  TemporaryFolder folder_;
};

std::vector<std::string> namesOf(const json& parts) {
  std::vector<std::string> names;
  for (const json& part : parts) {
    names.push_back(part["name"]);
  }
  std::sort(names.begin(), names.end());
  return names;
}

TEST_F(LayerPictures, AFrameIsAPictureThatIsRightWithItsGroupsNamed) {
  const json frames =
      draw("demo:glass", {"--frames", "60", "--parts", "all", "--image", folder_.file("glass.png")});
  ASSERT_EQ(frames.size(), 1u);
  const json& picture = frames[0]["picture"];
  EXPECT_EQ(picture["file"], folder_.file("glass.png"));
  EXPECT_EQ(folder_.entries(), 1u);
  const Image image = read("glass.png");
  EXPECT_EQ(image.width, 160u);
  EXPECT_EQ(image.height, 90u);
  EXPECT_LE(picture["difference"]["largest"], 1.0);
  EXPECT_EQ(picture["difference"]["share_beyond"], 0.0);
  EXPECT_GT(picture["peeled"], 4);
  EXPECT_LT(picture["peeled"], picture["layers"].get<int>() / 2);
  std::vector<std::vector<std::string>> groups;
  for (const json& group : picture["without_order"]) {
    groups.push_back(namesOf(group));
  }
  const auto has = [&](const std::vector<std::string>& names) {
    return std::find(groups.begin(), groups.end(), names) != groups.end();
  };
  EXPECT_TRUE(has({"crossing 0", "crossing 1"}));
  EXPECT_TRUE(has({"pierced pane", "piercing ball"}));
  EXPECT_TRUE(has({"ring 0", "ring 1", "ring 2", "ring 3", "ring 4", "ring 5"}));
}

// Its pieces of terrain overlap in one surface.
TEST_F(LayerPictures, WithoutTintsItDoesNotMatterWhichOfTwoPiecesShowsTheirSurface) {
  const auto difference = [&](const std::string& tints) {
    return draw("demo:canyon?grid=5",
                {"--frames", "60", "--parts", "all", "--image", folder_.file(tints + ".png"), "--tints",
                 tints})[0]["picture"]["difference"];
  };
  EXPECT_GT(difference("on")["mean"], 0.01);
  EXPECT_LE(difference("off")["largest"], 1.0);
  EXPECT_NE(read("on.png"), read("off.png"));
}

TEST_F(LayerPictures, SeveralFramesAreFilesWithNumbers) {
  const json frames = draw("demo:toothpicks?n=20", {"--frames", "8:13:2", "--image",
                                                    folder_.file("sticks.v2.png"), "--samples", "2"});
  ASSERT_EQ(frames.size(), 3u);
  const std::vector<std::string> names{"sticks.v2_0008.png", "sticks.v2_0010.png", "sticks.v2_0012.png"};
  for (std::size_t i = 0; i < names.size(); ++i) {
    EXPECT_EQ(frames[i]["picture"]["file"], folder_.file(names[i]));
    EXPECT_EQ(read(names[i]).width, 160u);
  }
  EXPECT_EQ(folder_.entries(), 3u);
}

TEST_F(LayerPictures, WhatDistancesGetWrongIsCountedAndShownBeside) {
  const json frames = draw("demo:glass", {"--frames", "80", "--by-distance", folder_.file("compared.png"),
                                          "--image", folder_.file("ours.png")});
  const json& by_distance = frames[0]["picture"]["by_distance"];
  EXPECT_GE(by_distance["wrong_pairs"], 2);
  EXPECT_GT(by_distance["overlapping_pairs"], by_distance["wrong_pairs"]);
  EXPECT_LE(by_distance["pairs_without_order"], by_distance["wrong_pairs"]);
  EXPECT_GT(by_distance["difference"]["share_beyond"], 0.005);
  const Image compared = read("compared.png"), ours = read("ours.png");
  EXPECT_EQ(compared.width, 3 * 160u + 2 * 8u);
  EXPECT_EQ(compared.height, 90u);
  for (std::uint32_t y = 0; y < 90; ++y) {
    const auto row = compared.rgba.begin() + 4 * y * compared.width;
    ASSERT_TRUE(std::equal(row, row + 4 * 160, ours.rgba.begin() + 4 * y * 160)) << y;
  }
}

TEST_F(LayerPictures, OpaqueScenesHaveNoPairsToGetWrong) {
  const json frames =
      draw("demo:toothpicks?n=20", {"--frames", "0", "--by-distance", folder_.file("compared.png")});
  const json& picture = frames[0]["picture"];
  EXPECT_EQ(picture["by_distance"]["overlapping_pairs"], 0);
  EXPECT_EQ(picture["by_distance"]["difference"]["share_beyond"], 0.0);
  EXPECT_EQ(picture["peeled"], 0);
  EXPECT_FALSE(picture.contains("file"));
}

TEST_F(LayerPictures, APictureAloneSortsSeeThroughPartsAndIsTheSame) {
  const auto frame = [&](const std::string& parts) {
    std::vector<std::string> more{"--frames", "60", "--image", folder_.file(parts + ".png")};
    return draw("demo:glass", parts == "default" ? more : joined(more, {"--parts", parts}))[0];
  };
  const json all = frame("all"), see_through = frame("see-through"), chosen = frame("default");
  EXPECT_TRUE(all["depth_buffered"].is_null());
  ASSERT_TRUE(see_through["depth_buffered"].is_number());
  EXPECT_EQ(see_through["layers"], chosen["layers"]);
  EXPECT_LT(see_through["layers"].size(), all["layers"].size());
  EXPECT_LT(see_through["pair_queries"], all["pair_queries"]);
  // What needs no order is drawn together, and every part is in one layer as before.
  const auto partsOf = [](const json& layers) {
    std::vector<int> parts;
    for (const json& layer : layers) {
      parts.insert(parts.end(), layer.begin(), layer.end());
    }
    std::sort(parts.begin(), parts.end());
    return parts;
  };
  EXPECT_EQ(partsOf(see_through["layers"]), partsOf(all["layers"]));
  EXPECT_GT(see_through["layers"][see_through["depth_buffered"].get<std::size_t>()].size(), 10u);
  EXPECT_LE(see_through["picture"]["difference"]["largest"], 1.0);
  EXPECT_EQ(read("see-through.png"), read("default.png"));
}

TEST_F(LayerPictures, PartsAreLeftOutWithTheirLayers) {
  draw("demo:glass", {"--frames", "60", "--image", folder_.file("all.png")});
  const json frames =
      draw("demo:glass", {"--frames", "60", "--image", folder_.file("less.png"), "--without", "0"});
  EXPECT_EQ(frames[0]["picture"]["left_out"], json::array({0}));
  EXPECT_LE(frames[0]["picture"]["difference"]["largest"], 1.0);
  EXPECT_NE(read("all.png"), read("less.png"));
}

TEST_F(LayerPictures, APictureReplacesALayerWhereItsPartIs) {
  const Image red{
      .width = 2, .height = 2, .rgba = {255, 0, 0, 255, 255, 0, 0, 255, 255, 0, 0, 255, 255, 0, 0, 255}};
  ASSERT_TRUE(writePng(red, folder_.file("red.png")));
  // Part 1 is the back wall, behind all the rest.
  const json frames =
      draw("demo:glass?panes=0&bottles=0", {"--frames", "120", "--image", folder_.file("replaced.png"),
                                            "--replace", "1=" + folder_.file("red.png")});
  EXPECT_FALSE(frames[0]["picture"].contains("difference"));
  const Image image = read("replaced.png");
  std::size_t reds = 0;
  for (std::size_t p = 0; p < image.rgba.size(); p += 4) {
    reds += image.rgba[p] == 255 && image.rgba[p + 1] == 0 && image.rgba[p + 2] == 0 ? 1 : 0;
  }
  EXPECT_GT(reds, image.rgba.size() / 4 / 20);
  EXPECT_LT(reds, image.rgba.size() / 4 / 2);
  EXPECT_GT(image.rgba[2], image.rgba[0]);  // the sky above it, blue
}

TEST_F(LayerPictures, PixelsAreSquareWhateverThePathsSize) {
  // The path's frames are as wide as high; a picture twice as wide has the same in its middle.
  const auto drawn = [&](const char* name, const char* width) {
    const Outcome outcome = runTool({"layers", "demo:toothpicks?n=20", "--frames", "0", "--height", "80",
                                     "--width", width, "--image", folder_.file(name)});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return read(name);
  };
  const Image square = drawn("square.png", "80"), wide = drawn("wide.png", "160");
  ASSERT_EQ(wide.width, 160u);
  ASSERT_EQ(square.width, 80u);
  std::size_t different = 0;
  for (std::size_t y = 0; y < 80; ++y) {
    for (std::size_t x = 0; x < 80; ++x) {
      for (std::size_t c = 0; c < 3; ++c) {
        const int a = square.rgba[4 * (y * 80 + x) + c], b = wide.rgba[4 * (y * 160 + x + 40) + c];
        different += std::abs(a - b) > 8 ? 1 : 0;
      }
    }
  }
  EXPECT_LT(different, 60u);  // rounding at outlines
}

Image grey(std::uint8_t value) {
  Image image{.width = 160, .height = 90, .rgba = {}};
  for (int i = 0; i < 160 * 90; ++i) {
    image.rgba.insert(image.rgba.end(), {value, value, value, 255});
  }
  return image;
}

std::size_t pixelsOf(const Image& image, int value) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
    count += image.rgba[i] == value && image.rgba[i + 1] == value && image.rgba[i + 2] == value ? 1 : 0;
  }
  return count;
}

// Values of sRGB 10, 128 and 240 in linear light are 0.003035, 0.215861 and 0.871367; pictures hold 255 times
// their square roots.
TEST_F(LayerPictures, ASequenceHasAPictureForEachFrameDecodedInSrgb) {
  const std::vector<std::pair<int, int>> values{{10, 14}, {128, 118}, {240, 238}};
  for (std::size_t i = 0; i < values.size(); ++i) {
    ASSERT_TRUE(writePng(grey(static_cast<std::uint8_t>(values[i].first)),
                         folder_.file("wall_0" + std::to_string(120 + i) + ".png")));
  }
  draw("demo:glass?panes=0&bottles=0", {"--frames", "120:123", "--image", folder_.file("out.png"),
                                        "--replace", "1=" + folder_.file("wall_####.png")});
  for (std::size_t i = 0; i < values.size(); ++i) {
    const Image out = read("out_0" + std::to_string(120 + i) + ".png");
    for (std::size_t k = 0; k < values.size(); ++k) {
      const std::size_t pixels = pixelsOf(out, values[k].second);
      EXPECT_TRUE(k == i ? pixels > 1000 : pixels < 20) << i << " " << k << " " << pixels;
    }
  }
}

TEST_F(LayerPictures, ASequenceWithAFrameMissingOrBrokenIsRefused) {
  ASSERT_TRUE(writePng(grey(9), folder_.file("s_8.png")));
  ASSERT_TRUE(writePng(grey(9), folder_.file("s_9.png")));
  const std::string whole = contents(folder_.file("s_8.png"));
  const auto refused = [&](const std::string& frames, const std::string& pattern, const std::string& about) {
    expectRefused(layersOf("demo:glass", {"--frames", frames, "--image", folder_.file("out.png"), "--replace",
                                          "1=" + folder_.file(pattern)}),
                  about);
  };
  refused("8:11", "s_#.png", "frame 10, " + folder_.file("s_10.png"));
  refused("8:10", "s_##.png", "s_08.png");
  refused("8:10", "#/s_#.png", "s_#.png");
  refused("8:10", "#_s_#.png", "single run of #");
  refused("8:10", std::string(5000, '#') + ".png", "there is no picture");
  std::filesystem::create_directory(folder_.file("s_11.png"));
  refused("9:12", "s_#.png", "s_10.png");
  refused("11", "s_#.png", "s_11.png");
  // The first frame's picture is read before any work, the others when they are needed.
  folder_.write("s_8.png", whole.substr(0, whole.size() / 2));
  refused("8:10", "s_#.png", "s_8.png");
  ASSERT_FALSE(std::filesystem::exists(folder_.file("out_0008.png")));
  folder_.write("s_8.png", whole);
  folder_.write("s_9.png", "\x89PNG\r\n\x1a\n");
  const Outcome second =
      runTool(layersOf("demo:glass", {"--frames", "8:10", "--image", folder_.file("out.png"), "--replace",
                                      "1=" + folder_.file("s_#.png")}));
  EXPECT_EQ(second.code, 2);
  EXPECT_EQ(second.errorLines(), 1) << second.err;
  EXPECT_NE(second.err.find("s_9.png"), std::string::npos) << second.err;
  // No output is one of the sequence's pictures.
  expectRefused(layersOf("demo:glass", {"--frames", "8:10", "--image", folder_.file("t.png"), "--replace",
                                        "1=" + folder_.file("t_####.png")}),
                "--replace");
}

// A file that has a # in its name is no sequence.
TEST_F(LayerPictures, AFileNamedWithANumberSignIsItself) {
  ASSERT_TRUE(writePng(grey(128), folder_.file("no #1.png")));
  draw("demo:glass?panes=0&bottles=0", {"--frames", "120", "--image", folder_.file("out.png"), "--replace",
                                        "1=" + folder_.file("no #1.png")});
  EXPECT_GT(pixelsOf(read("out.png"), 118), 1000u);
}

TEST_F(LayerPictures, TheTextTellsOfEachFrame) {
  const Outcome outcome = runTool(
      layersOf("demo:glass", {"--frames", "0:60:40", "--image", folder_.file("a.png"), "--peel", "never"}));
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("frame 0: "), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("frame 40: "), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("0 of them peeled"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("crossing 0"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("no order among"), std::string::npos) << outcome.out;
}

TEST_F(LayerPictures, BadUsageIsRefusedAndNothingIsWritten) {
  const std::string png = folder_.file("a.png"), none = folder_.file("nowhere/a.png");
  const std::string text = folder_.write("no.png", "no picture");
  const auto refused = [&](const std::vector<std::string>& more, const std::string& about) {
    expectRefused(layersOf("demo:glass", joined({"--frames", "0"}, more)), about);
  };
  refused({"--image", none}, "there is no folder");
  refused({"--by-distance", none}, "there is no folder");
  refused({"--image", folder_.file("a.jpg")}, ".png");
  refused({"--image", "-"}, ".png");
  refused({"--image", png, "--by-distance", png}, "--by-distance");
  refused({"--image", png, "--without", "999"}, "--without 999");
  refused({"--image", png, "--replace", "999=" + text}, "--replace 999");
  refused({"--image", png, "--replace", text}, "PART=FILE.png");
  refused({"--image", png, "--replace", "1=" + text}, text);
  refused({"--image", png, "--replace", "1=" + folder_.file("missing.png")}, "missing.png");
  refused({"--image", png, "--by-distance", folder_.file("b.png"), "--replace", "1=" + text}, "--replace");
  refused({"--image", png, "--samples", "3"}, "--samples");
  refused({"--image", png, "--parts", "opaque"}, "--parts");
  refused({"--image", png, "--parts", "see-through", "--replace", "1=" + text}, "--replace");
  refused({"--parts", "see-through", "--svg", folder_.file("a.svg")}, "--svg");
  refused({"--parts", "see-through", "--blurred", png}, "--blurred");
  refused({"--image", png, "--peel", "always"}, "--peel");
  expectRefused({"layers", "demo:glass", "--image", png, "--width", "0"}, "--width");
  expectRefused({"layers", "demo:glass", "--frames", "0", "--image", png, "--width", "16384"}, "8192");
  refused({"--image", png, "--without", ""}, "--without");
  refused({"--image", png, "--replace", "1="}, "PART=FILE.png");
  refused({"--image", ""}, "--image");
  refused({"--peel", "never"}, "--image");
  refused({"--samples", "2"}, "--image");
  refused({"--tints", "off"}, "--image");
  refused({"--svg", folder_.file("a.svg"), "--samples", "2"}, "--image");
  refused({"--line-picture", png, "--tints", "off"}, "--image");
  refused({"--image", png, "--line-picture", png}, "--line-picture");
  refused({"--without", "1"}, "--image");
  refused({"--replace", "1=" + text}, "--image");
  EXPECT_EQ(folder_.entries(), 1u);
}

TEST_F(LayerPictures, APartIsReplacedOnceAndNotLeftOutToo) {
  const Image dot{.width = 1, .height = 1, .rgba = {255, 0, 0, 255}};
  const std::string file = folder_.file("dot.png"), to = folder_.file("a.png");
  ASSERT_TRUE(writePng(dot, file));
  const auto refused = [&](const std::vector<std::string>& more, const std::string& about) {
    expectRefused(layersOf("demo:glass", joined({"--frames", "0", "--replace", "1=" + file}, more)), about);
  };
  refused({"--image", to, "--without", "1"}, "--without");
  refused({"--image", to, "--replace", "1=" + file}, "two pictures");
  refused({"--image", file}, "--replace");
  EXPECT_EQ(read("dot.png"), dot);
  EXPECT_EQ(folder_.entries(), 1u);
}

}  // namespace
}  // namespace sightline::tool_test
