// A world that changes: a wall comes down, and what stood behind it is seen in the very next frame.

#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <utility>
#include <vector>

#include "sightline/world/world.h"
#include "sightline/world/world_culler.h"

using namespace sightline;

namespace {

// A vertex as a renderer keeps it.
struct Vertex {
  float position[3];
  float normal[3];
};

// A box of one metre, four vertices a face, 16-bit indices.
WorldMesh unitCube() {
  std::vector<Vertex> vertices;
  std::vector<std::uint16_t> indices;
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {0.0f, 1.0f}) {
      for (const std::array<float, 2> at :
           {std::array{0.0f, 0.0f}, {1.0f, 0.0f}, {1.0f, 1.0f}, {0.0f, 1.0f}}) {
        Vertex vertex{};
        vertex.position[axis] = side;
        vertex.position[(axis + 1) % 3] = at[0];
        vertex.position[(axis + 2) % 3] = at[1];
        vertex.normal[axis] = 2.0f * side - 1.0f;
        vertices.push_back(vertex);
      }
      const auto first = static_cast<std::uint16_t>(vertices.size() - 4);
      for (const int corner : side > 0.0f ? std::array{0, 1, 2, 0, 2, 3} : std::array{0, 2, 1, 0, 3, 2}) {
        indices.push_back(static_cast<std::uint16_t>(first + corner));
      }
    }
  }
  Result<WorldMesh> mesh = makeMesh({.positions = vertices[0].position,
                                     .position_stride = sizeof(Vertex),
                                     .vertex_count = static_cast<std::uint32_t>(vertices.size()),
                                     .indices = indices.data(),
                                     .index_bytes = 2,
                                     .index_count = indices.size()});
  if (!mesh) {
    std::fprintf(stderr, "%s\n", mesh.error().message.c_str());
    std::exit(1);
  }
  return std::move(*mesh);
}

Mat4 boxAt(const Vec3d& corner, const Vec3d& size) {
  Mat4 world_from_mesh;
  for (int axis = 0; axis < 3; ++axis) {
    world_from_mesh(axis, axis) = size[axis];
    world_from_mesh(axis, 3) = corner[axis];
  }
  return world_from_mesh;
}

void print(const char* when, const WorldCuller& culler) {
  std::printf("%s:", when);
  for (const InstanceId id : culler.visible()) {
    std::printf(" %u", id.value);
  }
  std::printf("\n");
}

}  // namespace

int main() {
  World world;
  const MeshId box = world.addMesh(unitCube());  // once a mesh; its instances share what was found in it
  const InstanceId wall = world.add({.mesh = box, .world_from_mesh = boxAt({-8, 0, -11}, {16, 6, 1})});
  const InstanceId crate = world.add({.mesh = box, .world_from_mesh = boxAt({-2, 0, -20}, {1, 1, 1})});
  for (const double x : {3.0, 16.0}) {
    world.add({.mesh = box, .world_from_mesh = boxAt({x, 0, -20}, {1, 1, 1})});  // instances 2 and 3
  }

  View view;
  view.eye = {0, 1.7, 0};
  setOrientation(view, /*forward=*/{0, 0, -1}, /*up_hint=*/{0, 1, 0});
  WorldCuller culler;  // one for each view of a frame: the camera's, a shadow's, a reflection's
  culler.cull(world, view);
  print("the wall stands", culler);

  world.setTransform(crate, boxAt({-17, 0, -20}, {1, 1, 1}));  // in any frame
  world.tidy();                                                // once a frame
  culler.cull(world, view);
  print("the crate has moved", culler);

  world.remove(wall);
  culler.cull(world, view);
  print("the wall is gone", culler);
}
