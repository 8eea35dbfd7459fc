// sightline layers --line-picture.

#include <fmt/format.h>

#include <set>
#include <utility>

#include "sightline/io/image.h"
#include "tests/support/pictures.h"
#include "tests/tool/run_tool.h"

namespace sightline::tool_test {
namespace {

using nlohmann::json;
using Pixels = std::set<std::pair<int, int>>;  // x, y

// An upright rectangle about the z axis as an object; rectangles are numbered from 0.
std::string rectangle(int number, double half_width, double half_height, double z) {
  std::string text = fmt::format("o rectangle_{}\n", number);
  for (const auto& [x, y] : {std::pair(-1, -1), {1, -1}, {1, 1}, {-1, 1}}) {
    text += fmt::format("v {} {} {}\n", x * half_width, y * half_height, z);
  }
  const int first = 4 * number + 1;
  return text + fmt::format("f {} {} {} {}\n", first, first + 1, first + 2, first + 3);
}

// A camera path at z = 10. At z = 0 a metre is ten of the picture's eighty pixels, in both kinds of views.
std::string pathJson(bool orthographic) {
  json path = {{"near", 1.0},
               {"far", 50.0},
               {"width", 80},
               {"height", 80},
               {"frames", {{{"eye", {0, 0, 10}}, {"forward", {0, 0, -1}}, {"up", {0, 1, 0}}}}}};
  if (orthographic) {
    path["ortho_height"] = 8.0;
  } else {
    path["fovy_deg"] = 43.60281897270362;  // of the tangent 0.4
  }
  return path.dump();
}

Pixels borderOf(int left, int top, int right, int bottom) {
  Pixels pixels;
  for (int x = left; x <= right; ++x) {
    pixels.insert({x, top});
    pixels.insert({x, bottom});
  }
  for (int y = top; y <= bottom; ++y) {
    pixels.insert({left, y});
    pixels.insert({right, y});
  }
  return pixels;
}

Pixels inkOf(const std::string& file) {
  const Result<Image> image = readPng(file);
  Pixels pixels;
  for (std::uint32_t i = 0; image && i < image->width * image->height; ++i) {
    if (image->rgba[4 * std::size_t{i}] == 0) {
      pixels.insert({static_cast<int>(i % image->width), static_cast<int>(i / image->width)});
    }
  }
  return pixels;
}

class LayerLinePicture : public ::testing::Test {
 protected:
  void SetUp() override { SIGHTLINE_SKIP_WITHOUT_PICTURES(); }
};

TEST_F(LayerLinePicture, LinesEndWhereSomethingHidesThem) {
  // The small square hides the middle of the long rectangle ten metres behind it.
  Pixels expected = borderOf(9, 34, 70, 45);
  for (int x = 30; x < 50; ++x) {
    expected.erase({x, 34});
    expected.erase({x, 45});
  }
  expected.merge(borderOf(29, 29, 50, 50));
  for (const bool orthographic : {false, true}) {
    const TemporaryFolder folder;
    const double scale = orthographic ? 1.0 : 2.0;  // of what is twice as far
    const std::string scene = folder.write(
        "scene.obj", rectangle(0, 1.05, 1.05, 0.0) + rectangle(1, 3.05 * scale, 0.55 * scale, -10.0));
    const std::string path = folder.write("path.json", pathJson(orthographic)), file = folder.file("a.png");
    const json result = toolJson({"layers", scene, "--path", path, "--line-picture", file});
    EXPECT_EQ(inkOf(file), expected) << orthographic;
    const json picture = result["frames"][0]["line_picture"];
    EXPECT_EQ(picture["lines"], 8);
    EXPECT_EQ(picture["ink"], expected.size());
    EXPECT_EQ(picture["file"], file);
  }
}

TEST_F(LayerLinePicture, KindsOfLinesAreThoseOfDrawings) {
  const TemporaryFolder folder;
  const auto drawn = [&](const std::vector<std::string>& options) {
    const std::vector<std::string> arguments{"layers",         "demo:toothpicks?n=40",
                                             "--frames",       "0",
                                             "--width",        "320",
                                             "--height",       "240",
                                             "--svg",          folder.file("a.svg"),
                                             "--line-picture", folder.file("a.png")};
    return toolJson(joined(arguments, options))["frames"][0];
  };
  const json all = drawn({}), some = drawn({"--no-creases"});
  EXPECT_EQ(all["line_picture"]["lines"], all["drawing"]["lines"]);
  EXPECT_EQ(some["line_picture"]["lines"], some["drawing"]["lines"]);
  EXPECT_LT(some["line_picture"]["lines"], all["line_picture"]["lines"]);
  EXPECT_LT(some["line_picture"]["ink"], all["line_picture"]["ink"]);
}

TEST_F(LayerLinePicture, SeveralFramesAreSeveralFiles) {
  const TemporaryFolder folder;
  const Outcome outcome = runTool({"layers", "demo:toothpicks?n=20", "--frames", "0:40:20", "--width", "80",
                                   "--height", "60", "--line-picture", folder.file("a.png")});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("line pictures"), std::string::npos);
  EXPECT_EQ(folder.entries(), 2u);
  EXPECT_NE(inkOf(folder.file("a_0000.png")), inkOf(folder.file("a_0020.png")));
}

TEST_F(LayerLinePicture, RefusesOtherFilesAndNoKindOfLine) {
  const TemporaryFolder folder;
  const auto with = [](const std::vector<std::string>& more) {
    return joined({"layers", "demo:toothpicks?n=20", "--line-picture"}, more);
  };
  expectRefused(with({folder.file("a.svg")}), ".png");
  expectRefused(with({folder.file("none/a.png")}), "none");
  expectRefused(with({folder.file("a.png"), "--no-creases", "--no-silhouettes", "--no-boundaries"}), "line");
  EXPECT_EQ(folder.entries(), 0u);
}

}  // namespace
}  // namespace sightline::tool_test
