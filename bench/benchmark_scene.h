#pragma once

// The scenes that benchmarks take as arguments.

#include <fmt/format.h>

#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scenes/procedural.h"
#include "sightline/io/camera_path_json.h"
#include "sightline/io/import.h"

namespace sightline::bench {

struct BenchmarkScene {
  Scene scene;
  CameraPath path;
  std::vector<Box> bounds;
  std::vector<std::uint32_t> cost;  // triangles

  explicit BenchmarkScene(Scene source) : scene(std::move(source)) {
    for (const Object& object : scene.objects) {
      bounds.push_back(object.bounds);
      cost.push_back(object.triangleCount());
    }
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

}  // namespace sightline::bench
