#pragma once

// Chooses the part of a view in which the depth buffer of the occluders hides fewest objects, for a second
// depth buffer with a finer resolution there. At the far end of a street, for example, occluders are a few
// pixels wide and hardly cover any pixel completely.

#include <cstdint>
#include <vector>

#include "sightline/culling/depth_pyramid_method.h"
#include "src/scene/pixel_view.h"

namespace sightline::culling {

class FocusWindow {
 public:
  // width, height: of the first depth buffer, pixels.
  FocusWindow(const FocusSettings& settings, std::uint32_t width, std::uint32_t height);

  // Counts objects that the first depth buffer does not hide, around its pixel (x, y).
  void add(std::uint32_t x, std::uint32_t y, std::uint32_t objects) {
    counts_[((y >> cell_shift_) + 1) * (columns_ + 1) + (x >> cell_shift_) + 1] += objects;
  }
  // Starts a view and places the window where the most objects were counted in the last view. There is no
  // window if after_last is false, if the objects are fewer than FocusSettings::min_objects, or if the view
  // is orthographic.
  void begin(const View& view, bool after_last);

  bool found() const { return found_; }
  // The window as a view: it has the same eye as the main view, another direction and a narrower angle. What
  // is hidden in it is hidden in the main view too.
  const View& view() const { return window_; }
  // Whether a box around pixel (x, y) of the first depth buffer may lie in the window.
  bool mayContain(std::uint32_t x, std::uint32_t y) const {
    return x >= x0_ && x <= x1_ && y >= y0_ && y <= y1_;
  }
  // Writes the approximate rectangle of the window in the first depth buffer to the hints.
  void writeTo(BoxHints& hints) const {
    hints.window_x0 = x0_;
    hints.window_y0 = y0_;
    hints.window_x1 = x1_;
    hints.window_y1 = y1_;
  }
  // Whether a part of the box may be in the window.
  bool mayShow(const Box& box) const;

 private:
  static constexpr std::uint32_t kMinCellShift = 2;

  bool findDirection(Vec3d& direction);
  bool setWindow(const View& view, const Vec3d& direction);

  FocusSettings settings_;
  std::uint32_t width_, height_;                // of the first depth buffer, pixels
  std::uint32_t cell_shift_ = kMinCellShift;    // the side of a cell is 1 << cell_shift_ pixels
  std::uint32_t columns_, rows_;                // cells
  std::uint32_t window_columns_, window_rows_;  // cells
  // Objects counted per cell; the row and the column before the first cells are zeros. begin() turns the
  // counts into a summed-area table.
  std::vector<std::uint32_t> counts_;
  PixelView last_;  // the view in which the objects were counted
  bool found_ = false;
  View window_;
  double tan_half_diagonal_ = 0.0;
  std::uint16_t x0_ = 1, y0_ = 1, x1_ = 0, y1_ = 0;  // first and last pixels in the first depth buffer
};

}  // namespace sightline::culling
