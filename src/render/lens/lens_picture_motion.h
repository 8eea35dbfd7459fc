#pragma once

// Interpolates views and transforms between two frames, and measures how far layers move on the screen.

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

// All views have axes of unit length. time is counted in frames from this one on: 0 is this frame, 1 the
// next. Both views are right-handed, or both left-handed.
struct Motion {
  View later;
  std::vector<Mat4> stored;            // scene_from_stored in this frame, one for each object, or empty
  std::span<const Mat4> later_stored;  // the same in the next frame
  double shutter = 0.0;                // share of a frame's time that the shutter is open
};
View viewAt(const View& view, const View& later, double time);
void transformsAt(const Motion& motion, std::size_t objects, double time, std::vector<Mat4>& transforms);

// How far the visible part of a layer moves while the shutter is open: the mean over its objects of how far
// each would carry the layer's middle. Zero where the middle leaves what can be projected.
PixelStep layerStep(const View& view, const Motion& motion, std::span<const ObjectId> objects,
                    const SeenLayer& seen, const LayerImage& image);
// How far a point at infinity in the picture's middle moves while the shutter is open. Zero in orthographic
// views.
PixelStep skyStep(const View& view, const Motion& motion, const LayerImage& image);

}  // namespace sightline::render
