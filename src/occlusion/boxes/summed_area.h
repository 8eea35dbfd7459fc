#pragma once

// Counts the covered pixels of a rectangle by three integer operations.

#include <cstdint>
#include <vector>

#include "sightline/occlusion/rasteriser.h"
#include "src/occlusion/boxes/pixel_boxes.h"

namespace sightline::occlusion {

// The opacity map of Poon and Wang 1999, section 5.1: each entry counts the covered pixels below and to the
// left of it; a row and a column of zeros go before them. Empty until built.
class SummedArea {
 public:
  // Counts the pixels of a depth buffer, of which nothing is kept. Allocates only for buffers larger than all
  // before.
  void build(const DepthBufferView& buffer);

  // Returns the covered pixels of a rectangle that lies in the buffer.
  std::uint32_t count(const PixelBox& rect) const {
    const std::uint32_t* below = &sums_[std::size_t{rect.y0} * stride_];
    const std::uint32_t* above = &sums_[(std::size_t{rect.y1} + 1) * stride_];
    return above[rect.x1 + 1] - above[rect.x0] - below[rect.x1 + 1] + below[rect.x0];
  }
  // Returns the covered pixels of the whole buffer.
  std::uint32_t count() const { return sums_.empty() ? 0 : sums_.back(); }

 private:
  std::vector<std::uint32_t> sums_;     // height + 1 rows of stride_
  std::vector<std::uint32_t> columns_;  // covered pixels of each column so far, while building
  std::size_t stride_ = 0;              // the buffer's width + 1
};

inline std::uint32_t areaOf(const PixelBox& rect) {
  return (std::uint32_t{rect.x1} - rect.x0 + 1) * (std::uint32_t{rect.y1} - rect.y0 + 1);
}

}  // namespace sightline::occlusion
