#pragma once

#include <memory>

#include "sightline/culling/culling_method.h"

namespace sightline {

// What the renderer takes for what it draws, microseconds. Negative values, and what is not finite, count
// as 0.
struct RendererCost {
  double object_us = 0.0;  // for an object, however small: its draw call
  // For each triangle, as the scene's hierarchy counts them: give their numbers to buildHierarchy(), which
  // else counts one for each object, so that drawing seems to cost next to nothing.
  double triangle_us = 0.0;
};

// The method as long as culling by occlusion takes less time than drawing what it removes would. Where it
// does not, as in a wood of leaves with holes, frames are culled by the frustum alone, and the method is
// tried again after 16 frames, then after ever more up to 128, or when the camera jumps. What is kept depends
// on measured times then, and is conservative always. Gain and cost are compared in every fourth frame, in
// which the frustum culls once more. The scene needs a hierarchy, whatever the method.
//
// Where several views are culled at once (CullerSettings::views_at_once), the cost is shared among the frames
// for which the answers hold, and only frames that are culled are counted. The gain is then that in the wider
// view which is culled for all of them, a little more than any of them has.
//
// Statistics: those of the method, and "renderer" with given_up, 1 in frames without occlusion culling, and
// saved_us, what drawing the removed objects would have taken when it was last estimated.
std::unique_ptr<CullingMethod> whileItPays(std::unique_ptr<CullingMethod> method, const RendererCost& cost);

}  // namespace sightline
