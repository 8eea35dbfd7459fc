// Culls one frame of a scene made by hand: a wall, four crates behind it, one crate beside it.

#include <cstdint>
#include <cstdio>
#include <vector>

#include "sightline/culling/culler.h"
#include "sightline/culling/depth_pyramid_method.h"

using namespace sightline;

static void addBox(Scene& scene, const Vec3f& low, const Vec3f& high) {
  const auto first_corner = static_cast<std::uint32_t>(scene.positions.size());
  for (int i = 0; i < 8; ++i) {
    scene.positions.push_back({(i & 1) ? high.x : low.x, (i & 2) ? high.y : low.y, (i & 4) ? high.z : low.z});
  }
  const auto first_index = static_cast<std::uint32_t>(scene.indices.size());
  scene.objects.push_back({.first_index = first_index, .index_count = 36, .material = MaterialId(0u)});
  for (std::uint32_t corner : {0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                               2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6}) {
    scene.indices.push_back(first_corner + corner);
  }
}

int main() {
  Scene scene;
  scene.materials.push_back({.name = "stone"});
  addBox(scene, {-8, 0, -11}, {8, 6, -10});  // object 0, the wall
  for (float x : {-6.0f, -2.0f, 2.0f, 6.0f, 16.5f}) {
    addBox(scene, {x, 0, -21}, {x + 1, 1, -20});  // objects 1 to 5, the crates
  }
  updateBounds(scene);
  std::vector<Box> bounds;
  std::vector<std::uint32_t> triangles;  // of each object
  for (const Object& object : scene.objects) {
    bounds.push_back(object.bounds);
    triangles.push_back(object.triangleCount());
  }

  View view;
  view.eye = {0, 1.7, 0};
  setOrientation(view, /*forward=*/{0, 0, -1}, /*up_hint=*/{0, 1, 0});

  // A hierarchy over the objects, and what can hide them; then from views to the objects that may be seen.
  const Hierarchy hierarchy = buildHierarchy(bounds, triangles);  // once a scene
  const SurfaceSet surfaces = findSurfaces(scene.view());
  Culler culler({.hierarchy = &hierarchy, .object_bounds = bounds, .surfaces = &surfaces}, depthPyramid());
  culler.cull(view);  // every frame
  for (ObjectId id : culler.visible()) {
    std::printf("visible: %u\n", id.value);
  }
}
