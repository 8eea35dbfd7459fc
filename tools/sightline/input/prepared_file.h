#pragma once

// The surfaces of a scene in a file, so that the next start need not find them.

#include <memory>
#include <string>

#include "sightline/base/result.h"
#include "sightline/occluders/surface_set.h"
#include "sightline/pvs/format/scene_id.h"

namespace sightline::tool {

struct PreparedFile {
  std::string name;  // empty: none
  SceneId scene{};
  double crack_width = 0.0;                      // with which the scene's cracks were closed, metres
  std::shared_ptr<const SurfaceSet> surfaces{};  // null: they are not there
};

// Reads what the file has of the scene. Where there is no such file, or one of another scene or version, or a
// damaged one, nothing is found, and stderr says why. Error if the file is something else, which must not be
// written over.
Result<PreparedFile> openPrepared(const std::string& name, const SceneId& scene, double crack_width);

// Writes the file whole or not at all. A failure is told on stderr and changes nothing else.
void keepPrepared(const PreparedFile& file, const SurfaceSet& surfaces);

}  // namespace sightline::tool
