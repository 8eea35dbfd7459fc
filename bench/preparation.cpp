// How long does it take to prepare a scene, stage by stage, as the scene grows? Processor time of one thread,
// the least of two runs; and the share of that time that is spent outside of the ranges handed to a
// ParallelFor, which more threads do not make shorter. The city of boxes has small closed objects, the
// terrain connected surfaces of which every triangle is a polygon of its own.
//
//   preparation [SCENE...]

#include <fmt/format.h>

#include <cstdio>
#include <ctime>
#include <string>
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

struct Time {
  double all_s = 0.0;
  double alone_s = 0.0;  // outside of ranges
};

// Processor time, which other work on the machine changes little.
double secondsOf(const auto& function) {
  const std::clock_t start = std::clock();
  function();
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

// prepare(parallel_for) is what is measured.
template <typename Prepare>
Time timeOf(const Prepare& prepare) {
  Time least;
  for (int run = 0; run < 2; ++run) {
    double in_ranges_s = 0.0;
    const ParallelFor timed = [&](std::uint32_t count, const RangeBody& body) {
      in_ranges_s += secondsOf([&] { serialFor(count, body); });
    };
    const double all_s = secondsOf([&] { prepare(timed); });
    if (run == 0 || all_s < least.all_s) {
      least = {all_s, all_s - in_ranges_s};
    }
  }
  return least;
}

std::string textOf(const Time& time) {
  return fmt::format("{:8.2f} {:3.0f}%", time.all_s,
                     time.all_s > 0.0 ? 100.0 * time.alone_s / time.all_s : 0.0);
}

void measure(const std::string& name) {
  const BenchmarkScene loaded = loadScene(name, "preparation");
  const SceneView scene = loaded.scene.view();
  const Time occluders = timeOf([&](const ParallelFor& threads) { findOccluders(scene, {}, threads); });
  const Time surfaces = timeOf([&](const ParallelFor& threads) { findSurfaces(scene, {}, threads); });
  const Time boxes = timeOf([&](const ParallelFor& threads) { findObjectBoxes(scene, {}, threads); });
  const auto hierarchyOf = [&](HierarchyKind kind) {
    HierarchySettings settings;
    settings.kind = kind;
    return buildHierarchy(loaded.bounds, loaded.cost, settings);
  };
  const auto timeOfKind = [&](HierarchyKind kind) {
    return timeOf([&](const ParallelFor&) { hierarchyOf(kind); });
  };
  const Time bvh = timeOfKind(HierarchyKind::kBvh), kd = timeOfKind(HierarchyKind::kKdTree);
  const Hierarchy binary = hierarchyOf(HierarchyKind::kBvh);
  const Time wide = timeOf([&](const ParallelFor&) { hierarchy::collapse(binary, loaded.bounds); });
  fmt::print("{:<34} {:>8} {:>9} | {} | {} | {} | {:7.2f} | {:7.2f} | {:7.2f} | {:7.2f}\n",
             name.substr(name.rfind('/') + 1), scene.objects.size(), scene.indices.size() / 3,
             textOf(occluders), textOf(surfaces), textOf(boxes), bvh.all_s, wide.all_s, kd.all_s,
             occluders.all_s + surfaces.all_s + boxes.all_s + bvh.all_s + wide.all_s + kd.all_s);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> scenes = argumentsOf(argc, argv).words;
  if (scenes.empty()) {
    for (const char* count : {"10000", "100000", "1000000"}) {
      scenes.push_back(fmt::format("demo:boxes?boxes={}", count));
    }
    for (const char* count : {"10000", "100000", "1000000", "10000000"}) {
      scenes.push_back(fmt::format("demo:terrain?triangles={}", count));
    }
  }
  fmt::print("{:<34} {:>8} {:>9} | {:>13} | {:>13} | {:>13} | {:>7} | {:>7} | {:>7} | {:>7}\n",
             "seconds, and share alone", "objects", "triangles", "occluders", "surfaces", "object boxes",
             "bvh", "wide", "kd-tree", "all");
  for (const std::string& scene : scenes) {
    measure(scene);
  }
}
