#pragma once

#include <algorithm>
#include <cstdint>

#include "sightline/occlusion/rasteriser.h"

namespace sightline::culling {

// How much is drawn of surfaces in a view, beside what is usual.
//
// After a jump nothing is known of what hides what, and all that is in the frustum may be drawn. So that a
// cut to another camera is no hitch, only what has few edges for its size is drawn in that view, and the work
// of a view does not grow to many times what is usual within one step.
class UsualWork {
 public:
  // Limits what is drawn in a view.
  SurfaceLimits limited(SurfaceLimits limits, bool jumped) const {
    if (usual_ > 0.0) {
      limits.pixels_per_edge *= jumped ? kJumpedPixels : 1.0;
      limits.budget =
          static_cast<std::uint32_t>(std::min<double>(limits.budget, std::max(kLeastWork, kGrowth * usual_)));
    }
    return limits;
  }
  // work: that was done in the view, SurfaceStats::work.
  void frame(double work) { usual_ += (work - usual_) / (usual_ > 0.0 ? kMemory : 1.0); }

 private:
  static constexpr double kJumpedPixels = 32.0;  // times SurfaceLimits::pixels_per_edge
  static constexpr double kGrowth = 16.0, kLeastWork = 6000.0, kMemory = 8.0;  // views

  double usual_ = 0.0;  // of a view; 0: nothing has been drawn
};

}  // namespace sightline::culling
