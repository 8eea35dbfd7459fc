#include "src/culling/focus_choice.h"

#include <algorithm>

namespace sightline::culling {

FocusChoice::FocusChoice(std::uint32_t width, std::uint32_t height, std::uint32_t window_width,
                         std::uint32_t window_height)
    : width_(width),
      height_(height),
      window_width_(std::min(window_width, width)),
      window_height_(std::min(window_height, height)) {
  constexpr std::uint32_t kCells = 4;  // along a side of a window, if it has so many pixels
  while (kCells << (cell_shift_ + 1) <= std::min(window_width_, window_height_)) {
    ++cell_shift_;
  }
  const auto cells = [this](std::uint32_t pixels) {
    return (pixels + (1u << cell_shift_) - 1) >> cell_shift_;
  };
  columns_ = cells(width);
  rows_ = cells(height);
  window_columns_ = std::max(window_width_ >> cell_shift_, 1u);
  window_rows_ = std::max(window_height_ >> cell_shift_, 1u);
  weights_.assign(std::size_t{columns_} * rows_, 0);
  sums_.assign(columns_, 0);
}

void FocusChoice::begin() {
  if (any_) {
    std::fill(weights_.begin() + std::size_t{first_row_} * columns_,
              weights_.begin() + (std::size_t{last_row_} + 1) * columns_, 0u);
  }
  any_ = false;
  first_row_ = rows_;
  last_row_ = 0;
}

void FocusChoice::add(std::span<const BufferPixel> pixels, std::uint32_t weight) {
  const auto count = static_cast<std::uint32_t>(pixels.size());
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t share = weight * (i + 1) / count - weight * i / count;
    const std::uint32_t row = pixels[i].y >> cell_shift_;
    at(pixels[i].x >> cell_shift_, row) += share;
    first_row_ = std::min(first_row_, row);
    last_row_ = std::max(last_row_, row);
  }
  any_ = any_ || (count > 0 && weight > 0);
}

std::uint32_t FocusChoice::next(double min_weight, occlusion::PixelRange& range) {
  if (!any_) {
    return 0;
  }
  std::uint32_t max_sum = 0, best_column = 0, best_row = 0;
  // A window may begin in these rows: others have no weight in them.
  const std::uint32_t highest = rows_ - window_rows_;
  const std::uint32_t last = std::min(last_row_, highest);
  std::uint32_t row = std::min(first_row_ < window_rows_ ? 0 : first_row_ - window_rows_ + 1, highest);
  for (; row <= last; ++row) {
    std::copy_n(&at(0, row), columns_, sums_.begin());
    for (std::uint32_t other = row + 1; other < row + window_rows_; ++other) {
      const std::uint32_t* more = &at(0, other);
      for (std::uint32_t x = 0; x < columns_; ++x) {
        sums_[x] += more[x];
      }
    }
    std::uint32_t sum = 0;
    for (std::uint32_t x = 0; x < columns_; ++x) {
      sum += sums_[x];
      if (x + 1 < window_columns_) {
        continue;
      }
      const std::uint32_t first = x + 1 - window_columns_;
      if (sum > max_sum) {
        max_sum = sum;
        best_column = first;
        best_row = row;
      }
      sum -= sums_[first];
    }
  }
  if (max_sum == 0 || max_sum < min_weight) {
    return 0;
  }
  for (std::uint32_t y = best_row; y < best_row + window_rows_; ++y) {
    std::fill_n(&at(best_column, y), window_columns_, 0u);
  }
  const std::uint32_t x0 = std::min(best_column << cell_shift_, width_ - window_width_);
  const std::uint32_t y0 = std::min(best_row << cell_shift_, height_ - window_height_);
  range = {static_cast<std::uint16_t>(x0), static_cast<std::uint16_t>(y0),
           static_cast<std::uint16_t>(x0 + window_width_ - 1),
           static_cast<std::uint16_t>(y0 + window_height_ - 1)};
  return max_sum;
}

}  // namespace sightline::culling
