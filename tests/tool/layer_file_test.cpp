// sightline layers --layer-file, read by OpenEXR and composited here.

#ifdef SIGHTLINE_OPENEXR

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfStringAttribute.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <sstream>

#include "sightline/io/image.h"
#include "tests/support/pictures.h"
#include "tests/tool/run_tool.h"

namespace sightline::tool_test {
namespace {

using nlohmann::json;
using Pixel = std::array<double, 4>;  // premultiplied

constexpr double kNoDepth = std::numeric_limits<double>::infinity();

struct ReadLayer {
  std::vector<Pixel> pixels;
  std::vector<double> depths;
  bool has_depths = false;
};

struct ReadFile {
  int width = 0, height = 0;
  json description;
  std::vector<std::string> names;
  std::map<std::string, ReadLayer> layers;
};

std::vector<float> channelOf(Imf::MultiPartInputFile& file, int part, const char* channel, int width,
                             int height, float fill) {
  std::vector<float> values(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), fill);
  const Imath::Box2i window = file.header(part).dataWindow();
  Imf::FrameBuffer buffer;
  buffer.insert(channel, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data()), sizeof(float),
                                    sizeof(float) * static_cast<std::size_t>(width)));
  Imf::InputPart input(file, part);
  input.setFrameBuffer(buffer);
  input.readPixels(window.min.y, window.max.y);
  return values;
}

ReadFile read(const std::string& name) {
  Imf::MultiPartInputFile file(name.c_str());
  const Imath::Box2i whole = file.header(0).displayWindow();
  ReadFile result{.width = whole.max.x + 1, .height = whole.max.y + 1};
  result.description = json::parse(file.header(0).typedAttribute<Imf::StringAttribute>("sightline").value());
  for (int part = 0; part < file.parts(); ++part) {
    ReadLayer layer;
    layer.pixels.resize(static_cast<std::size_t>(result.width) * static_cast<std::size_t>(result.height));
    std::size_t channel = 0;
    for (const char* const letter : {"R", "G", "B", "A"}) {
      const std::vector<float> values = channelOf(file, part, letter, result.width, result.height, 0.0f);
      for (std::size_t i = 0; i < values.size(); ++i) {
        layer.pixels[i][channel] = values[i];
      }
      ++channel;
    }
    layer.has_depths = file.header(part).channels().findChannel("Z") != nullptr;
    const auto none = std::numeric_limits<float>::infinity();
    const std::vector<float> depths = layer.has_depths
                                          ? channelOf(file, part, "Z", result.width, result.height, none)
                                          : std::vector<float>(layer.pixels.size(), none);
    layer.depths.assign(depths.begin(), depths.end());
    result.names.push_back(file.header(part).name());
    result.layers[result.names.back()] = std::move(layer);
  }
  return result;
}

Pixel scaled(const Pixel& p, double by) {
  return {p[0] * by, p[1] * by, p[2] * by, p[3] * by};
}
Pixel sum(const Pixel& a, const Pixel& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]};
}

// Runs the file's program, as docs/formats.md describes it, each step on all pixels.
std::vector<Pixel> composited(const ReadFile& file) {
  const auto count = static_cast<std::size_t>(file.width) * static_cast<std::size_t>(file.height);
  std::vector<Pixel> star(count), added(count), image(count);
  for (const json& text : file.description["program"]) {
    const std::string step = text;
    const std::size_t number = step.find_first_of("0123456789");
    const std::string operation = step.substr(0, number == std::string::npos ? number : number - 1);
    const std::vector<Pixel>* layer = nullptr;
    if (number != std::string::npos) {
      const std::size_t index = std::strtoul(step.c_str() + number, nullptr, 10);
      layer = &file.layers.at(file.description["layers"].at(index)["name"]).pixels;
    }
    const auto alphaOfLayer = [&](std::size_t i) { return layer != nullptr ? (*layer)[i][3] : 0.0; };
    if (operation == "load") {
      star = layer != nullptr ? *layer : std::vector<Pixel>(count);
    } else if (operation == "in") {
      for (std::size_t i = 0; i < count; ++i) {
        star[i] = scaled(star[i], alphaOfLayer(i));
      }
    } else if (operation == "out") {
      for (std::size_t i = 0; i < count; ++i) {
        star[i] = scaled(star[i], 1.0 - alphaOfLayer(i));
      }
    } else if (operation == "start sum") {
      added = layer != nullptr ? *layer : star;
    } else if (operation == "add") {
      const std::vector<Pixel>& more = layer != nullptr ? *layer : star;
      for (std::size_t i = 0; i < count; ++i) {
        added[i] = sum(added[i], more[i]);
      }
    } else if (operation == "start image") {
      image = layer != nullptr ? *layer : added;
    } else if (operation == "over") {
      const std::vector<Pixel>& behind = layer != nullptr ? *layer : added;
      for (std::size_t i = 0; i < count; ++i) {
        image[i] = sum(image[i], scaled(behind[i], 1.0 - image[i][3]));
      }
    } else {
      ADD_FAILURE() << step;
    }
  }
  return image;
}

class LayerFile : public ::testing::Test {
 protected:
  void SetUp() override { SIGHTLINE_SKIP_WITHOUT_PICTURES(); }

  ReadFile written(const std::string& scene, const std::vector<std::string>& more) const {
    const Outcome outcome =
        runTool(joined({"layers", scene, "--width", "160", "--height", "90", "--layer-file",
                        folder_.file("layers.exr"), "--image", folder_.file("picture.png")},
                       more));
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return outcome.code == 0 ? read(folder_.file("layers.exr")) : ReadFile{};
  }

  // The layers composited here are the file's picture, and this is the .png file's.
  void expectThePicture(const ReadFile& file) const {
    const Result<Image> png = readPng(folder_.file("picture.png"));
    ASSERT_TRUE(png);
    ASSERT_EQ(file.names.at(0), "picture");
    const ReadLayer& picture = file.layers.at("picture");
    ASSERT_EQ(picture.pixels.size(), std::size_t{160 * 90});
    const std::vector<Pixel> composite = composited(file);
    for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
      const Pixel& own = composite[i];
      for (std::size_t c = 0; c < 4; ++c) {
        ASSERT_NEAR(own[c], picture.pixels[i][c], 1e-5) << i;
      }
      for (std::size_t c = 0; c < 3; ++c) {
        ASSERT_NEAR(255.0 * std::sqrt(own[c]), int{png->rgba[4 * i + c]}, 0.51) << i;
      }
    }
  }
  static bool has(const ReadFile& file, const std::string& operation) {
    for (const json& step : file.description["program"]) {
      if (step.get<std::string>().rfind(operation, 0) == 0) {
        return true;
      }
    }
    return false;
  }

  TemporaryFolder folder_;
};

TEST_F(LayerFile, ItsLayersCompositedByItsProgramAreThePicture) {
  const ReadFile file = written("demo:glass", {"--frames", "60"});
  EXPECT_GT(file.layers.size(), 60u);
  expectThePicture(file);
}

TEST_F(LayerFile, CyclesAreInItsProgram) {
  const ReadFile file = written("demo:glass", {"--frames", "60", "--peel", "never"});
  EXPECT_TRUE(has(file, "out"));
  expectThePicture(file);
}

TEST_F(LayerFile, WhatADepthBufferOrdersIsOneLayer) {
  const ReadFile all = written("demo:glass", {"--frames", "60"});
  const ReadFile file = written("demo:glass", {"--frames", "60", "--parts", "see-through"});
  EXPECT_LT(file.layers.size(), all.layers.size());
  expectThePicture(file);
}

// Depths say which layer is in front, without the order.
TEST_F(LayerFile, OfOpaqueLayersThePictureShowsTheNearest) {
  const ReadFile file = written("demo:toothpicks?n=400&scaling=us", {"--frames", "30"});
  expectThePicture(file);
  std::size_t covered = 0;
  for (std::size_t i = 0; i < std::size_t{160 * 90}; ++i) {
    const ReadLayer* nearest = nullptr;
    std::size_t layers = 0;
    for (const auto& [name, layer] : file.layers) {
      if (layer.has_depths && layer.pixels[i][3] > 0.0) {
        ASSERT_LT(layer.depths[i], kNoDepth) << name;
        nearest = nearest == nullptr || layer.depths[i] < nearest->depths[i] ? &layer : nearest;
        ++layers;
      }
    }
    if (nearest != nullptr) {
      ASSERT_EQ(nearest->pixels[i], file.layers.at("picture").pixels[i]) << i;
    }
    covered += layers > 1 ? 1 : 0;
  }
  EXPECT_GT(covered, 100u);
}

TEST_F(LayerFile, LeavesOutAndReplacesAsThePictureDoes) {
  Image half{.width = 160, .height = 90, .rgba = {}};
  for (int i = 0; i < 160 * 90; ++i) {
    half.rgba.insert(half.rgba.end(), {200, 100, 50, 128});
  }
  ASSERT_TRUE(writePng(half, folder_.file("half.png")));
  const ReadFile file = written(
      "demo:glass", {"--frames", "60", "--without", "12", "--replace", "3=" + folder_.file("half.png")});
  expectThePicture(file);
  for (const json& layer : file.description["layers"]) {
    EXPECT_EQ(std::count(layer["parts"].begin(), layer["parts"].end(), 12), 0);
  }
}

TEST_F(LayerFile, EachFrameHasOneAndBadNamesAreRefused) {
  const json frames = toolJson({"layers", "demo:toothpicks?n=20", "--frames", "3:5", "--width", "80",
                                "--height", "45", "--layer-file", folder_.file("a.exr")})["frames"];
  EXPECT_EQ(frames[1]["picture"]["layer_file"], folder_.file("a_0004.exr"));
  EXPECT_EQ(read(folder_.file("a_0003.exr")).description["frame"], 3);
  EXPECT_EQ(read(folder_.file("a_0004.exr")).description["frame"], 4);
  const auto refused = [&](const std::string& file, const std::string& about) {
    expectRefused({"layers", "demo:glass", "--frames", "0", "--layer-file", file}, about);
  };
  refused(folder_.file("a.png"), ".exr");
  refused(folder_.file("nowhere/a.exr"), "there is no folder");
  refused("", "--layer-file");
  EXPECT_EQ(folder_.entries(), 2u);
}

}  // namespace
}  // namespace sightline::tool_test

#endif
