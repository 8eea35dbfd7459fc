#pragma once

// The objects of a scene as a hierarchy is built from them.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/scene/scene.h"

namespace sightline::test {

inline std::vector<Box> boxesOf(std::span<const Object> objects) {
  std::vector<Box> boxes;
  for (const Object& object : objects) {
    boxes.push_back(object.bounds);
  }
  return boxes;
}

struct ObjectArrays {
  explicit ObjectArrays(const Scene& scene) : boxes(boxesOf(scene.objects)) {
    for (const Object& object : scene.objects) {
      triangles.push_back(object.triangleCount());
    }
  }

  std::vector<Box> boxes;                // by object
  std::vector<std::uint32_t> triangles;  // by object: how many it has
};

}  // namespace sightline::test
