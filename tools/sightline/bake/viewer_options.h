#pragma once

// The options of `bake` that say where viewers are.

#include <optional>
#include <string>
#include <vector>

#include "sightline/base/parallel_for.h"
#include "sightline/base/result.h"
#include "sightline/math/box.h"
#include "sightline/scene/scene.h"
#include "tools/sightline/command_line/json_output.h"
#include "tools/sightline/command_line/options.h"

namespace sightline::tool {

struct ViewerOptions {
  std::string where = "everywhere";  // or "path", or "free"
  std::vector<std::string> regions;  // each six numbers, world space; none: the scene's bounds
  std::vector<std::string> from;     // each three numbers, world space; none: the camera path's eyes
  PathOptions path;
  // Metres; as in boxesAlong and FreeSpaceSettings, but 0 is no limit of the height.
  std::optional<double> reach, voxel, max_height;

  bool usesPath() const { return where == "path" || (where == "free" && from.empty()); }
};
void addViewerOptions(CLI::App& command, ViewerOptions& options);

// Errors that do not depend on the scene.
Status checkViewerOptions(const ViewerOptions& options);

struct ViewerSpace {
  std::vector<Box> boxes{};  // for BakeSettings::viewers; none: the scene's bounds
  Json facts{};              // how they were found; null if there are none

  // The corners of the box around them, world space: six numbers, or null.
  Json regionJson(const Vec3d& origin) const;
};
// Precondition: checkViewerOptions() succeeded. Error if the path cannot be loaded or no space is found.
Result<ViewerSpace> findViewers(const ViewerOptions& options, const std::string& scene_name,
                                const Scene& scene, const ParallelFor& parallel_for);

}  // namespace sightline::tool
