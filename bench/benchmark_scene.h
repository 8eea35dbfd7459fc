#pragma once

// The scenes that benchmarks take as arguments, and the frames that they measure.

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scenes/procedural.h"
#include "sightline/io/camera_path_json.h"
#include "sightline/io/import.h"
#include "tests/support/object_arrays.h"

namespace sightline::bench {

struct BenchmarkScene {
  Scene scene;
  CameraPath path;
  std::vector<Box> bounds;
  std::vector<std::uint32_t> cost;  // triangles

  explicit BenchmarkScene(Scene source) : scene(std::move(source)) {
    test::ObjectArrays objects(scene);
    bounds = std::move(objects.boxes);
    cost = std::move(objects.triangles);
    if (!scene.paths.empty()) {
      path = scene.paths[0];
    }
  }
};

template <typename T>
T valueOrExit(Result<T> result, std::string_view program) {
  if (!result) {
    fmt::print(stderr, "{}: {}\n", program, result.error().message);
    std::exit(2);
  }
  return std::move(*result);
}

// name: demo:..., or a file with walk.path.json beside it.
inline BenchmarkScene loadScene(const std::string& name, std::string_view program) {
  if (isDemoUrl(name)) {
    return BenchmarkScene(valueOrExit(makeDemoScene(name), program));
  }
  BenchmarkScene loaded(valueOrExit(importScene(name), program));
  const std::string path = name.substr(0, name.rfind('/') + 1) + "walk.path.json";
  loaded.path = valueOrExit(readCameraPath(path), program);
  return loaded;
}

// Of each view of a path of views, before those that are counted: until coherence has settled.
inline constexpr std::size_t kUncounted = 12;

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

}  // namespace sightline::bench
