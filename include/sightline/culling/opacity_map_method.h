#pragma once

#include <memory>

#include "sightline/culling/culling_method.h"
#include "sightline/culling/measured_renderer.h"
#include "sightline/occlusion/opacity_map.h"

namespace sightline {

struct OpacityMapMethodSettings {
  OpacityMapSettings map{};
  // Microseconds that the renderer takes for a triangle. More than 0: map.coverage_ratio is where an adaptive
  // one begins that follows the measured times, and culling by occlusion is suspended while it does not pay;
  // then what is kept, always conservative, depends on times.
  double triangle_us = 0.0;
  // In place of triangle_us: what the renderer takes as it was measured so far, which the caller reports.
  // Until it is known, the coverage ratio stays. Outlives the method; null: triangle_us counts.
  const MeasuredRenderer* renderer = nullptr;
  SurfaceUse surfaces = SurfaceUse::kNone;
  SurfaceLimits drawing{};  // of surfaces
  double budget_us = 0.0;   // see DepthPyramidMethodSettings
};

inline constexpr MethodTraits kOpacityMapTraits{.occluders = true};

// Culling by an OpacityMap of the chosen occluders (Poon, Wang 1999), or of whole surfaces.
// Statistics: "map" with occluders_hidden, overlap_tests, overlap_failed, given_up, depth_tests,
// depths_compared, sparse_rows, and, where triangle_us or renderer is set, suspended;
// then also "coverage" with per_mille, the coverage ratio of the frame. With surfaces, "surfaces" with groups
// of them and edges of their boundaries.
std::unique_ptr<CullingMethod> opacityMap(const OpacityMapMethodSettings& settings = {});

}  // namespace sightline
