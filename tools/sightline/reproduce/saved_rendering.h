#pragma once

// Measures how much drawing is saved by warping layers' images from frame to frame and how it affects the
// picture, beside the update rates that Snyder and Lengyel assume.

#include <cstdint>
#include <vector>

#include "scenes/moving_scene.h"
#include "tools/sightline/reproduce/reproduction.h"

namespace sightline::tool {

struct SavedRenderingOptions {
  std::uint32_t height = 180;   // of the pictures, in pixels; the width follows the camera's aspect
  std::uint32_t samples = 1;    // LayerRendererOptions::samples
  std::uint32_t guard_px = 24;  // ReuseSettings::guard_px
  std::uint32_t max_frames = 0xffffffffu;              // frames of each scene, from the first on
  std::vector<std::uint32_t> grids{20, 14, 10, 7, 5};  // divisions of the canyon
  bool toothpicks = true;
  std::vector<double> tolerances_px{0.5, 1.0, 2.0};
};

// The options for those of `reproduce`: few frames if these ask for few.
SavedRenderingOptions savedRenderingOptions(const ReproduceOptions& options);

// Two tables: "saved_rendering" (what is drawn, its error and its time, by scene and tolerance) and
// "update_rates" (of the canyon, by class of part, with those that the paper assumes). Error if this machine
// cannot draw pictures.
Result<std::vector<Experiment>> savedRendering(const SavedRenderingOptions& options);

// False if all corners of the part's hulls lie beyond one plane of the frustum.
bool isPartInView(const MovingScene& scene, std::size_t part, const Mat4& world_from_part,
                  const Frustum& frustum);

// The number of triangles of all parts of a class.
std::uint64_t trianglesOfClass(const MovingScene& scene, const std::string& name);

}  // namespace sightline::tool
