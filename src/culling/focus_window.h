#pragma once

// The part of a view where a map of occluders leaks most, for a second map that is finer there. Far down a
// street everything is a few pixels wide, and no pixel is wholly covered.

#include <cstdint>
#include <vector>

#include "sightline/culling/depth_pyramid_method.h"
#include "src/scene/pixel_view.h"

namespace sightline::culling {

class FocusWindow {
 public:
  // width, height: of the map that leaks.
  FocusWindow(const FocusSettings& settings, std::uint32_t width, std::uint32_t height);

  // So many objects, about this pixel of the map, are not hidden by it.
  void add(std::uint32_t x, std::uint32_t y, std::uint32_t objects) {
    heat_[((y >> cell_shift_) + 1) * (columns_ + 1) + (x >> cell_shift_) + 1] += objects;
  }
  // Begins a view. A window is looked for where most objects were added in the last one; without a last one,
  // or where they are few, there is none. Orthographic views have none.
  void begin(const View& view, bool after_last);

  bool found() const { return found_; }
  // Of the window: the same eye, turned, with a narrow angle. What it takes for hidden is hidden in the view
  // that it was made for.
  const View& view() const { return window_; }
  // Whether a box about this pixel of the map may lie in the window.
  bool about(std::uint32_t x, std::uint32_t y) const { return x >= x0_ && x <= x1_ && y >= y0_ && y <= y1_; }
  // The window's pixels on the map, about.
  void tell(BoxHints& hints) const {
    hints.window_x0 = x0_;
    hints.window_y0 = y0_;
    hints.window_x1 = x1_;
    hints.window_y1 = y1_;
  }
  // Whether some of the box may be seen in the window.
  bool mayShow(const Box& box) const;

 private:
  static constexpr std::uint32_t kMinCellShift = 2;

  bool findDirection(Vec3d& direction);
  bool setWindow(const View& view, const Vec3d& direction);

  FocusSettings settings_;
  std::uint32_t width_, height_;                // of the map
  std::uint32_t cell_shift_ = kMinCellShift;    // a cell's side is 1 << this, pixels
  std::uint32_t columns_, rows_;                // cells
  std::uint32_t window_columns_, window_rows_;  // cells
  std::vector<std::uint32_t> heat_;             // by cell; the first row and column are of zeros
  PixelView last_;
  bool found_ = false;
  View window_;
  double tan_half_diagonal_ = 0.0;
  std::uint16_t x0_ = 1, y0_ = 1, x1_ = 0, y1_ = 0;  // of the map, first and last pixels
};

}  // namespace sightline::culling
