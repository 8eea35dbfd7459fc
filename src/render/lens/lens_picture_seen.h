#pragma once

// What a layer's image tells of it.

#include "sightline/render/depth_of_field.h"
#include "sightline/render/layer_image.h"

namespace sightline::render {

struct SeenLayer {
  bool empty = true;  // then nothing else is known
  // Of the pixels' circles of confusion (signedCircle), pixels; the mean by opacity.
  double min_circle = 0.0, max_circle = 0.0, mean_circle = 0.0;
  // The middle of what is seen, by opacity: pixels, and metres along forward.
  double x = 0.0, y = 0.0, depth = 0.0;
};

// image: with depths; pixels without one do not count.
SeenLayer lookAt(const LayerImage& image, const View& view, const Lens& lens);

}  // namespace sightline::render
