#pragma once

// Boxes against a depth map and its levels.

#include <span>

#include "sightline/math/box.h"
#include "sightline/occlusion/depth_pyramid.h"
#include "src/occlusion/depth_levels.h"
#include "src/occlusion/pixel_boxes.h"
#include "src/scene/pixel_view.h"

namespace sightline::occlusion {

// The image of each box is given; all are of one view and one size of the map. A box is hidden where every
// pixel of its rectangle is either nearer than the box's nearest point, or not met by the box's outline, or
// nearer than the box is anywhere in that pixel. Not hidden, it is visible where no pixel of the rectangle is
// nearer than its farthest point, and partial otherwise. Without levels nothing on the map is hidden. Every
// instruction set gives the same answers.
void testBoxes(std::span<const DepthLevel> levels, const PixelView& view, std::span<const Box> boxes,
               std::span<const PixelBox> images, std::span<BoxAnswer> answers, const BoxHints& hints = {});

}  // namespace sightline::occlusion
