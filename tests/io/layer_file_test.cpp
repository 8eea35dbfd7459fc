#include "sightline/io/layer_file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.h"

namespace sightline {
namespace {

FileLayer pixel(const std::string& name) {
  return {.name = name, .width = 1, .height = 1, .rgba = {1, 0, 0, 1}};
}

TEST(LayerFile, ALayerIsCroppedToWhatIsNotTransparent) {
  constexpr std::uint32_t kWidth = 5, kHeight = 4;
  std::vector<float> rgba(4 * kWidth * kHeight, 0.0f), depths;
  for (std::uint32_t i = 0; i < kWidth * kHeight; ++i) {
    depths.push_back(static_cast<float>(i));
  }
  rgba[4 * (1 * kWidth + 2) + 3] = 0.5f;  // opacity at x 2, y 1
  rgba[4 * (3 * kWidth + 1) + 0] = 2.0f;  // light without opacity at x 1, y 3
  const FileLayer layer = croppedLayer("a", kWidth, kHeight, rgba, depths);
  EXPECT_EQ(layer.left, 1u);
  EXPECT_EQ(layer.top, 1u);
  EXPECT_EQ(layer.width, 2u);
  EXPECT_EQ(layer.height, 3u);
  EXPECT_EQ(layer.depths, (std::vector<float>{6, 7, 11, 12, 16, 17}));
  ASSERT_EQ(layer.rgba.size(), 24u);
  EXPECT_EQ(layer.rgba[4 * 1 + 3], 0.5f);
  EXPECT_EQ(layer.rgba[4 * 4 + 0], 2.0f);
  const FileLayer empty = croppedLayer("b", 1, 1, std::vector<float>(4, 0.0f), {});
  EXPECT_EQ(empty.width, 0u);
  EXPECT_TRUE(empty.rgba.empty());
}

TEST(LayerFile, WhatDoesNotFitIsRefusedAndNothingIsWritten) {
  const test::TemporaryFolder folder;
  const std::string file = folder.file("a.exr");
  const auto refused = [&](std::uint32_t width, std::uint32_t height, const std::vector<FileLayer>& layers) {
    EXPECT_FALSE(writeLayerFile(file, width, height, layers, "{}"));
    EXPECT_FALSE(std::filesystem::exists(file));
  };
  refused(1, 1, {});
  refused(0, 1, {pixel("a")});
  refused(1, 0x80000000u, {pixel("a")});
  refused(1, 1, {pixel("a"), pixel("a")});
  FileLayer outside = pixel("a");
  outside.left = 1;
  refused(1, 1, {outside});
  outside.left = 0xffffffffu;
  refused(1, 1, {outside});
  FileLayer less = pixel("a");
  less.rgba.pop_back();
  refused(1, 1, {less});
  FileLayer deep = pixel("a");
  deep.depths = {1, 2};
  refused(1, 1, {deep});
  EXPECT_FALSE(writeLayerFile("/nowhere/at/all.exr", 1, 1, std::vector{pixel("a")}, "{}"));
}

}  // namespace
}  // namespace sightline
