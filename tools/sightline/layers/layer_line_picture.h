#pragma once

// `layers --line-picture`: a frame's feature lines hidden by a depth buffer, with which drawings are
// compared.

#include <memory>

#include "tools/sightline/layers/layer_drawings.h"

namespace sightline::tool {

// Draws the lines of a drawing with these options in black on white, in pixels of the pictures' size, without
// antialiasing. It uses neither the sorter nor HiddenLines. OpenGL draws a depth buffer of the opaque objects
// with up to four fine pixels along each side of a pixel, and each line is tested at every fine pixel that it
// passes. It is hidden there if the surfaces in the four nearest fine pixels are all in front of it by more
// than they slope within a fine pixel. So the ends of visible lines are right within a fine pixel, and a line
// behind a surface by less than that slope is drawn.
Result<std::unique_ptr<FrameMaker>> makeLinePicture(const LayerDrawingOptions& options,
                                                    const FrameMakerInput& input);

}  // namespace sightline::tool
