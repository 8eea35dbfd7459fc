#pragma once

// The rectangle of a picture that objects can cover. Pixels outside it need not be cleared, resolved or read.

#include <cstdint>

#include "sightline/math/box.h"
#include "sightline/math/mat4.h"
#include "sightline/render/layer_renderer.h"
#include "sightline/scene/camera.h"

namespace sightline::render {

// A rectangle of pixels; rows count from the bottom, as OpenGL's do.
struct PixelRect {
  std::uint32_t left = 0, bottom = 0, right = 0, top = 0;  // right and top are the first ones outside

  std::uint32_t width() const { return right - left; }
  std::uint32_t height() const { return top - bottom; }
  friend bool operator==(const PixelRect&, const PixelRect&) = default;
};

// Collects a rectangle of all pixels that boxes cover. Conservative: it may hold more pixels. An empty box
// covers none, a box that is not finite covers all.
class RectCollector {
 public:
  // The view's axes have unit length.
  RectCollector(const View& view, const LensPoint& lens, std::uint32_t width, std::uint32_t height);

  void add(const Box& box, const Mat4& scene_from_box);
  bool full() const { return rect_ == PixelRect{0, 0, width_, height_}; }
  // The rectangle that the boxes can cover; its width and height are 0 if none of them is in view.
  const PixelRect& rect() const { return rect_; }

 private:
  struct Extent;
  void grow(const Extent& extent);

  Mat4 clip_from_relative_;
  Vec3d eye_, forward_;
  double near_ = 0.0;
  std::uint32_t width_ = 0, height_ = 0;
  PixelRect rect_;
};

}  // namespace sightline::render
