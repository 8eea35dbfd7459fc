#pragma once

// Identifies a scene: baked data is valid only for the scene that it was baked from.

#include <cstdint>

#include "sightline/occluders/occluder_set.h"
#include "sightline/scene/scene.h"

namespace sightline {

struct SceneId {
  std::uint64_t hash = 0;  // of everything that determines what is visible
  std::uint64_t objects = 0, triangles = 0;

  friend bool operator==(const SceneId&, const SceneId&) = default;
};

// Hashes positions, triangles and objects with their boxes, and materials and marks as far as they determine
// what occludes. Names, colours and the origin do not count.
//
// The arrays are hashed as they lie in memory. The same model from another loader, which orders or welds
// vertices in another way, is another scene: load it with the code that baked it (importScene() for files of
// the tool), or bake the program's own SceneView (bakeVisibility()).
SceneId sceneId(const SceneView& scene);

// Hashes everything that gives OccluderIds their meaning: databases of occluders are valid only for equal
// sets.
std::uint64_t occluderSetHash(const OccluderSet& set);

}  // namespace sightline
