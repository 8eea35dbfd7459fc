#pragma once

// The objects of a scene as a hierarchy is built from them.

#include <cstdint>
#include <vector>

#include "sightline/scene/scene.h"

namespace sightline::test {

struct ObjectArrays {
  explicit ObjectArrays(const Scene& scene) {
    for (const Object& object : scene.objects) {
      boxes.push_back(object.bounds);
      triangles.push_back(object.triangleCount());
    }
  }

  std::vector<Box> boxes;                // by object
  std::vector<std::uint32_t> triangles;  // by object: how many it has
};

}  // namespace sightline::test
