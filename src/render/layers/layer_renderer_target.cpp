#include "src/render/layers/layer_renderer_target.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>

#include "src/render/context/gl_context.h"
#include "src/render/scene/shaders.h"

namespace sightline::render {
namespace {

GLuint makeTargetOf(GLuint color, GLuint depth, GLenum depth_attachment) {
  GLuint framebuffer = 0;
  glGenFramebuffers(1, &framebuffer);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glFramebufferTexture(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, color, 0);
  glFramebufferTexture(GL_FRAMEBUFFER, depth_attachment, depth, 0);
  return framebuffer;
}

Error doesNotFit(std::uint32_t width, std::uint32_t height) {
  return Error{fmt::format("the driver makes no float picture of {} x {} samples", width, height)};
}

// Whether the current frame buffer, which was just made, can be drawn to.
bool complete() {
  return glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE &&
         glGetError() != GL_OUT_OF_MEMORY;
}

std::uint32_t largestSide() {
  GLint texture = 0;
  std::array<GLint, 2> viewport{};
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &texture);
  glGetIntegerv(GL_MAX_VIEWPORT_DIMS, viewport.data());
  return static_cast<std::uint32_t>(std::max(std::min({texture, viewport[0], viewport[1]}), 0));
}

// Copies a rectangle of pixels as OpenGL gives them, rows from the bottom, into a picture of width x height,
// rows from the top.
template <typename T>
void place(const std::vector<T>& pixels, const PixelRect& rect, std::size_t width, std::size_t height,
           const T& outside, std::vector<T>& picture) {
  picture.resize(width * height);
  for (std::size_t y = 0; y < height; ++y) {
    const std::size_t up = height - 1 - y;
    T* row = picture.data() + y * width;
    if (rect.width() == 0 || up < rect.bottom || up >= rect.top) {
      std::fill_n(row, width, outside);
      continue;
    }
    std::fill(row, row + rect.left, outside);
    std::copy_n(pixels.data() + (up - rect.bottom) * rect.width(), rect.width(), row + rect.left);
    std::fill(row + rect.right, row + width, outside);
  }
}

// Converts values of the depth buffer to metres. With the near distance n and the far distance f, depth z is
// stored as d = n (f - z) / (z (f - n)), so that z = n / (d (1 - n / f) + n / f), where f may be infinite; in
// orthographic views it is stored as (f - z) / (f - n), of which nothing can be read where f is infinite. 0
// means that nothing was drawn.
void toMetres(const View& view, std::vector<float>& depths) {
  const double near = view.z_near, range = view.z_far - near, share = near / view.z_far;
  for (float& depth : depths) {
    const double d = depth;
    depth = d == 0.0            ? LayerImage::kNoDepth
            : view.orthographic ? static_cast<float>(std::isfinite(range) ? view.z_far - d * range : near)
                                : static_cast<float>(near / (d * (1.0 - share) + share));
  }
}

}  // namespace

GLuint makeTexture(GLenum format, std::uint32_t width, std::uint32_t height) {
  GLuint texture = 0;
  glGenTextures(1, &texture);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, texture);
  glTexStorage2D(GL_TEXTURE_2D, 1, format, static_cast<GLsizei>(width), static_cast<GLsizei>(height));
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  return texture;
}

Result<LayerTarget> LayerTarget::create(std::uint32_t width, std::uint32_t height, std::uint32_t samples) {
  if (samples != 1 && samples != 2 && samples != 4) {
    return Error{fmt::format("{} samples a side of each pixel: must be 1, 2 or 4", samples)};
  }
  constexpr std::uint32_t kLargest = 8192;
  const std::uint32_t largest = std::min(kLargest, largestSide() / samples);
  if (width == 0 || height == 0 || width > largest || height > largest) {
    return Error{fmt::format("no layers of {} x {} pixels with {} samples a side: each side must be 1 to {}",
                             width, height, samples, largest)};
  }
  LayerTarget t;
  t.width_ = width;
  t.height_ = height;
  t.samples_ = samples;
  t.color_ = makeTexture(GL_RGBA32F, t.sampleWidth(), t.sampleHeight());
  t.depth_ = makeTexture(GL_DEPTH_COMPONENT32F, t.sampleWidth(), t.sampleHeight());
  t.framebuffer_ = makeTargetOf(t.color_, t.depth_, GL_DEPTH_ATTACHMENT);
  if (!complete()) {
    return doesNotFit(t.sampleWidth(), t.sampleHeight());
  }
  if (samples > 1) {
    if (Status made = t.makeResolved(); !made) {
      return made.error();
    }
  }
  return t;
}

Status LayerTarget::makeResolved() {
  const std::string fragment =
      fmt::format("#version 430 core\nconst int samples = {};\n{}", samples_, kResolveFragment);
  const Result<GLuint> program = makeProgram("samples", kResolveVertex, fragment.c_str());
  if (!program) {
    return program.error();
  }
  program_ = *program;
  glProgramUniform1i(program_, glGetUniformLocation(program_, "colors"), 0);
  glProgramUniform1i(program_, glGetUniformLocation(program_, "depths"), 1);
  glGenVertexArrays(1, &vertex_array_);
  resolved_ = makeTargetOf(makeTexture(GL_RGBA32F, width_, height_), makeTexture(GL_R32F, width_, height_),
                           GL_COLOR_ATTACHMENT1);
  const std::array<GLenum, 2> both{GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
  glDrawBuffers(2, both.data());
  return complete() ? Status(Success{}) : Status(doesNotFit(width_, height_));
}

void LayerTarget::resolve() const {
  glBindFramebuffer(GL_FRAMEBUFFER, resolved_);
  glViewport(0, 0, static_cast<GLsizei>(width_), static_cast<GLsizei>(height_));
  scissor(1);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_BLEND);
  glDisable(GL_CULL_FACE);
  glActiveTexture(GL_TEXTURE1);
  glBindTexture(GL_TEXTURE_2D, depth_);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, color_);
  glUseProgram(program_);
  glBindVertexArray(vertex_array_);
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

void LayerTarget::restrictTo(const PixelRect& rect) {
  rect_ = rect;
  scissor(samples_);
}

void LayerTarget::scissor(std::uint32_t scale) const {
  glEnable(GL_SCISSOR_TEST);
  glScissor(static_cast<GLint>(rect_.left * scale), static_cast<GLint>(rect_.bottom * scale),
            static_cast<GLsizei>(rect_.width() * scale), static_cast<GLsizei>(rect_.height() * scale));
}

void LayerTarget::keepDepths() {
  if (kept_depth_ == 0) {
    kept_depth_ = makeTexture(GL_DEPTH_COMPONENT32F, sampleWidth(), sampleHeight());
  }
  copyDepths(depth_, kept_depth_);
}

void LayerTarget::restoreDepths() const {
  if (kept_depth_ != 0) {
    copyDepths(kept_depth_, depth_);
  }
}

void LayerTarget::copyDepths(GLuint from, GLuint to) const {
  glCopyImageSubData(from, GL_TEXTURE_2D, 0, 0, 0, 0, to, GL_TEXTURE_2D, 0, 0, 0, 0,
                     static_cast<GLsizei>(sampleWidth()), static_cast<GLsizei>(sampleHeight()), 1);
}

void LayerTarget::read(const View& view, bool depths, LayerImage& image) {
  if (samples_ > 1) {
    resolve();
  }
  const auto x = static_cast<GLint>(rect_.left), y = static_cast<GLint>(rect_.bottom);
  const auto w = static_cast<GLsizei>(rect_.width()), h = static_cast<GLsizei>(rect_.height());
  const std::size_t count = std::size_t{rect_.width()} * rect_.height();
  image.width = width_;
  image.height = height_;
  glBindFramebuffer(GL_READ_FRAMEBUFFER, samples_ > 1 ? resolved_ : framebuffer_);
  glReadBuffer(GL_COLOR_ATTACHMENT0);
  read_pixels_.resize(count);
  glReadPixels(x, y, w, h, GL_RGBA, GL_FLOAT, read_pixels_.data());
  place(read_pixels_, rect_, width_, height_, ShapedPixel{}, image.pixels);
  if (!depths) {
    image.depths.clear();
    return;
  }
  if (samples_ > 1) {
    glReadBuffer(GL_COLOR_ATTACHMENT1);
  }
  read_depths_.resize(count);
  glReadPixels(x, y, w, h, samples_ > 1 ? GL_RED : GL_DEPTH_COMPONENT, GL_FLOAT, read_depths_.data());
  toMetres(view, read_depths_);
  place(read_depths_, rect_, width_, height_, LayerImage::kNoDepth, image.depths);
}

}  // namespace sightline::render
