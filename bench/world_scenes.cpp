// How much of a scene is drawn, and how much is kept, where it is culled as a changing world? Each object is
// an instance of a mesh of its own, along every second of the first 170 frames of the scene's walk.
//
//   kept       instances, a frame
//   edges      of the boundaries that are drawn in a frame: the mean, and the most in one
//   drawn      instances and joins that are drawn, a frame
//   boxes      that are tested, a frame
//
//   world_scenes [--joined] [--movers N] SCENE...
//
// --joined: the instances of each cell of a grid, 4 cells along the scene's longest side, are one join.
// --movers: so many boxes more, which all move in every frame; one of them is replaced in each.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/benchmark_scene.h"
#include "bench/measuring.h"
#include "sightline/world/world.h"
#include "sightline/world/world_culler.h"

namespace {

using namespace sightline;
using namespace sightline::bench;

constexpr std::size_t kFrames = 170, kStep = 2;
constexpr double kCellsAlong = 4.0;

WorldMesh meshOf(const Scene& scene, const Object& object) {
  const std::span<const std::uint32_t> indices = scene.view().indicesOf(object);
  const Material& material = scene.materials[object.material.value];
  return valueOrExit(makeMesh({.positions = scene.positions.data(),
                               .vertex_count = static_cast<std::uint32_t>(scene.positions.size()),
                               .indices = indices.data(),
                               .index_count = indices.size()},
                              {.opacity = material.opacity, .double_sided = material.double_sided}),
                     "world_scenes");
}

void joinCells(World& world, const std::vector<InstanceId>& ids) {
  Box all;
  for (const InstanceId id : ids) {
    all.extend(world.boundsOf(id));
  }
  const double cell = maxComponent(Vec3d(all.extent())) / kCellsAlong;
  std::map<std::array<int, 3>, std::vector<InstanceId>> cells;
  for (const InstanceId id : ids) {
    const Vec3d at = center(world.boundsOf(id)) / cell;
    cells[{static_cast<int>(std::floor(at.x)), static_cast<int>(std::floor(at.y)),
           static_cast<int>(std::floor(at.z))}]
        .push_back(id);
  }
  for (const auto& [place, members] : cells) {
    world.addJoin(makeJoin(world.joinInput(members)));
  }
}

// Boxes near the walk, each of which goes around its place.
class Movers {
 public:
  Movers(World& world, const BenchmarkScene& loaded, std::size_t count) : world_(world) {
    if (count == 0) {
      return;
    }
    const Scene cube = cubeScene();
    mesh_ = world.addMesh(meshOf(cube, cube.objects[0]));
    std::mt19937 engine(1);
    const auto number = [&](double low, double high) {
      return low + (high - low) * static_cast<double>(engine()) * 0x1p-32;
    };
    for (std::size_t i = 0; i < count; ++i) {
      const View view = loaded.path.view(engine() % loaded.path.frames.size(), loaded.scene.origin);
      Mat4 m;
      const double size = number(0.5, 2.5);
      for (int axis = 0; axis < 3; ++axis) {
        m(axis, axis) = size;
        m(axis, 3) = view.eye[axis] + (axis == 1 ? number(-1, 1) : number(-20, 20));
      }
      places_.push_back(m);
      ids_.push_back(world.add({.mesh = mesh_, .world_from_mesh = m, .moves = true}));
    }
  }

  void move(std::size_t frame) {
    goals_ = places_;
    for (std::size_t i = 0; i < goals_.size(); ++i) {
      const double turn = 0.05 * static_cast<double>(frame) + static_cast<double>(i);
      goals_[i](0, 3) += 3.0 * std::sin(turn);
      goals_[i](2, 3) += 3.0 * std::cos(turn);
    }
    world_.setTransforms(ids_, goals_);
    if (!ids_.empty()) {
      const std::size_t i = frame % ids_.size();
      world_.remove(ids_[i]);
      ids_[i] = world_.add({.mesh = mesh_, .world_from_mesh = goals_[i], .moves = true});
    }
  }

 private:
  static Scene cubeScene() {
    Scene scene;
    scene.materials.resize(1);
    for (int i = 0; i < 8; ++i) {
      scene.positions.push_back(
          {(i & 1) != 0 ? 0.5f : -0.5f, (i & 2) != 0 ? 1.0f : 0.0f, (i & 4) != 0 ? 0.5f : -0.5f});
    }
    scene.indices = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                     2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
    scene.objects.resize(1);
    scene.objects[0].index_count = static_cast<std::uint32_t>(scene.indices.size());
    return scene;
  }

  World& world_;
  MeshId mesh_;
  std::vector<InstanceId> ids_;
  std::vector<Mat4> places_, goals_;
};

void measure(const std::string& name, bool joined, std::size_t mover_count) {
  const BenchmarkScene loaded = loadScene(name, "world_scenes");
  World world;
  std::vector<Instance> instances;
  for (const Object& object : loaded.scene.objects) {
    instances.push_back({.mesh = world.addMesh(meshOf(loaded.scene, object))});
  }
  std::vector<InstanceId> ids;
  world.add(instances, ids);
  if (joined) {
    joinCells(world, ids);
  }
  Movers movers(world, loaded, mover_count);
  WorldCuller culler;
  std::vector<double> kept, edges, drawn, boxes;
  for (std::size_t frame = 0; frame < std::min(kFrames, loaded.path.frames.size()); frame += kStep) {
    movers.move(frame);
    world.tidy();
    culler.cull(world, loaded.path.view(frame, loaded.scene.origin));
    kept.push_back(static_cast<double>(culler.visible().size()));
    edges.push_back(culler.stats().edges);
    drawn.push_back(culler.stats().occluders);
    boxes.push_back(culler.stats().boxes_tested);
  }
  fmt::print("{:>8.1f} {:>8.0f} {:>8.0f} {:>8.1f} {:>8.0f}  {}\n", meanOf(kept), meanOf(edges),
             edges.empty() ? 0.0 : *std::max_element(edges.begin(), edges.end()), meanOf(drawn),
             meanOf(boxes), name);
}

}  // namespace

int main(int argc, char** argv) {
  bool joined = false;
  std::size_t mover_count = 0;
  std::vector<std::string> scenes;
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    if (argument == "--joined") {
      joined = true;
    } else if (argument == "--movers" && i + 1 < argc) {
      mover_count = std::strtoul(argv[++i], nullptr, 10);
    } else if (argument.rfind("--benchmark_min_time", 0) != 0) {
      scenes.emplace_back(argument);
    }
  }
  fmt::print("{:>8} {:>8} {:>8} {:>8} {:>8}\n", "kept", "edges", "most", "drawn", "boxes");
  for (const std::string& scene : scenes) {
    measure(scene, joined, mover_count);
  }
  return 0;
}
