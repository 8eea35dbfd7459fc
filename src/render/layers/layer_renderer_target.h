#pragma once

// What layers are drawn to: float colours and depths, some samples a side of each pixel.

#include <epoxy/gl.h>

#include <cstdint>
#include <vector>

#include "sightline/base/result.h"
#include "sightline/render/layer_image.h"
#include "sightline/scene/camera.h"
#include "src/render/layers/layer_renderer_rect.h"

namespace sightline::render {

// RGBA32F or R32F or 32-bit float depth, without filtering; unit 0 is left bound to it.
GLuint makeTexture(GLenum format, std::uint32_t width, std::uint32_t height);

// Precondition of all functions: the context that it was created in is current. Textures go with the context.
class LayerTarget {
 public:
  // width, height: pixels. samples: a side. Errors: more than the driver can.
  static Result<LayerTarget> create(std::uint32_t width, std::uint32_t height, std::uint32_t samples);

  // Of samples, as all that is drawn to.
  GLuint framebuffer() const { return framebuffer_; }
  GLuint color() const { return color_; }
  GLuint depth() const { return depth_; }
  std::uint32_t sampleWidth() const { return width_ * samples_; }
  std::uint32_t sampleHeight() const { return height_ * samples_; }

  // Leaves all but these pixels as they are from now on.
  void restrictTo(const PixelRect& rect);

  // The picture that was drawn, transparent outside the last rectangle. Depths of the view, if asked for:
  // each pixel's nearest sample.
  void read(const View& view, bool depths, LayerImage& image);

 private:
  Status makeResolved();
  void resolve() const;
  void scissor(std::uint32_t scale) const;  // rect_, in pixels of so many samples a side

  std::uint32_t width_ = 0, height_ = 0, samples_ = 1;
  GLuint framebuffer_ = 0, color_ = 0, depth_ = 0;
  PixelRect rect_;
  std::vector<ShapedPixel> read_pixels_;
  std::vector<float> read_depths_;
  GLuint resolved_ = 0, program_ = 0, vertex_array_ = 0;  // with several samples: of pixels
};

}  // namespace sightline::render
