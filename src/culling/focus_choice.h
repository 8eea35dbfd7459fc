#pragma once

// Chooses the parts of a view in which most pixels are in doubt.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/occlusion/depth_pyramid.h"

namespace sightline::culling {

class FocusChoice {
 public:
  // width, height: of the buffer. window_width, window_height: of a part, as far as the buffer has so many
  // pixels.
  FocusChoice(std::uint32_t width, std::uint32_t height, std::uint32_t window_width,
              std::uint32_t window_height);

  void begin();
  // Shares a weight among pixels.
  void add(std::span<const BufferPixel> pixels, std::uint32_t weight);
  // Finds the part with the greatest sum of weights, takes them away, and returns the sum. 0: no part has so
  // much.
  std::uint32_t next(double min_weight, PixelRange& range);

 private:
  std::uint32_t& at(std::uint32_t column, std::uint32_t row) { return weights_[row * columns_ + column]; }

  std::uint32_t width_, height_, window_width_, window_height_;  // pixels
  std::uint32_t cell_shift_ = 0;                // the side of a cell is 1 << cell_shift_ pixels
  std::uint32_t columns_, rows_;                // cells
  std::uint32_t window_columns_, window_rows_;  // cells
  std::vector<std::uint32_t> weights_;          // by cell
  std::vector<std::uint32_t> sums_;             // by column: of the rows of a part
  std::uint32_t first_row_ = 0, last_row_ = 0;  // that have weights
  bool any_ = false;                            // some weight is not 0
};

}  // namespace sightline::culling
