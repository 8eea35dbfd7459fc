#pragma once

#include <cstdint>
#include <memory>

#include "sightline/culling/culling_method.h"
#include "sightline/occlusion/depth_pyramid.h"

namespace sightline {

// A second, finer depth buffer around the direction in which the first one hides least, for perspective
// views. Its occluders are those of the first one, and the best of what the last frame kept there.
struct FocusSettings {
  // Pixels along the side of one pixel of the first depth buffer; 1 or less: there is no second one.
  double magnification = 8.0;
  RasterSettings raster{.width = 128, .height = 64};  // coverage: that of the first one counts
  std::uint32_t occluder_count = 64;                  // at most so many more occluders than in the first one
  std::uint32_t min_objects = 256;  // made only where the first one leaves at least so many objects
};

struct DepthPyramidMethodSettings {
  RasterSettings raster{};
  FocusSettings focus{};  // with the conservative coverage only
  // Surfaces that were of no use of late rest for a few frames; without surfaces, what was kept is not tested
  // again for six to nine frames.
  bool temporal_coherence = true;
  SurfaceUse surfaces = SurfaceUse::kAlone;
  SurfaceDrawing drawing{};  // of surfaces; `step` is set anew in each frame
  // More than 0: so many surfaces are drawn that a frame takes about so many microseconds, as far as drawing
  // less can do that; at most those of drawing.budget. Then what is kept, always conservative, depends on
  // measured times.
  double budget_us = 0.0;
};

inline constexpr MethodTraits kDepthPyramidTraits{.occluders = true};

// Culling by a DepthPyramid of whole surfaces, or of the chosen occluders where the scene has none: all
// children of a node are compared with it at once. The surfaces of a frame are those of the objects that the
// last frame kept. Statistics: "map" with occluders_hidden, the occluders behind others, focused, 1 in frames
// with a second depth buffer, and what was drawn of surfaces: groups, and edges of their boundaries.
std::unique_ptr<CullingMethod> depthPyramid(const DepthPyramidMethodSettings& settings = {});

}  // namespace sightline
