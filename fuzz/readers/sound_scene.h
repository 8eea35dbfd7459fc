#pragma once

#include <algorithm>
#include <cstdint>

#include "fuzz/readers/fuzz_input.h"
#include "sightline/scene/scene.h"

namespace sightline::fuzz {

// Ends the program unless the scene is as importers promise it.
inline void requireSound(const Scene& scene) {
  require(scene.objects.size() == scene.object_names.size());
  std::size_t next_index = 0;
  for (const Object& object : scene.objects) {
    require(object.first_index == next_index && object.index_count > 0 && object.index_count % 3 == 0);
    require(object.material.value < scene.materials.size() && object.bounds.wellFormed());
    next_index += object.index_count;
  }
  require(next_index == scene.indices.size());
  require(std::all_of(scene.indices.begin(), scene.indices.end(),
                      [&](std::uint32_t index) { return index < scene.positions.size(); }));
  require(std::all_of(scene.positions.begin(), scene.positions.end(),
                      [](const Vec3f& position) { return isFinite(position); }));
}

}  // namespace sightline::fuzz
