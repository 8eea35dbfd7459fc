#pragma once

// A point of a box that appears in a pixel.

#include "sightline/math/box.h"
#include "sightline/occlusion/depth_pyramid.h"
#include "src/scene/pixel_view.h"

namespace sightline::occlusion {

// Returns the point where the ray through the pixel's middle enters the box, or comes out of the near plane
// in it. Where that ray misses the box, returns a point of the box close to the ray, which for a box whose
// image touches the pixel is mostly seen in it. box: well formed.
Vec3f pointInPixel(const scene::PixelView& view, const Box& box, const BufferPixel& pixel);

}  // namespace sightline::occlusion
