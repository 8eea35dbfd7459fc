#pragma once

// What the benchmarks of image-space culling share: the methods that they compare, and the frames that they
// measure.

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/benchmark_scene.h"
#include "sightline/culling/culler.h"

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
  CullerSettings settings;
  bool small_occluders = false;  // of a set in which the small boxes are, too

  bool hasMap() const { return size.width > 0; }
  std::string sizeText() const { return hasMap() ? fmt::format("{}x{}", size.width, size.height) : ""; }
};

inline Method cullerMethod(std::string name, CullMethod method, std::uint32_t occluder_count,
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
  Method made = cullerMethod(std::move(name), CullMethod::kDepthPyramid, occluder_count, size);
  made.settings.focus = focus;
  made.settings.focus.least_objects = 0;
  return made;
}

// Both maps with these sizes and counts, the first also with a finer map, and rays with these sizes.
inline void addMapMethods(std::vector<Method>& methods, std::span<const MapSize> sizes,
                          std::span<const std::uint32_t> counts) {
  for (const MapSize size : sizes) {
    for (const std::uint32_t count : counts) {
      methods.push_back(cullerMethod("pyramid", CullMethod::kDepthPyramid, count, size));
    }
    for (const std::uint32_t count : counts) {
      methods.push_back(focusedMethod("focused", count, size, {}));
    }
    for (const std::uint32_t count : counts) {
      methods.push_back(cullerMethod("opacity", CullMethod::kOpacityMap, count, size));
    }
    methods.push_back({.name = "rays", .kind = MethodKind::kRays, .size = size});
  }
}

// Of each view of a path of views, before those that are counted: until coherence has settled.
inline constexpr std::size_t kUncounted = 10;

struct Step {
  View view;
  bool counted = false;  // others prepare for it
};

// The views of a scene that has a path of that name: each one several times, the last `counted` times
// counted. A culler takes the first for a jump and finds its occluders anew; the others are as any frame of a
// walk. Otherwise the first frames of the scene's walk, of which the first ten prepare.
inline std::vector<Step> stepsOf(const BenchmarkScene& loaded, std::size_t most, std::size_t counted) {
  constexpr std::size_t kWarmUp = 10;
  std::vector<Step> steps;
  for (const CameraPath& path : loaded.scene.paths) {
    for (std::size_t i = 0; path.name == "views" && i < std::min(most, path.frames.size()); ++i) {
      for (std::size_t time = 0; time < kUncounted + counted; ++time) {
        steps.push_back({path.view(i, loaded.scene.origin), time >= kUncounted});
      }
    }
  }
  if (steps.empty()) {
    for (std::size_t i = 0; i < std::min(most + kWarmUp, loaded.path.frames.size()); ++i) {
      steps.push_back({loaded.path.view(i, loaded.scene.origin), i >= kWarmUp});
    }
  }
  return steps;
}

inline double medianOf(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0.0 : values[values.size() / 2];
}

inline double meanOf(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) {
    sum += value;
  }
  return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

struct Arguments {
  std::vector<std::string> scenes;
  bool brief = false;  // --benchmark_min_time=...
};

inline Arguments argumentsOf(int argc, char** argv) {
  Arguments arguments;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument.rfind("--benchmark_min_time", 0) == 0) {
      arguments.brief = true;
    } else if (argument.rfind("--", 0) != 0) {
      arguments.scenes.push_back(argument);
    }
  }
  return arguments;
}

}  // namespace sightline::bench
