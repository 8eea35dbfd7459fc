#pragma once

// What a layer's image with depths tells about the layer: its circles of confusion and its middle.

#include "sightline/render/depth_of_field.h"
#include "sightline/render/layer_image.h"

namespace sightline::render {

struct SeenLayer {
  bool empty = true;  // no pixel has a depth; the other members are then meaningless
  // The smallest, largest and mean circle of confusion (signedCircle) of its pixels, in pixels; the mean is
  // weighted by opacity.
  double min_circle = 0.0, max_circle = 0.0, mean_circle = 0.0;
  // The middle of its pixels, weighted by opacity: x and y in pixels, depth in metres along forward.
  double x = 0.0, y = 0.0, depth = 0.0;
};

// Precondition: image has depths. Pixels without a depth (kNoDepth) do not count.
SeenLayer lookAt(const LayerImage& image, const View& view, const Lens& lens);

}  // namespace sightline::render
