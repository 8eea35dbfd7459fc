#pragma once

// `layers --line-picture`: a frame's feature lines against a depth buffer, what drawings are compared with.

#include <memory>

#include "tools/sightline/layers/layer_drawings.h"

namespace sightline::tool {

// Draws the lines that a drawing with these options has (lines of all objects, kinds and angle as they say),
// in pixels of the pictures' size, black on white, without antialiasing. It asks neither the sorter nor
// HiddenLines: the opaque objects' depths are drawn by OpenGL, four times as fine as the picture each way (as
// far as its largest picture allows), and each line is looked up in them at every fine pixel that it passes.
// It is hidden there if the four nearest surfaces all lie before it by more than they slope within a fine
// pixel. So where a line comes out from behind something is right within a fine pixel, and what lies behind a
// surface by less than it slopes in that is drawn.
Result<std::unique_ptr<FrameMaker>> makeLinePicture(const LayerDrawingOptions& options,
                                                    const FrameMakerInput& input);

}  // namespace sightline::tool
