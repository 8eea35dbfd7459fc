#pragma once

// Tells scenes apart: baked data holds for the scene that it was baked from, and for no other.

#include <cstdint>

#include "sightline/occluders/occluder_set.h"
#include "sightline/scene/scene.h"

namespace sightline {

struct SceneId {
  std::uint64_t hash = 0;  // of all that decides what is visible
  std::uint64_t objects = 0, triangles = 0;

  friend bool operator==(const SceneId&, const SceneId&) = default;
};

// Of positions, triangles, objects with their boxes, and of materials and marks as far as they decide what
// occludes. Not of names, colours or where the origin lies.
SceneId sceneId(const SceneView& scene);

// Of all that its OccluderIds mean: databases of occluders hold for equal sets alone.
std::uint64_t occluderSetHash(const OccluderSet& set);

}  // namespace sightline
