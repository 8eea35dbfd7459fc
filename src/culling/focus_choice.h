#pragma once

// Chooses the windows of a view in which most pixels are in doubt.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/occlusion/depth_pyramid.h"
#include "src/occlusion/boxes/pixel_range.h"

namespace sightline::culling {

// All windows have the same size. Weights are summed up in square cells of pixels, and windows begin and end
// where cells do.
class FocusChoice {
 public:
  // width, height: of the buffer, pixels. window_width, window_height: of a window, pixels; a smaller buffer
  // makes it smaller.
  FocusChoice(std::uint32_t width, std::uint32_t height, std::uint32_t window_width,
              std::uint32_t window_height);

  // A view begins: all weights are 0.
  void begin();
  // Shares a weight among pixels.
  void add(std::span<const BufferPixel> pixels, std::uint32_t weight);
  // Finds the window with the greatest sum of weights, sets these to 0, and returns the sum. Returns 0, and
  // leaves the range as it is, where no window has min_weight.
  std::uint32_t next(double min_weight, occlusion::PixelRange& range);

 private:
  std::uint32_t& at(std::uint32_t column, std::uint32_t row) { return weights_[row * columns_ + column]; }

  std::uint32_t width_, height_, window_width_, window_height_;  // pixels
  std::uint32_t cell_shift_ = 0;                // the side of a cell is 1 << cell_shift_ pixels
  std::uint32_t columns_, rows_;                // cells
  std::uint32_t window_columns_, window_rows_;  // cells
  std::vector<std::uint32_t> weights_;          // by cell
  std::vector<std::uint32_t> sums_;             // by column: the sum of its cells in a window's rows
  std::uint32_t first_row_ = 0, last_row_ = 0;  // the rows of cells between which all weights lie
  bool any_ = false;                            // some weight has been added
};

}  // namespace sightline::culling
