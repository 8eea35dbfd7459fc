#pragma once

// Small scenes, made of triangles and quads.

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "sightline/scene/scene.h"
#include "tests/support/square_view.h"

namespace sightline::hand_made {

inline MaterialId addMaterial(Scene& scene, Opacity opacity, bool double_sided) {
  scene.materials.push_back({"", opacity, double_sided, {}});
  return MaterialId(scene.materials.size() - 1);
}

// An object with corners of its own, three a triangle.
inline ObjectId addTriangles(Scene& scene, MaterialId material, std::span<const Vec3f> corners) {
  Object object;
  object.first_index = static_cast<std::uint32_t>(scene.indices.size());
  object.index_count = static_cast<std::uint32_t>(corners.size());
  object.material = material;
  for (const Vec3f& corner : corners) {
    scene.indices.push_back(static_cast<std::uint32_t>(scene.positions.size()));
    scene.positions.push_back(corner);
    object.bounds.extend(corner);
  }
  scene.objects.push_back(object);
  scene.object_names.push_back("object " + std::to_string(scene.objects.size() - 1));
  return ObjectId(scene.objects.size() - 1);
}

// A rectangle in the plane z, with its front towards +z, or towards -z if turned.
inline ObjectId addWall(Scene& scene, MaterialId material, float z, float x0, float x1, float y0, float y1,
                        bool turned = false) {
  const Vec3f a(x0, y0, z), b(x1, y0, z), c(x1, y1, z), d(x0, y1, z);
  const std::array<Vec3f, 6> front{a, b, c, a, c, d}, back{a, c, b, a, d, c};
  return addTriangles(scene, material, turned ? back : front);
}

inline View frontView() {
  return test::squareView(0.1, 100.0);
}

}  // namespace sightline::hand_made
