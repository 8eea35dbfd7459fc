#pragma once

// Finds out whether a depth buffer is nearer than a box at every pixel of a rectangle, comparing few of its
// pixels.

#include <cstdint>
#include <vector>

#include "sightline/occlusion/rasteriser.h"
#include "src/occlusion/boxes/pixel_boxes.h"

namespace sightline::occlusion {

// All ways of comparing give the same answer: true where every covered pixel of the rectangle, which lies in
// the buffer, is nearer than the box's nearest point; a pixel that is as near is not nearer. Uncovered pixels
// are left out, for the overlap test decides whether there may be any.

// Compares pixel by pixel, row by row up to the first that is not nearer. compared: increased by the number
// of pixels compared.
bool allNearerPixelwise(const DepthBufferView& buffer, const PixelBox& rect, std::uint64_t& compared);

// The sparse depth map of Poon and Wang 1999, section 5.3: for each pixel the distance to the next peak on
// its right, a peak being a pixel that is locally the farthest of its row. Between two peaks depth falls and
// then rises, so that no pixel between two others is farther than both. So it suffices to compare the first
// pixel of a row of the rectangle, the peaks in it and its last pixel.
//
// Making a row of the sparse map takes as long as comparing it pixel by pixel several times in vector code.
// So a row is made only after that many comparisons, and rows without coverage never are. Rows, and whole
// buffers, with too many peaks are compared pixel by pixel, as are narrow rectangles. With kAlways none of
// this holds: the table of a row is made for the first rectangle in it, and used for all.
class SparseDepth {
 public:
  enum class Use : std::uint8_t { kWherePaying, kAlways };

  explicit SparseDepth(Use use = Use::kWherePaying) : use_(use) {}

  // After a buffer with too many peaks, so many buffers are compared pixel by pixel before rows are made
  // again.
  static constexpr std::uint32_t kRetestDelay = 15;

  // Starts with another buffer, which must stay valid while it is compared with. Allocates only for buffers
  // larger than all before.
  void begin(const DepthBufferView& buffer);

  bool allNearer(const PixelBox& rect);

  // False where this buffer is compared pixel by pixel because an earlier one had too many peaks.
  bool worthwhile() const { return retest_delay_ == 0; }
  // The number of rows of this buffer that were compared at their peaks.
  std::uint32_t rowsUsed() const { return rows_used_; }
  // The number of pixels of this buffer that were compared.
  std::uint64_t compared() const { return compared_; }

 private:
  enum class RowState : std::uint8_t { kNotMade, kSteps, kTooManyPeaks };
  struct Row {
    std::uint32_t compared = 0;  // pixels that were compared before the row was made
    RowState state = RowState::kNotMade;
  };

  RowState stateOf(std::uint32_t y, std::uint32_t asked);
  void makeRow(std::uint32_t y);
  bool nearerAtPeaks(const PixelBox& rect, std::uint32_t y);

  Use use_;
  DepthBufferView buffer_;
  std::vector<std::uint16_t> steps_;  // by pixel: pixels to the next peak or the row's end
  std::vector<Row> rows_;
  std::uint64_t made_ = 0, peaks_ = 0;  // pixels of this buffer's rows that were made, and peaks in them
  std::uint32_t retest_delay_ = 0;      // buffers still to be compared pixel by pixel, with this one
  std::uint32_t rows_used_ = 0;
  std::uint64_t compared_ = 0;
};

}  // namespace sightline::occlusion
