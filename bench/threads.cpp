// What do threads give? Whole frames of the default method, wall-clock time, with 1, 2, 4, 8 and 16 threads
// of oneTBB as far as the machine has cores: median and mean of the frames, and how many times faster the
// mean is than with one thread. The answers are compared. Then the same of preparing the scene: surfaces,
// boxes of objects, occluders.
//
//   threads [SCENE...]

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include "bench/benchmark_scene.h"
#include "bench/measuring.h"
#include "sightline/culling/culler.h"
#include "sightline/culling/depth_pyramid_method.h"
#include "sightline/hierarchy/hierarchy.h"
#include "sightline/occluders/occluder_set.h"
#include "sightline/occluders/surface_set.h"
#include "sightline/scene/object_boxes.h"
#include "tools/sightline/command_line/threads.h"

namespace {

using namespace sightline;
using namespace sightline::bench;

constexpr std::size_t kFrames = 100;
constexpr int kRounds = 5;

std::vector<std::uint32_t> threadCounts() {
  std::vector<std::uint32_t> counts;
  for (std::uint32_t count = 1; count <= std::min(16u, std::thread::hardware_concurrency()); count *= 2) {
    counts.push_back(count);
  }
  return counts;
}

struct Prepared {
  Prepared(const BenchmarkScene& loaded, const ParallelFor& parallel_for) {
    const SceneView scene = loaded.scene.view();
    surfaces_us = microseconds([&] { surfaces = findSurfaces(scene, {}, parallel_for); });
    boxes_us = microseconds([&] { boxes = findObjectBoxes(scene, {}, parallel_for); });
    occluders_us = microseconds([&] { occluders = findOccluders(scene, {}, parallel_for); });
    hierarchy = buildHierarchy(loaded.bounds, loaded.cost);
  }

  SurfaceSet surfaces;
  ObjectBoxes boxes;
  OccluderSet occluders;
  Hierarchy hierarchy;
  double surfaces_us = 0.0, boxes_us = 0.0, occluders_us = 0.0;
};

void measureFrames(const BenchmarkScene& loaded, const Prepared& prepared, std::uint32_t width,
                   std::uint32_t height) {
  const CullingScene scene{.hierarchy = &prepared.hierarchy,
                           .object_bounds = loaded.bounds,
                           .object_boxes = &prepared.boxes,
                           .surfaces = &prepared.surfaces};
  const std::size_t frames = std::min(kFrames, loaded.path.frames.size());
  double alone = 0.0;
  std::vector<std::vector<ObjectId>> expected;
  for (const std::uint32_t count : threadCounts()) {
    // One count after the other: idle threads of another pool would take part of the processor.
    const tool::Threads threads(count);
    std::vector<std::vector<double>> us(frames);
    bool same = true;
    for (int round = 0; round < kRounds; ++round) {
      Culler culler(scene, depthPyramid({.raster = {.width = width, .height = height}}));
      culler.setParallelFor(threads.parallelFor());
      for (std::size_t frame = 0; frame < frames; ++frame) {
        const View view = loaded.path.view(frame, loaded.scene.origin);
        us[frame].push_back(microseconds([&] { culler.cull(view); }));
        const std::vector<ObjectId> kept(culler.visible().begin(), culler.visible().end());
        if (expected.size() == frame) {
          expected.push_back(kept);
        }
        same = same && kept == expected[frame];
      }
    }
    std::vector<double> medians;
    for (const std::vector<double>& of_frame : us) {
      medians.push_back(medianOf(of_frame));
    }
    const double mean = meanOf(medians);
    alone = count == 1 ? mean : alone;
    fmt::print("{:>5}x{:<5} {:>8} {:>10.0f} {:>10.0f} {:>8.2f} {:>8}\n", width, height, count,
               medianOf(medians), mean, alone / mean, same ? "same" : "DIFFER");
    std::fflush(stdout);
  }
}

void measure(const std::string& name) {
  const BenchmarkScene loaded = loadScene(name, "threads");
  fmt::print("{}: {} objects\n{:>11} {:>8} {:>10} {:>10} {:>8} {:>8}\n", name, loaded.scene.objects.size(),
             "buffer", "threads", "median us", "mean us", "speed-up", "answers");
  const Prepared prepared(loaded, serialFor);
  measureFrames(loaded, prepared, 320, 180);
  measureFrames(loaded, prepared, 1280, 720);
  fmt::print("{:>11} {:>8} {:>10} {:>10} {:>10}\n", "preparing", "threads", "surfaces", "boxes",
             "occluders, ms");
  for (const std::uint32_t count : threadCounts()) {
    const tool::Threads threads(count);
    const Prepared again(loaded, threads.parallelFor());
    fmt::print("{:>11} {:>8} {:>10.1f} {:>10.1f} {:>10.1f}\n", "", count, again.surfaces_us * 1e-3,
               again.boxes_us * 1e-3, again.occluders_us * 1e-3);
    std::fflush(stdout);
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> scenes = argumentsOf(argc, argv).words;
  if (scenes.empty()) {
    scenes = {"demo:city", "demo:building", "demo:terrain"};
  }
  for (const std::string& scene : scenes) {
    measure(scene);
  }
}
