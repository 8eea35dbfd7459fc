#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "sightline/io/import.h"
#include "sightline/scene/check_scene.h"

namespace sightline::test {

// The scene, or a failed test with the importer's message.
inline Scene imported(const std::string& bytes, const std::string& base_dir = "") {
  Result<Scene> scene = importGltf(bytes, base_dir, "scene.glb");
  if (!scene) {
    ADD_FAILURE() << scene.error().message;
    return {};
  }
  return std::move(*scene);
}

// The message, or a failed test.
inline std::string errorOf(const std::string& bytes, const std::string& base_dir = "") {
  const Result<Scene> scene = importGltf(bytes, base_dir, "scene.glb");
  if (scene) {
    ADD_FAILURE() << "accepted";
    return {};
  }
  return scene.error().message;
}

// What every scene must satisfy, whatever file it comes from.
inline bool isSound(const Scene& scene) {
  std::size_t next = 0;
  bool sound = scene.objects.size() == scene.object_names.size();
  for (const Object& object : scene.objects) {
    sound = sound && object.first_index == next && object.index_count > 0 && object.bounds.wellFormed();
    next += object.index_count;
  }
  return sound && next == scene.indices.size() && checkScene(scene.view());
}

// Twice the area vector of a triangle: its direction is the front's.
inline Vec3d areaVector(const Scene& scene, std::size_t triangle) {
  const auto corner = [&](std::size_t i) { return Vec3d(scene.positions[scene.indices[3 * triangle + i]]); };
  return cross(corner(1) - corner(0), corner(2) - corner(0));
}

inline Vec3d cornerOf(const Scene& scene, std::size_t corner) {
  return Vec3d(scene.positions[scene.indices[corner]]) + scene.origin;
}

}  // namespace sightline::test
