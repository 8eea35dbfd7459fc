#pragma once

// Which part of a picture objects can cover: what is outside it need not be cleared, resolved or read.

#include <cstdint>

#include "sightline/math/box.h"
#include "sightline/math/mat4.h"
#include "sightline/render/layer_renderer.h"
#include "sightline/scene/camera.h"

namespace sightline::render {

// Pixels, rows from the bottom as OpenGL's.
struct PixelRect {
  std::uint32_t left = 0, bottom = 0, right = 0, top = 0;  // right and top are the first ones outside

  std::uint32_t width() const { return right - left; }
  std::uint32_t height() const { return top - bottom; }
  friend bool operator==(const PixelRect&, const PixelRect&) = default;
};

// Collects the pixels that boxes cover, rather too many than too few: none of an empty box, all of one that
// is not finite.
class RectCollector {
 public:
  RectCollector(const View& view, const LensPoint& lens, std::uint32_t width, std::uint32_t height);

  void add(const Box& box, const Mat4& scene_from_box);
  bool full() const { return rect_ == PixelRect{0, 0, width_, height_}; }
  // Of width and height 0, where nothing was added that is in view.
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
