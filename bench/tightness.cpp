// How close to exact is what is kept? For each scene one table: kept / exact for frustum culling and for the
// occlusion tree's variants and supporting planes with 8 to 256 occluders, exact being what rays through the
// pixels of 1280 x 720 see (Embree).
//
// "boxes" is the best that any test of bounding boxes can do: the objects that are exactly visible, and those
// whose box shows although nothing of the object in it does (rays to points of the box's faces). What lies
// between it and the occlusion tree is due to the occluders: too few, too small, or not joined.
//
//   tightness [--step N] [SCENE...]    SCENE: a file with walk.path.json beside it, or demo:...

#include <fmt/format.h>

#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "bench/benchmark_scene.h"
#include "oracle/exact_visibility.h"
#include "oracle/ray_scene.h"
#include "tests/support/any_culler.h"

namespace {

using namespace sightline;
using namespace sightline::bench;

struct Configuration {
  std::string name;
  AnySettings settings;
};

std::vector<Configuration> configurations() {
  std::vector<Configuration> all;
  all.push_back({"frustum", {.method = AnyMethod::kFrustum}});
  const std::pair<const char*, AnySettings> structures[] = {
      {"FSE", {.variant = OcclusionTreeVariant::kFSE}},
      {"FSC", {.variant = OcclusionTreeVariant::kFSC}},
      {"FME", {.variant = OcclusionTreeVariant::kFME}},
      {"FMC", {.variant = OcclusionTreeVariant::kFMC}},
      {"planes", {.method = AnyMethod::kSupportingPlanes}}};
  for (const auto& [name, settings] : structures) {
    for (const std::uint32_t count : {8u, 16u, 32u, 64u, 128u, 256u}) {
      all.push_back({fmt::format("{} {:3}", name, count), settings});
      all.back().settings.occluder_count = count;
    }
  }
  return all;
}

bool insideFrustum(const Frustum& frustum, const Vec3d& point) {
  for (const Plane& plane : frustum.planes) {
    if (plane.evaluate(point) < 0.0) {
      return false;
    }
  }
  return true;
}

// Whether one of 256 random points on the faces of the box towards the eye is seen.
bool boxShows(const RayScene& rays, const SceneView& scene, const View& view, const Box& box,
              std::mt19937& random) {
  const Frustum frustum = frustumOf(view);
  const auto unit = [&] { return static_cast<double>(random()) * 0x1p-32; };
  std::vector<RayHit> hits;
  for (int round = 0; round < 256; ++round) {
    const int axis = round % 3;
    Vec3d point;
    for (int a = 0; a < 3; ++a) {
      point[a] = box.min[a] + unit() * (static_cast<double>(box.max[a]) - box.min[a]);
    }
    if (view.eye[axis] >= box.min[axis] && view.eye[axis] <= box.max[axis]) {
      continue;
    }
    point[axis] = view.eye[axis] < box.min[axis] ? box.min[axis] : box.max[axis];
    if (!insideFrustum(frustum, point)) {
      continue;
    }
    RayScene::Batch batch;
    const double near = view.z_near / dot(view.forward, normalized(point - view.eye));
    const Vec3d start = view.eye + normalized(point - view.eye) * near;
    batch[0] = {Vec3f(start), Vec3f(point - start), 0.99999f};
    hits.clear();
    rays.trace(batch, 1, false, hits);
    bool blocked = false;
    for (const RayHit& hit : hits) {
      blocked |= scene.materialOf(scene.objects[hit.object.value]).opaque();
    }
    if (!blocked) {
      return true;
    }
  }
  const Vec3d eye = view.eye;
  return eye.x >= box.min.x && eye.y >= box.min.y && eye.z >= box.min.z && eye.x <= box.max.x &&
         eye.y <= box.max.y && eye.z <= box.max.z;
}

void table(const std::string& name, std::size_t step) {
  const BenchmarkScene loaded = loadScene(name, "tightness");
  const SceneView scene = loaded.scene.view();
  const Hierarchy hierarchy = buildHierarchy(loaded.bounds, loaded.cost);
  const OccluderSet occluders = findOccluders(scene);
  const ExactVisibility exact(scene);
  const RayScene rays(scene);
  std::mt19937 random(1);

  std::vector<Configuration> all = configurations();
  std::vector<AnyCuller> cullers;
  for (const Configuration& configuration : all) {
    cullers.emplace_back(hierarchy, loaded.bounds, occluders, configuration.settings);
  }
  std::vector<std::uint64_t> kept(all.size());
  std::uint64_t seen = 0, by_box = 0;
  for (std::size_t frame = 0; frame < loaded.path.frames.size(); ++frame) {
    const View view = loaded.path.view(frame, loaded.scene.origin);
    for (std::size_t c = 0; c < cullers.size(); ++c) {
      cullers[c].cull(view);
    }
    if (frame % step != 0) {
      continue;
    }
    std::vector<bool> visible(scene.objects.size());
    for (const SeenPoint& witness : exact.visibleThroughPixels(view, 1280, 720)) {
      visible[witness.object.value] = true;
      ++seen;
    }
    for (std::size_t c = 0; c < cullers.size(); ++c) {
      kept[c] += cullers[c].visible().size();
    }
    for (const ObjectId object : cullers[0].visible()) {
      by_box +=
          visible[object.value] || boxShows(rays, scene, view, loaded.bounds[object.value], random) ? 1 : 0;
    }
  }
  const auto ratio = [&](std::uint64_t count) {
    return static_cast<double>(count) / static_cast<double>(seen);
  };
  fmt::print("\n{}: exact {}, kept / exact: boxes {:.2f}\n", name, seen, ratio(by_box));
  for (std::size_t c = 0; c < all.size(); ++c) {
    fmt::print("{}{:<10}{:8.2f}", c % 6 == 1 ? "\n" : "  ", all[c].name, ratio(kept[c]));
  }
  fmt::print("\n");
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> scenes;
  std::size_t step = 10;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--step" && i + 1 < argc) {
      step = std::max(1, std::atoi(argv[++i]));
    } else if (argument.rfind("--", 0) != 0) {
      scenes.push_back(argument);
    }
  }
  if (scenes.empty()) {
    scenes = {"demo:city", "demo:building"};
  }
  for (const std::string& scene : scenes) {
    table(scene, step);
  }
}
