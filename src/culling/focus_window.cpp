#include "src/culling/focus_window.h"

#include <algorithm>
#include <cmath>

#include "src/occlusion/boxes/box_depth_test.h"

namespace sightline::culling {

using occlusion::PixelRange;

namespace {

// The same point lies in the two buffers at places that differ by rounding in double precision alone, less
// than 2^-26 finer pixels for any window within View::kMaxShift. This is so much more that no bound of
// the buffers is needed, pixels.
constexpr double kMargin = 0x1p-16;

}  // namespace

bool FocusWindow::place(const View& whole, std::uint32_t width, std::uint32_t height, const PixelRange& range,
                        std::uint32_t fine_width, std::uint32_t fine_height) {
  range_ = range;
  const double columns = range.x1 + 1.0 - range.x0, rows = range.y1 + 1.0 - range.y0;
  magnification_x_ = fine_width / columns;
  magnification_y_ = fine_height / rows;
  // The middle of the window, in half widths and half heights of the whole picture from the forward axis.
  const double middle_x = whole.shift_x - 1.0 + (range.x0 + range.x1 + 1.0) / width;
  const double middle_y = whole.shift_y - 1.0 + (range.y0 + range.y1 + 1.0) / height;
  const double part_x = columns / width, part_y = rows / height;
  view_ = whole;
  view_.shift_x = middle_x / part_x;
  view_.shift_y = middle_y / part_y;
  view_.tan_half_fovy *= part_y;
  view_.ortho_height *= part_y;
  view_.aspect *= part_x / part_y;
  fine_view_ = occlusion::OutlineView(scene::PixelView(view_, fine_width, fine_height));
  return fine_view_.sane;
}

void FocusWindow::take(const DepthBufferView& drawn) {
  depth_.assign(drawn.reciprocal_depth.begin(), drawn.reciprocal_depth.end());
  DepthBufferView copy = drawn;
  copy.reciprocal_depth = depth_;
  levels_.build(copy);
}

PixelRange FocusWindow::finePixels(const BufferPixel& pixel) const {
  const auto first = [](double from) {
    return static_cast<std::uint16_t>(std::max(0.0, std::floor(from - kMargin)));
  };
  const auto last = [](double to, double size) {
    return static_cast<std::uint16_t>(std::min(size - 1.0, std::floor(to + kMargin)));
  };
  const double x = pixel.x - range_.x0, y = pixel.y - range_.y0;
  return {first(x * magnification_x_), first(y * magnification_y_),
          last((x + 1.0) * magnification_x_, fine_view_.view.width),
          last((y + 1.0) * magnification_y_, fine_view_.view.height)};
}

bool FocusWindow::hides(const Box& box, std::span<const BufferPixel> pixels,
                        std::vector<PixelRange>& scratch) const {
  scratch.clear();
  for (const BufferPixel& pixel : pixels) {
    scratch.push_back(finePixels(pixel));
  }
  return occlusion::hidesBoxWithin(levels_.levels(), fine_view_, box, scratch);
}

}  // namespace sightline::culling
