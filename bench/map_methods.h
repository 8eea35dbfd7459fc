#pragma once

// The methods that the benchmarks of image-space culling compare.

#include <fmt/format.h>

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/any_culler.h"

namespace sightline::bench {

struct MapSize {
  std::uint32_t width, height;
  friend bool operator==(const MapSize&, const MapSize&) = default;
};
inline constexpr MapSize kMapSizes[] = {{64, 36}, {128, 128}, {320, 180}, {1280, 720}};

enum class MethodKind : std::uint8_t { kCuller, kRays };

// A row of the tables.
struct Method {
  std::string name;
  MethodKind kind = MethodKind::kCuller;
  MapSize size{0, 0};  // of those that have a map
  AnySettings settings;
  bool small_occluders = false;  // of a set in which the small boxes are, too

  bool hasMap() const { return size.width > 0; }
  std::string sizeText() const { return hasMap() ? fmt::format("{}x{}", size.width, size.height) : ""; }
};

inline Method cullerMethod(std::string name, AnyMethod method, std::uint32_t occluder_count,
                           MapSize size = {0, 0}) {
  Method made{.name = std::move(name), .size = size, .settings = {.method = method}};
  made.settings.occluder_count = occluder_count;
  made.settings.focus.magnification = 0.0;
  if (made.hasMap()) {
    made.settings.raster.width = size.width;
    made.settings.raster.height = size.height;
  }
  return made;
}

// A depth pyramid with its finer map, whatever the number of objects it pays for.
inline Method focusedMethod(std::string name, std::uint32_t occluder_count, MapSize size,
                            const FocusSettings& focus) {
  Method made = cullerMethod(std::move(name), AnyMethod::kDepthPyramid, occluder_count, size);
  made.settings.focus = focus;
  made.settings.focus.worth = 1e9;
  return made;
}

// Both maps with these sizes and counts, the first also with a finer map, and rays with these sizes.
inline void addMapMethods(std::vector<Method>& methods, std::span<const MapSize> sizes,
                          std::span<const std::uint32_t> counts) {
  for (const MapSize size : sizes) {
    for (const std::uint32_t count : counts) {
      methods.push_back(cullerMethod("pyramid", AnyMethod::kDepthPyramid, count, size));
    }
    for (const std::uint32_t count : counts) {
      methods.push_back(focusedMethod("focused", count, size, {}));
    }
    for (const std::uint32_t count : counts) {
      methods.push_back(cullerMethod("opacity", AnyMethod::kOpacityMap, count, size));
    }
    methods.push_back({.name = "rays", .kind = MethodKind::kRays, .size = size});
  }
}

}  // namespace sightline::bench
