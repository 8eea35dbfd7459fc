#pragma once

#include "sightline/io/image.h"
#include "src/render/context/gl_context.h"

namespace sightline::render {

// The colours of a frame buffer, rows from the top. Precondition: its context is current.
Image readPixels(const Framebuffer& framebuffer);

// Half the width and height (both even), each pixel the mean of four.
Image halved(const Image& image);

}  // namespace sightline::render
