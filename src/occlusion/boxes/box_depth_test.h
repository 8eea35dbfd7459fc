#pragma once

// Compares boxes with a depth buffer and its levels.

#include <span>
#include <vector>

#include "sightline/math/box.h"
#include "sightline/occlusion/depth_pyramid.h"
#include "src/occlusion/boxes/box_outline.h"
#include "src/occlusion/boxes/depth_levels.h"
#include "src/occlusion/boxes/pixel_boxes.h"
#include "src/occlusion/boxes/pixel_range.h"

namespace sightline::occlusion {

// Classifies boxes; images and answers: one for each box, of one view and one size of the buffer. A box is
// hidden where every pixel of its rectangle is nearer than the box's nearest point, or disjoint from the
// box's outline, or nearer than the box is anywhere in that pixel. A box that is not hidden is visible where
// no pixel of the rectangle is nearer than its farthest point, and partial otherwise. The rectangle of a box
// that reaches the near plane is the whole buffer, and such a box is hidden or partial. Without levels no box
// is hidden that may be on the buffer. Every instruction set gives the same answers.
void testBoxes(std::span<const DepthLevel> levels, const OutlineView& view, std::span<const Box> boxes,
               std::span<const PixelBox> images, std::span<BoxAnswer> answers, const BoxHints& hints = {});

// Appends, box by box, the pixels in which the buffer does not surely hide it, and sets counts[i] to how many
// they are. It is kManyPixels, and none are appended, where they are more than `max`, where the box reaches
// the near plane, and without levels. images and counts: one for each box. Every instruction set gives the
// same pixels in the same order.
void findOpenPixels(std::span<const DepthLevel> levels, const OutlineView& view, std::span<const Box> boxes,
                    std::span<const PixelBox> images, std::uint32_t max, std::span<std::uint32_t> counts,
                    std::vector<BufferPixel>& pixels);
// Whether the buffer surely hides what of a box lies in these pixels and beyond the near plane. ranges: not
// empty.
bool hidesBoxWithin(std::span<const DepthLevel> levels, const OutlineView& view, const Box& box,
                    std::span<const PixelRange> ranges);

}  // namespace sightline::occlusion
