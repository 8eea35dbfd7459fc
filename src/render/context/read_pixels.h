#pragma once

#include "sightline/io/image.h"
#include "src/render/context/gl_context.h"

namespace sightline::render {

// Reads the colours of a frame buffer; rows count from the top. Precondition: its context is current.
Image readPixels(const Framebuffer& framebuffer);

// The picture at half its width and height, which are even; each pixel is the mean of four.
Image halved(const Image& image);

}  // namespace sightline::render
