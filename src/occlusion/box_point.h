#pragma once

// A point of a box that appears in a pixel.

#include "sightline/math/box.h"
#include "sightline/occlusion/depth_pyramid.h"
#include "src/scene/pixel_view.h"

namespace sightline::occlusion {

// Sets the point to where the ray through the pixel's middle enters the box, or comes out of the near plane in
// it, rounded to a point of the box. False: that ray misses the box, and the point stays as it is. box: well
// formed.
bool pointInPixel(const PixelView& view, const Box& box, const BufferPixel& pixel, Vec3f& point);

}  // namespace sightline::occlusion
