// How long does it take to prepare a scene, stage by stage, and how long for each triangle? Processor time of
// one thread, the least of two runs, in seconds. Beside occluders, surfaces and objects' boxes: microseconds
// a triangle; the share of the time that is spent outside of the ranges handed to a ParallelFor, which more
// threads do not make shorter; and the share that the system takes, which clears memory that is touched for
// the first time.
//
//   preparation [--triangles N] [--only STAGE] [--runs N] [SCENE...]
//
// --triangles: copies of each scene are put beside each other until there are so many triangles.
// --only: `occluders`, `surfaces` or `boxes`, for a profile of it; the other stages are left out.
// Without scenes: growing ones, a city of boxes with small closed objects and a terrain of connected surfaces
// of which every triangle is a polygon of its own; with --triangles, one of each kind.

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "bench/benchmark_scene.h"
#include "bench/measuring.h"
#include "sightline/hierarchy/hierarchy.h"
#include "sightline/occluders/occluder_set.h"
#include "sightline/occluders/surface_set.h"
#include "sightline/scene/object_boxes.h"
#include "src/hierarchy/wide_hierarchy.h"

namespace {

using namespace sightline;
using namespace sightline::bench;

struct Options {
  std::vector<std::string> scenes;
  std::size_t triangles = 0;  // 0: the scenes as they are
  std::string only;           // empty: all stages
  int runs = 2;

  bool wants(const std::string& stage) const { return only.empty() || only == stage; }
};

Options optionsOf(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const auto value = [&] { return i + 1 < argc ? std::string(argv[++i]) : std::string(); };
    if (word == "--triangles") {
      options.triangles = std::strtoull(value().c_str(), nullptr, 10);
    } else if (word == "--only") {
      options.only = value();
    } else if (word == "--runs") {
      options.runs = std::max(1, std::atoi(value().c_str()));
    } else if (word.rfind("--", 0) != 0) {
      options.scenes.push_back(word);
    }
  }
  return options;
}

std::vector<std::string> usualScenes(const Options& options) {
  std::vector<std::string> scenes;
  if (options.triangles > 0) {
    // The largest of each kind.
    scenes = {
        fmt::format("demo:city?copies={}", std::clamp<std::size_t>(options.triangles / 9984 + 1, 1, 2000)),
        "demo:building?floors=20&plants=1000",
        "demo:boxes?boxes=1000000",
        "demo:ship?decks=12&rooms=16",
        fmt::format("demo:terrain?triangles={}",
                    std::clamp<std::size_t>(options.triangles, 10'000, 10'000'000)),
        "demo:cave?halls=100&triangles=400000",
        "demo:village?houses=300",
        "demo:jungle?buttes=100&trees=3000",
        "demo:voxels?halls=100",
        "demo:boilerhouse"};
    return scenes;
  }
  for (const char* count : {"10000", "100000", "1000000"}) {
    scenes.push_back(fmt::format("demo:boxes?boxes={}", count));
  }
  for (const char* count : {"10000", "100000", "1000000", "10000000"}) {
    scenes.push_back(fmt::format("demo:terrain?triangles={}", count));
  }
  return scenes;
}

// Copies of a scene beside each other, with so many triangles or a few more.
Scene repeated(Scene scene, std::size_t triangles) {
  const std::size_t copies =
      (triangles + scene.triangleCount() - 1) / std::max<std::size_t>(1, scene.triangleCount());
  if (copies <= 1 || scene.triangleCount() == 0) {
    return scene;
  }
  const Vec3f size = sceneBounds(scene.view()).extent();
  const auto columns = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(copies))));
  const std::size_t positions = scene.positions.size(), indices = scene.indices.size(),
                    objects = scene.objects.size();
  scene.positions.reserve(copies * positions);
  scene.indices.reserve(copies * indices);
  scene.objects.reserve(copies * objects);
  for (std::size_t copy = 1; copy < copies; ++copy) {
    // Whole metres, and some between the copies, so that rounding makes no positions equal.
    const Vec3f shift(static_cast<float>(copy % columns) * (std::ceil(size.x) + 8.0f), 0.0f,
                      static_cast<float>(copy / columns) * (std::ceil(size.z) + 8.0f));
    for (std::size_t i = 0; i < positions; ++i) {
      scene.positions.push_back(scene.positions[i] + shift);
    }
    for (std::size_t i = 0; i < indices; ++i) {
      scene.indices.push_back(scene.indices[i] + static_cast<std::uint32_t>(copy * positions));
    }
    for (std::size_t i = 0; i < objects; ++i) {
      Object object = scene.objects[i];
      object.first_index += static_cast<std::uint32_t>(copy * indices);
      object.bounds = {object.bounds.min + shift, object.bounds.max + shift};
      scene.objects.push_back(object);
      scene.object_names.push_back(scene.object_names[i]);
    }
  }
  return scene;
}

struct Time {
  double all_s = 0.0;
  double alone_s = 0.0;  // outside of ranges
  double system_s =
      0.0;  // in the system, nearly all of it to clear memory that is touched for the first time
};

// Processor time, which other work on the machine changes little.
Time processTime() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return {seconds(usage.ru_utime) + seconds(usage.ru_stime), 0.0, seconds(usage.ru_stime)};
}

// prepare(parallel_for) is what is measured.
template <typename Prepare>
Time timeOf(int runs, const Prepare& prepare) {
  Time least;
  for (int run = 0; run < runs; ++run) {
    double in_ranges_s = 0.0;
    const ParallelFor timed = [&](std::uint32_t count, const RangeBody& body) {
      const Time start = processTime();
      serialFor(count, body);
      in_ranges_s += processTime().all_s - start.all_s;
    };
    const Time start = processTime();
    prepare(timed);
    const Time end = processTime();
    const double all_s = end.all_s - start.all_s;
    if (run == 0 || all_s < least.all_s) {
      least = {all_s, all_s - in_ranges_s, end.system_s - start.system_s};
    }
  }
  return least;
}

std::string textOf(const Time& time, std::size_t triangles) {
  const double count = static_cast<double>(std::max<std::size_t>(triangles, 1));
  const double percent = time.all_s > 0.0 ? 100.0 / time.all_s : 0.0;
  return fmt::format("{:6.2f} {:5.2f} {:3.0f}% {:3.0f}%", time.all_s, 1e6 * time.all_s / count,
                     percent * time.alone_s, percent * time.system_s);
}

void measure(const std::string& name, const Options& options) {
  BenchmarkScene given = loadScene(name, "preparation");
  const BenchmarkScene loaded(repeated(std::move(given.scene), options.triangles));
  const SceneView scene = loaded.scene.view();
  const std::size_t triangles = scene.indices.size() / 3;
  const auto timeOfStage = [&](const char* stage, const auto& prepare) {
    return options.wants(stage) ? timeOf(options.runs, prepare) : Time{};
  };
  const Time occluders =
      timeOfStage("occluders", [&](const ParallelFor& threads) { findOccluders(scene, {}, threads); });
  const Time surfaces =
      timeOfStage("surfaces", [&](const ParallelFor& threads) { findSurfaces(scene, {}, threads); });
  const Time boxes =
      timeOfStage("boxes", [&](const ParallelFor& threads) { findObjectBoxes(scene, {}, threads); });
  const auto hierarchyOf = [&](HierarchyKind kind) {
    HierarchySettings settings;
    settings.kind = kind;
    return buildHierarchy(loaded.bounds, loaded.cost, settings);
  };
  const auto timeOfKind = [&](HierarchyKind kind) {
    return timeOfStage("hierarchy", [&](const ParallelFor&) { hierarchyOf(kind); });
  };
  const Time bvh = timeOfKind(HierarchyKind::kBvh), kd = timeOfKind(HierarchyKind::kKdTree);
  const Hierarchy binary = hierarchyOf(HierarchyKind::kBvh);
  const Time wide =
      timeOfStage("hierarchy", [&](const ParallelFor&) { hierarchy::collapse(binary, loaded.bounds); });
  fmt::print("{:<36} {:>8} {:>9} | {} | {} | {} | {:5.2f} | {:5.2f} | {:5.2f} | {:7.2f} | {:7.2f}\n",
             name.substr(name.rfind('/') + 1), scene.objects.size(), triangles, textOf(occluders, triangles),
             textOf(surfaces, triangles), textOf(boxes, triangles), bvh.all_s, wide.all_s, kd.all_s,
             surfaces.all_s + boxes.all_s + bvh.all_s + wide.all_s, occluders.all_s + bvh.all_s);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  Options options = optionsOf(argc, argv);
  if (options.scenes.empty()) {
    options.scenes = usualScenes(options);
  }
  fmt::print(
      "Seconds; beside the first three also microseconds a triangle and the share alone. Default: what "
      "depth-pyramid needs, all but occluders and the kd-tree. Occluders: they and the bvh.\n");
  fmt::print("{:<36} {:>8} {:>9} | {:>17} | {:>17} | {:>17} | {:>5} | {:>5} | {:>5} | {:>7} | {:>7}\n", "",
             "objects", "triangles", "occluders", "surfaces", "object boxes", "bvh", "wide", "kd", "default",
             "occl.");
  for (const std::string& scene : options.scenes) {
    measure(scene, options);
  }
}
