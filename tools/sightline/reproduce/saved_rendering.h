#pragma once

// How much of drawing is saved when layers' images are warped from frame to frame, and what that does to the
// picture: measured, beside the update rates that Snyder and Lengyel assume.

#include <cstdint>
#include <vector>

#include "scenes/moving_scene.h"
#include "tools/sightline/reproduce/reproduction.h"

namespace sightline::tool {

struct SavedRenderingOptions {
  std::uint32_t height = 180;              // of the pictures, pixels; as wide as the scene's camera has it
  std::uint32_t samples = 1;               // LayerRendererOptions::samples
  std::uint32_t guard_px = 24;             // ReuseSettings::guard_px
  std::uint32_t max_frames = 0xffffffffu;  // the first so many frames of each scene
  std::vector<std::uint32_t> grids{20, 14, 10, 7, 5};  // of the canyon
  bool toothpicks = true;
  std::vector<double> tolerances_px{0.5, 1.0, 2.0};
};

// The options of `reproduce`: few frames where it asks for fewer.
SavedRenderingOptions savedRenderingOptions(const ReproduceOptions& options);

// Two tables: "saved_rendering" (what is drawn, how wrong, how long, by scene and tolerance) and
// "update_rates" (of the canyon, by class of part, with the paper's assumed ones). Errors: pictures cannot be
// made on this machine.
Result<std::vector<Experiment>> savedRendering(const SavedRenderingOptions& options);

// Not all corners of the part's hulls are beyond one plane of the frustum.
bool isPartInView(const MovingScene& scene, std::size_t part, const Mat4& world_from_part,
                  const Frustum& frustum);

// Triangles of all parts of a class.
std::uint64_t trianglesOfClass(const MovingScene& scene, const std::string& name);

}  // namespace sightline::tool
