#pragma once

#include <cstdint>
#include <memory>

#include "sightline/culling/culling_method.h"
#include "sightline/occlusion/depth_pyramid.h"

namespace sightline {

inline constexpr std::uint32_t kMaxFocusWindows = 64;

// Finer depth buffers for parts of the view, called windows: where the first buffer leaves objects in doubt,
// because their boxes may show in a few of its pixels. Their occluders are those of the first buffer, and
// what the view keeps there.
struct FocusSettings {
  std::uint32_t windows = 2;  // at most so many in a view, kMaxFocusWindows at most; 0: none
  // Pixels along the side of one pixel of the first depth buffer; 1 or less: there are no windows.
  double magnification = 4.0;
  RasterSettings raster{.width = 64, .height = 64};  // of each; coverage: that of the first one counts
  // Without surfaces: at most so many more occluders than in the first one.
  std::uint32_t occluder_count = 64;
  // A window may cost so many times what the view costs for each object that the window takes away. Work is
  // counted and not timed, and both costs are averages of the last views.
  double worth = 2.0;
};

struct DepthPyramidMethodSettings {
  RasterSettings raster{};
  FocusSettings focus{};  // with the conservative coverage only
  // Surfaces that were of no use of late rest for some frames, fewer where the eye moves past them, and so do
  // objects that finer depth buffers did not hide; without surfaces, what was kept is not tested again for
  // six to nine frames.
  bool temporal_coherence = true;
  SurfaceUse surfaces = SurfaceUse::kAlone;
  SurfaceLimits drawing{};  // of surfaces
  // More than 0: so many surfaces are drawn that a frame takes about so many microseconds, as far as drawing
  // less can do that, at most those of drawing.budget. Then what is kept, always conservative, depends on
  // measured times.
  double budget_us = 0.0;
};

inline constexpr MethodTraits kDepthPyramidTraits{.occluders = true};

// Culling by a DepthPyramid of whole surfaces, or of the chosen occluders where the scene has none: all
// children of a node are compared with it at once. The surfaces of a frame are those of the objects that the
// last frame kept. Statistics: "map" with occluders_hidden, the occluders behind others, focused, the
// windows with finer depth buffers, and focus_hidden, the objects that these hid; "surfaces" with what was
// drawn of them: groups, and edges of their boundaries.
std::unique_ptr<CullingMethod> depthPyramid(const DepthPyramidMethodSettings& settings = {});

}  // namespace sightline
