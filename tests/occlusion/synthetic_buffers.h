#pragma once

// Depth buffers made from formulas and random numbers instead of occluders, and brute-force queries of them.

#include <random>
#include <string>
#include <vector>

#include "sightline/occlusion/rasteriser.h"
#include "src/occlusion/boxes/pixel_boxes.h"

namespace sightline::test {

using occlusion::PixelBox;

// Pixels beyond the width are alternately very far and uncovered; they must not affect results.
struct SyntheticMap {
  std::string name;
  std::uint32_t width = 0, height = 0, stride = 0;
  std::vector<float> reciprocal_depth;

  SyntheticMap() = default;
  // rule(x, y): reciprocal depth
  template <typename Rule>
  SyntheticMap(std::string map_name, std::uint32_t w, std::uint32_t h, Rule&& rule)
      : name(std::move(map_name) + " " + std::to_string(w) + " x " + std::to_string(h)),
        width(w),
        height(h),
        stride(w + 5) {
    for (std::uint32_t y = 0; y < height; ++y) {
      for (std::uint32_t x = 0; x < stride; ++x) {
        reciprocal_depth.push_back(x < width ? rule(x, y) : (x % 2 == 0 ? -1e30f : kUncovered));
      }
    }
  }
  DepthBufferView view() const { return {reciprocal_depth, width, height, stride}; }
};

inline std::vector<SyntheticMap> syntheticMaps(std::uint32_t w, std::uint32_t h, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto dice = [&](std::uint64_t sides) { return static_cast<float>(random() % sides); };
  std::vector<SyntheticMap> maps;
  const auto add = [&](const char* name, auto&& rule) { maps.emplace_back(name, w, h, rule); };
  using U = std::uint32_t;
  add("empty", [](U, U) { return kUncovered; });
  add("full", [](U, U) { return 0.5f; });
  add("rows", [](U, U y) { return y % 2 == 0 ? 0.5f : kUncovered; });
  add("columns", [](U x, U) { return x % 2 == 0 ? 0.5f : kUncovered; });
  add("checkerboard", [](U x, U y) { return (x + y) % 2 == 0 ? 0.5f : kUncovered; });
  add("alternating", [](U x, U y) { return (x + y) % 2 == 0 ? 0.5f : 0.25f; });
  add("alternating every third", [](U x, U) { return x % 3 == 0 ? 0.5f : 0.25f; });
  add("farther to the right", [](U x, U) { return 1.0f / (1.0f + static_cast<float>(x)); });
  add("nearer to the right", [](U x, U) { return 0.001f * static_cast<float>(x); });
  add("orthographic valley",
      [w](U x, U) { return -std::abs(static_cast<float>(x) - 0.5f * static_cast<float>(w)); });
  add("orthographic ridge",
      [w](U x, U) { return std::abs(static_cast<float>(x) - 0.5f * static_cast<float>(w)); });
  add("saw", [](U x, U) { return static_cast<float>(x % 40); });
  add("stairs", [](U x, U y) { return static_cast<float>((x / 7 + y) % 5); });
  add("random", [&](U, U) { return dice(1000); });
  add("random, few values", [&](U, U) { return dice(3); });
  add("random with gaps", [&](U, U) { return random() % 4 == 0 ? kUncovered : dice(3); });
  float value = 1.0f;
  add("random plateaus", [&](U, U) { return value = random() % 9 == 0 ? dice(6) : value; });
  add("random plateaus with gaps",
      [&](U, U) { return value = random() % 9 == 0 ? (random() % 3 == 0 ? kUncovered : dice(6)) : value; });
  add("nearly full", [&](U, U) { return random() % (w * h) == 0 ? kUncovered : 0.5f; });
  add("extremes", [&](U, U) {
    const float values[] = {0.0f, -0.0f, 1e38f, -3e38f, 1e-38f, std::nextafter(kUncovered, 0.0f), kUncovered};
    return values[random() % 7];
  });
  return maps;
}

// Sizes that do not fill vectors or blocks, and sizes wide enough for queries that use peaks only.
inline constexpr std::uint32_t kMapSizes[][2] = {{1, 1}, {1, 9},  {9, 1},  {2, 2},
                                                 {5, 4}, {64, 3}, {67, 5}, {300, 2}};

inline PixelBox rectangle(std::uint32_t x0, std::uint32_t y0, std::uint32_t x1, std::uint32_t y1,
                          float nearest = 0.0f) {
  PixelBox rect;
  rect.place = occlusion::BoxPlace::kOnBuffer;
  rect.x0 = static_cast<std::uint16_t>(x0);
  rect.y0 = static_cast<std::uint16_t>(y0);
  rect.x1 = static_cast<std::uint16_t>(x1);
  rect.y1 = static_cast<std::uint16_t>(y1);
  rect.nearest = nearest;
  return rect;
}

inline PixelBox randomRectangle(std::mt19937_64& random, std::uint32_t width, std::uint32_t height) {
  const auto below = [&](std::uint32_t n) { return static_cast<std::uint32_t>(random() % n); };
  std::uint32_t x0 = below(width), x1 = below(width), y0 = below(height), y1 = below(height);
  // Borders more often.
  x0 = random() % 4 == 0 ? 0 : x0;
  x1 = random() % 4 == 0 ? width - 1 : x1;
  y0 = random() % 4 == 0 ? 0 : y0;
  y1 = random() % 4 == 0 ? height - 1 : y1;
  return rectangle(std::min(x0, x1), std::min(y0, y1), std::max(x0, x1), std::max(y0, y1));
}

inline std::uint32_t coveredByCounting(const DepthBufferView& buffer, const PixelBox& rect) {
  std::uint32_t count = 0;
  for (std::uint32_t y = rect.y0; y <= rect.y1; ++y) {
    for (std::uint32_t x = rect.x0; x <= rect.x1; ++x) {
      count += buffer.covered(x, y) ? 1 : 0;
    }
  }
  return count;
}

inline bool allNearerByScanning(const DepthBufferView& buffer, const PixelBox& rect) {
  for (std::uint32_t y = rect.y0; y <= rect.y1; ++y) {
    for (std::uint32_t x = rect.x0; x <= rect.x1; ++x) {
      if (buffer.covered(x, y) && !(buffer.at(x, y) > rect.nearest)) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace sightline::test
