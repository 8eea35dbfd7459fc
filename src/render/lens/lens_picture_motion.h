#pragma once

// Where things are between two frames, and how far their images move.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/base/ids.h"
#include "sightline/render/lens_picture.h"
#include "src/render/lens/lens_picture_seen.h"

namespace sightline::render {

// A step on the screen, pixels: x to the right, y down.
struct PixelStep {
  double x = 0.0, y = 0.0;
};

// time: frames from this one on.
View viewAt(const View& view, const View& later, double time);
void transformsAt(const FrameMotion& motion, std::size_t objects, double time, std::vector<Mat4>& transforms);

// While the shutter is open, of what is seen of a layer of these objects; of several the mean of where each
// would take the layer's middle. None where it leaves what can be projected.
PixelStep layerStep(const View& view, const FrameMotion& motion, std::span<const ObjectId> objects,
                    const SeenLayer& seen, const LayerImage& image);
// The same of what is at infinity, in the picture's middle. None in orthographic views.
PixelStep skyStep(const View& view, const FrameMotion& motion, const LayerImage& image);

}  // namespace sightline::render
