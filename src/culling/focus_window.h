#pragma once

// A part of a view with a finer depth buffer of its own.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/occlusion/depth_pyramid.h"
#include "sightline/occlusion/rasteriser.h"
#include "sightline/scene/camera.h"
#include "src/occlusion/boxes/box_outline.h"
#include "src/occlusion/boxes/depth_levels.h"
#include "src/occlusion/boxes/pixel_range.h"

namespace sightline::culling {

// The picture of the finer buffer is a rectangle of pixels of the view's own, coarse depth buffer. Both have
// the same eye, axes, near and far planes, in perspective as in orthographic views. So what is hidden in one
// is hidden in the other, and a coarse pixel is a known range of finer ones. A window can be moved, but not
// copied.
class FocusWindow {
 public:
  // Places the window at these pixels of a view whose depth buffer has width x height of them. fine_width,
  // fine_height: pixels of the finer buffer. False: its pixels are too small, or it lies farther off-centre
  // than View::kMaxShift, and there is no window.
  bool place(const View& whole, std::uint32_t width, std::uint32_t height, const occlusion::PixelRange& range,
             std::uint32_t fine_width, std::uint32_t fine_height);
  // Copies a depth buffer that was drawn for view().
  void take(const DepthBufferView& drawn);

  const View& view() const { return view_; }
  const occlusion::PixelRange& range() const { return range_; }
  bool contains(const BufferPixel& pixel) const { return range_.contains(pixel); }
  // The finer pixels that a coarse pixel in the window reaches, with a margin for rounding.
  occlusion::PixelRange finePixels(const BufferPixel& pixel) const;
  // Whether the finer buffer surely hides what of the box lies in these coarse pixels and beyond the near
  // plane. pixels: at least one, all of them in the window. scratch: overwritten.
  bool hides(const Box& box, std::span<const BufferPixel> pixels,
             std::vector<occlusion::PixelRange>& scratch) const;

 private:
  occlusion::PixelRange range_{1, 1, 0, 0};  // empty until place()
  View view_;
  occlusion::OutlineView fine_view_;
  double magnification_x_ = 1.0, magnification_y_ = 1.0;
  std::vector<float> depth_;
  occlusion::DepthLevels levels_;
};

}  // namespace sightline::culling
