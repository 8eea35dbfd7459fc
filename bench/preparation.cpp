// How long does it take to prepare a scene, stage by stage, as the scene grows? On one thread, the least of
// two runs; and the share of that time that is spent outside of the ranges handed to a ParallelFor, which
// more threads do not make shorter. The city of boxes has small closed objects, the terrain connected
// surfaces of which every triangle is a polygon of its own.
//
//   preparation [SCENE...]

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "bench/benchmark_scene.h"
#include "bench/measuring.h"
#include "sightline/hierarchy/hierarchy.h"
#include "sightline/occluders/occluder_set.h"
#include "sightline/occluders/surface_set.h"
#include "sightline/scene/object_boxes.h"

namespace {

using namespace sightline;
using namespace sightline::bench;

struct Time {
  double all_us = 0.0;
  double alone_us = 0.0;  // outside of ranges
};

// prepare(parallel_for) is what is measured.
template <typename Prepare>
Time timeOf(const Prepare& prepare) {
  Time least;
  for (int run = 0; run < 2; ++run) {
    double in_ranges_us = 0.0;
    const ParallelFor timed = [&](std::uint32_t count, const RangeBody& body) {
      in_ranges_us += microseconds([&] { serialFor(count, body); });
    };
    const double all_us = microseconds([&] { prepare(timed); });
    if (run == 0 || all_us < least.all_us) {
      least = {all_us, all_us - in_ranges_us};
    }
  }
  return least;
}

std::string textOf(const Time& time) {
  return fmt::format("{:8.2f} {:3.0f}%", time.all_us * 1e-6, 100.0 * time.alone_us / time.all_us);
}

void measure(const std::string& name) {
  const BenchmarkScene loaded = loadScene(name, "preparation");
  const SceneView scene = loaded.scene.view();
  const Time occluders = timeOf([&](const ParallelFor& threads) { findOccluders(scene, {}, threads); });
  const Time surfaces = timeOf([&](const ParallelFor& threads) { findSurfaces(scene, {}, threads); });
  const Time boxes = timeOf([&](const ParallelFor& threads) { findObjectBoxes(scene, {}, threads); });
  const auto hierarchyOf = [&](HierarchyKind kind) {
    return timeOf([&](const ParallelFor&) {
      HierarchySettings settings;
      settings.kind = kind;
      buildHierarchy(loaded.bounds, loaded.cost, settings);
    });
  };
  const Time bvh = hierarchyOf(HierarchyKind::kBvh), kd = hierarchyOf(HierarchyKind::kKdTree);
  fmt::print("{:<34} {:>8} {:>9} | {} | {} | {} | {:7.2f} | {:7.2f} | {:7.2f}\n",
             name.substr(name.rfind('/') + 1), scene.objects.size(), scene.indices.size() / 3,
             textOf(occluders), textOf(surfaces), textOf(boxes), bvh.all_us * 1e-6, kd.all_us * 1e-6,
             (occluders.all_us + surfaces.all_us + boxes.all_us + bvh.all_us + kd.all_us) * 1e-6);
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
  fmt::print("{:<34} {:>8} {:>9} | {:>13} | {:>13} | {:>13} | {:>7} | {:>7} | {:>7}\n",
             "seconds, and share alone", "objects", "triangles", "occluders", "surfaces", "object boxes",
             "bvh", "kd-tree", "all");
  for (const std::string& scene : scenes) {
    measure(scene);
  }
}
