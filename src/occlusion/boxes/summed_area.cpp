#include "src/occlusion/boxes/summed_area.h"

#include <algorithm>

namespace sightline::occlusion {
namespace {

// A function of its own, so that the compiler makes vector code of it.
void addCovered(const float* reciprocal_depth, std::size_t width, std::uint32_t* columns) {
  for (std::size_t x = 0; x < width; ++x) {
    columns[x] += reciprocal_depth[x] > kUncovered ? 1u : 0u;
  }
}

}  // namespace

void SummedArea::build(const DepthBufferView& buffer) {
  stride_ = std::size_t{buffer.width} + 1;
  sums_.resize(stride_ * (std::size_t{buffer.height} + 1));
  columns_.assign(buffer.width, 0);
  std::fill_n(sums_.begin(), stride_, 0u);
  for (std::uint32_t y = 0; y < buffer.height; ++y) {
    addCovered(buffer.row(y).data(), buffer.width, columns_.data());
    std::uint32_t* sums = &sums_[(std::size_t{y} + 1) * stride_];
    std::uint32_t sum = 0;
    sums[0] = 0;
    for (std::size_t x = 0; x < buffer.width; ++x) {
      sum += columns_[x];
      sums[x + 1] = sum;
    }
  }
}

}  // namespace sightline::occlusion
