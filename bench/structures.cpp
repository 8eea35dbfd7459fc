// Which structure is the best for the same occluders? Supporting planes against occlusion trees, on the same
// frames of a walk, in one run:
//
//   FME, FSE       occlusion trees; boxes are classified whole (M) or split (S)
//   eye            supporting planes, their form through the eye
//   eye, single    without joint occlusion
//   box, kept      the form through the boxes, relations kept from frame to frame
//   box, new       nothing kept
//
// Every culler ranks all occluders of the scene in every frame, so that all choose the same; the choice is
// not in the times. The order of the cullers rotates from frame to frame. us: medians of the frames. Other
// columns: means. tests: boxes of nodes and objects asked of the structure. The first frames are not counted.
//
// And what is kept in memory, by the size of the city: relations (the most of any frame of the walk) and the
// occluder database, both with the default settings.
//
//   structures [--benchmark_min_time=SHORT] [SCENE...]    SCENE: a file with walk.path.json beside it, or
//   demo:...

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "bench/benchmark_scene.h"
#include "bench/measuring.h"
#include "sightline/occluders/occluder_database.h"
#include "src/base/stopwatch.h"
#include "tests/support/any_culler.h"

namespace {

using namespace sightline;
using namespace sightline::bench;

constexpr std::size_t kWarmUp = 10;  // frames
constexpr std::uint32_t kCounts[] = {8, 16, 32, 64, 128, 256};

struct Structure {
  const char* name;
  AnySettings settings;
};

constexpr Structure kStructures[] = {
    {"FME", {.variant = OcclusionTreeVariant::kFME}},
    {"FSE", {.variant = OcclusionTreeVariant::kFSE}},
    {"eye", {.method = AnyMethod::kSupportingPlanes}},
    {"eye, single",
     {.method = AnyMethod::kSupportingPlanes, .supporting_planes = {.joint_occlusion = false}}},
    {"box, kept", {.method = AnyMethod::kKeptPlanes}},
    {"box, new", {.method = AnyMethod::kKeptPlanes, .temporal_coherence = false}},
};
constexpr std::size_t kStructureCount = std::size(kStructures);

// One structure over all frames.
struct Measured {
  std::vector<double> build_us, walk_us, total_us, kept, tests;

  void add(const AnyCuller& culler) {
    const CullStats& stats = culler.stats();
    build_us.push_back(stats.build_us);
    walk_us.push_back(stats.traverse_us);
    total_us.push_back(stats.build_us + stats.traverse_us);
    kept.push_back(static_cast<double>(culler.visible().size()));
    tests.push_back(stats.nodes_tested + stats.objects_tested);
  }
};

// A database of one cell and one direction with all occluders: whatever a culler saw before, it chooses from
// all of them.
OccluderDatabase oneListOfAll(const OccluderSet& occluders) {
  const auto count = static_cast<std::uint32_t>(occluders.occluders.size());
  return OccluderDatabase::build(Hierarchy{}, occluders,
                                 {.directions = 1, .occluder_count = count, .view_angle_deg = 360.0});
}

std::vector<Measured> measure(const BenchmarkScene& scene, const Hierarchy& hierarchy,
                              const OccluderSet& occluders, const OccluderDatabase& all, std::uint32_t count,
                              std::size_t frames) {
  std::vector<AnyCuller> cullers;
  for (const Structure& structure : kStructures) {
    AnySettings settings = structure.settings;
    settings.use_lists = true;
    settings.occluder_count = count;
    cullers.emplace_back(hierarchy, scene.bounds, occluders, settings, AnyLists{.from_eye = &all});
  }
  std::vector<Measured> measured(kStructureCount);
  for (std::size_t frame = 0; frame < std::min(frames, scene.path.frames.size()); ++frame) {
    const View view = scene.path.view(frame, scene.scene.origin);
    for (std::size_t turn = 0; turn < kStructureCount; ++turn) {
      const std::size_t s = (frame + turn) % kStructureCount;
      cullers[s].cull(view);
      if (frame >= kWarmUp) {
        measured[s].add(cullers[s]);
      }
    }
  }
  return measured;
}

void printStructures(const std::string& name, std::size_t frames) {
  const BenchmarkScene scene = loadScene(name, "structures");
  const Hierarchy hierarchy = buildHierarchy(scene.bounds, scene.cost);
  const OccluderSet occluders = findOccluders(scene.scene.view());
  const OccluderDatabase all = oneListOfAll(occluders);
  fmt::print("\n{}: {} objects, {} occluders\n", name, scene.bounds.size(), occluders.occluders.size());
  fmt::print("{:>9}  {:<12}{:>10}{:>10}{:>10}{:>8}{:>9}{:>8}{:>9}\n", "occluders", "", "build us", "walk us",
             "total us", "/ FME", "kept", "/ FME", "tests");
  for (const std::uint32_t count : kCounts) {
    const std::vector<Measured> measured = measure(scene, hierarchy, occluders, all, count, frames);
    const Measured& fme = measured[0];
    for (std::size_t s = 0; s < kStructureCount; ++s) {
      const Measured& m = measured[s];
      fmt::print("{:>9}  {:<12}{:>10.1f}{:>10.1f}{:>10.1f}{:>8.2f}{:>9.1f}{:>8.3f}{:>9.0f}\n", count,
                 kStructures[s].name, medianOf(m.build_us), medianOf(m.walk_us), medianOf(m.total_us),
                 medianOf(m.total_us) / medianOf(fme.total_us), meanOf(m.kept),
                 meanOf(m.kept) / meanOf(fme.kept), meanOf(m.tests));
    }
    std::fflush(stdout);
  }
}

void printMemory(std::uint32_t copies, std::size_t frames) {
  const BenchmarkScene city(makeCity({.copies = copies}));
  const Hierarchy kd_tree = buildHierarchy(city.bounds, city.cost, {.kind = HierarchyKind::kKdTree});
  const Hierarchy bvh = buildHierarchy(city.bounds, city.cost);
  const OccluderSet occluders = findOccluders(city.scene.view());
  base::Stopwatch watch;
  const OccluderDatabase database = OccluderDatabase::build(kd_tree, occluders);
  const double build_s = 1e-6 * watch.lap();

  AnyCuller culler(bvh, city.bounds, occluders, {.method = AnyMethod::kKeptPlanes});
  std::uint64_t relation_bytes = 0, relations = 0;
  for (std::size_t frame = 0; frame < std::min(frames, city.path.frames.size()); ++frame) {
    culler.cull(city.path.view(frame, city.scene.origin));
    relation_bytes = std::max(relation_bytes, culler.statistic("relations", "bytes"));
    relations = std::max(relations, culler.statistic("relations", "kept"));
  }
  constexpr double kMiB = 1 << 20;
  fmt::print("{:>7}{:>9}{:>10}{:>10} |{:>11}{:>9.2f} |{:>9}{:>9.2f}{:>9.1f}\n", copies, city.bounds.size(),
             city.scene.view().indices.size() / 3, occluders.occluders.size(), relations,
             static_cast<double>(relation_bytes) / kMiB, database.cellCount(),
             static_cast<double>(database.bytes()) / kMiB, build_s);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const auto [scenes, brief] = argumentsOf(argc, argv);
  const std::size_t frames = brief ? kWarmUp + 30 : 400;
  for (const std::string& scene :
       scenes.empty() ? std::vector<std::string>{"demo:city", "demo:building"} : scenes) {
    printStructures(scene, frames);
  }
  if (!scenes.empty()) {
    return 0;
  }
  fmt::print("\nmemory\n{:>7}{:>9}{:>10}{:>10} |{:>11}{:>9} |{:>9}{:>9}{:>9}\n", "copies", "objects",
             "triangles", "occluders", "relations", "MiB", "cells", "MiB", "build s");
  for (const std::uint32_t copies : {3u, 30u, 300u}) {
    if (!brief || copies < 300) {
      printMemory(copies, frames);
    }
  }
}
