#pragma once

// The frame buffer that layers are drawn to: float colours and depths, samples x samples for each pixel.

#include <epoxy/gl.h>

#include <cstdint>
#include <vector>

#include "sightline/base/result.h"
#include "sightline/render/layer_image.h"
#include "sightline/scene/camera.h"
#include "src/render/layers/layer_renderer_rect.h"

namespace sightline::render {

// A texture of RGBA32F, R32F or 32-bit float depth without filtering. Texture unit 0 stays bound to it.
GLuint makeTexture(GLenum format, std::uint32_t width, std::uint32_t height);

// Precondition of all functions: the context that it was created in is current. Its textures are freed with
// the context.
class LayerTarget {
 public:
  // width and height are in pixels, samples counts the samples along each side of a pixel. Error if the
  // driver cannot make so large a target.
  static Result<LayerTarget> create(std::uint32_t width, std::uint32_t height, std::uint32_t samples);

  // The frame buffer and its textures hold samples, not pixels.
  GLuint framebuffer() const { return framebuffer_; }
  GLuint color() const { return color_; }
  GLuint depth() const { return depth_; }
  std::uint32_t sampleWidth() const { return width_ * samples_; }
  std::uint32_t sampleHeight() const { return height_ * samples_; }

  // From now on only these pixels are drawn to and cleared.
  void restrictTo(const PixelRect& rect);

  // Keeps all depths that were drawn, for restoreDepths().
  void keepDepths();
  // Sets all depths to those kept; without any, changes nothing.
  void restoreDepths() const;

  // Reads the picture that was drawn; it is transparent outside the last rectangle. If depths is set, also
  // reads the depth of each pixel's nearest sample, in metres along the view's forward.
  void read(const View& view, bool depths, LayerImage& image);

 private:
  Status makeResolved();
  void resolve() const;
  void copyDepths(GLuint from, GLuint to) const;
  void scissor(std::uint32_t scale) const;  // sets it to rect_ times scale

  std::uint32_t width_ = 0, height_ = 0, samples_ = 1;
  GLuint framebuffer_ = 0, color_ = 0, depth_ = 0;
  GLuint kept_depth_ = 0;  // made on first use
  PixelRect rect_;
  std::vector<ShapedPixel> read_pixels_;
  std::vector<float> read_depths_;
  GLuint resolved_ = 0, program_ = 0, vertex_array_ = 0;  // resolve samples to pixels; 0 with one sample
};

}  // namespace sightline::render
