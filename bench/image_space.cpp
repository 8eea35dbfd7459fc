// What does a frame cost in image space? Whole frames of the culler with maps of occluders of several sizes
// and with several numbers of occluders, beside the occlusion tree and beside rays, on the same views, in one
// run:
//
//   tree      occlusion tree FME
//   pyramid   depth pyramid
//   opacity   opacity map
//   rays      one ray for each pixel (Embree) to a depth buffer of all triangles, then the rectangle of every
//             box that the frustum holds against it, pixel by pixel. Not conservative. Build: the rays. Walk:
//             the boxes.
//
// Each method has a few frames in a row, so that it finds its own data in the caches; the order of the
// methods rotates. us: medians of the frames. kept: objects, means.
// "/ tree" and "/ rays" are of the totals, the rays being those of the same size.
//
//   image_space [--benchmark_min_time=SHORT] [SCENE...]    SCENE: a file with walk.path.json beside it, or
//   demo:... ; views are the scene's path "views", otherwise its walk.

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include "bench/benchmark_scene.h"
#include "bench/map_methods.h"
#include "bench/measuring.h"
#include "bench/ray_depth.h"
#include "tests/support/any_culler.h"

namespace {

using namespace sightline;
using namespace sightline::bench;

constexpr std::uint32_t kCounts[] = {16, 32, 64, 256};
constexpr std::size_t kCountedViews = 3;
constexpr std::size_t kStepsInTurn = kUncounted + kCountedViews;  // a view of a path of views

// One method over all frames.
struct Measured {
  std::vector<double> choose_us, build_us, walk_us, total_us, kept;

  void add(double choose, double build, double walk, std::size_t objects) {
    choose_us.push_back(choose);
    build_us.push_back(build);
    walk_us.push_back(walk);
    total_us.push_back(choose + build + walk);
    kept.push_back(static_cast<double>(objects));
  }
};

// A scene with all that the methods need of it.
struct Prepared {
  BenchmarkScene scene;
  Hierarchy hierarchy;
  OccluderSet occluders;
  RayDepth rays;
  AnyCuller frustum;
  std::vector<ObjectId> kept_by_rays{};

  explicit Prepared(const std::string& name)
      : scene(loadScene(name, "image_space")),
        hierarchy(buildHierarchy(scene.bounds, scene.cost)),
        occluders(findOccluders(scene.scene.view())),
        rays(scene.scene.view()),
        frustum(hierarchy, scene.bounds, occluders, {.method = AnyMethod::kFrustum}) {}
};

std::vector<Method> methodsOf(bool brief) {
  std::vector<Method> methods{cullerMethod("tree", AnyMethod::kOcclusionTree, 64)};
  const std::size_t sizes = std::size(kMapSizes) - (brief ? 1 : 0);
  addMapMethods(methods, std::span(kMapSizes).first(sizes), kCounts);
  return methods;
}

void castRays(Prepared& scene, const Method& method, const Step& step, Measured& measured) {
  const RayTimes times = cullByRays(scene.rays, scene.frustum, scene.scene.bounds, step.view,
                                    method.size.width, method.size.height, scene.kept_by_rays);
  measured.add(0.0, times.rays_us, times.boxes_us, scene.kept_by_rays.size());
}

std::vector<Measured> measure(Prepared& scene, std::span<const Method> methods, std::span<const Step> steps) {
  std::vector<AnyCuller> cullers;
  for (const Method& method : methods) {
    cullers.emplace_back(scene.hierarchy, scene.scene.bounds, scene.occluders, method.settings);
  }
  std::vector<Measured> measured(methods.size());
  const auto frame = [&](std::size_t m, const Step& step) {
    if (methods[m].kind == MethodKind::kRays) {
      if (step.counted) {
        castRays(scene, methods[m], step, measured[m]);
      }
      return;
    }
    cullers[m].cull(step.view);
    if (step.counted) {
      const CullStats& stats = cullers[m].stats();
      measured[m].add(stats.choose_us, stats.build_us, stats.traverse_us, cullers[m].visible().size());
    }
  };
  for (std::size_t first = 0, group = 0; first < steps.size(); first += kStepsInTurn, ++group) {
    for (std::size_t turn = 0; turn < methods.size(); ++turn) {
      const std::size_t m = (group + turn) % methods.size();
      for (std::size_t i = first; i < std::min(first + kStepsInTurn, steps.size()); ++i) {
        frame(m, steps[i]);
      }
    }
  }
  return measured;
}

// Total of the rays of the same size.
double raysOf(std::span<const Method> methods, std::span<const Measured> measured, MapSize size) {
  for (std::size_t m = 0; m < methods.size(); ++m) {
    if (methods[m].kind == MethodKind::kRays && methods[m].size == size) {
      return medianOf(measured[m].total_us);
    }
  }
  return 0.0;
}

void printScene(const std::string& name, bool brief) {
  Prepared scene(name);
  const std::vector<Method> methods = methodsOf(brief);
  const std::vector<Step> steps = stepsOf(scene.scene, brief ? 4 : 60, kCountedViews);
  const std::vector<Measured> measured = measure(scene, methods, steps);
  const Measured& tree = measured[0];
  fmt::print("\n{}: {} objects, {} occluders, {} views\n", name, scene.scene.bounds.size(),
             scene.occluders.occluders.size(), tree.kept.size());
  fmt::print("{:<9}{:>9}{:>6} |{:>10}{:>10}{:>10}{:>10}{:>8}{:>8} |{:>9}{:>8}\n", "", "map", "k", "choose us",
             "build us", "walk us", "total us", "/ tree", "/ rays", "kept", "/ tree");
  for (std::size_t m = 0; m < methods.size(); ++m) {
    const Method& method = methods[m];
    const Measured& row = measured[m];
    const bool rays = method.kind == MethodKind::kRays;
    const double total = medianOf(row.total_us);
    fmt::print("{:<9}{:>9}{:>6} |{:>10.1f}{:>10.1f}{:>10.1f}{:>10.1f}{:>8.2f}{:>8} |{:>9.1f}{:>8.3f}\n",
               method.name, method.sizeText(), rays ? "" : std::to_string(method.settings.occluder_count),
               medianOf(row.choose_us), medianOf(row.build_us), medianOf(row.walk_us), total,
               total / medianOf(tree.total_us),
               method.hasMap() ? fmt::format("{:.3f}", total / raysOf(methods, measured, method.size)) : "",
               meanOf(row.kept), meanOf(row.kept) / meanOf(tree.kept));
  }
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const Arguments arguments = argumentsOf(argc, argv);
  std::vector<std::string> scenes = arguments.words;
  if (scenes.empty()) {
    scenes = {"demo:boxes?buildings=1333&boxes=6667", "demo:boxes?buildings=8333&boxes=41667", "demo:city"};
    if (!arguments.brief) {
      scenes.insert(scenes.begin() + 2, "demo:boxes?buildings=33333&boxes=166667");
    }
  }
  for (const std::string& scene : scenes) {
    printScene(scene, arguments.brief);
  }
}
