#include "src/occlusion/boxes/sparse_depth.h"

#include <algorithm>
#include <limits>

namespace sightline::occlusion {
namespace {

// A step from peak to peak takes about as long as comparing this many pixels in vector code.
constexpr std::uint32_t kWorthwhileStep = 8;
// Narrower rectangles are compared pixel by pixel.
constexpr std::uint32_t kWorthwhileWidth = 20;
// Making a row takes as long as comparing all of it about this many times.
constexpr std::uint32_t kWorthwhileQuestions = 8;

// Uncovered pixels are nearer than anything.
float comparable(float reciprocal_depth) {
  return reciprocal_depth > kUncovered ? reciprocal_depth : std::numeric_limits<float>::infinity();
}

// Not branching, so that the compiler makes vector code of it.
std::uint32_t fails(float reciprocal_depth, float nearest) {
  return static_cast<std::uint32_t>(!(reciprocal_depth > nearest)) &
         static_cast<std::uint32_t>(reciprocal_depth > kUncovered);
}

// No early end, for the same reason.
bool allNearerInRow(const float* first, std::size_t count, float nearest) {
  std::uint32_t failing = 0;
  for (std::size_t i = 0; i < count; ++i) {
    failing |= fails(first[i], nearest);
  }
  return failing == 0;
}

}  // namespace

bool allNearerPixelwise(const DepthBufferView& buffer, const PixelBox& rect, std::uint64_t& compared) {
  const std::size_t width = std::size_t{rect.x1} - rect.x0 + 1;
  for (std::uint32_t y = rect.y0; y <= rect.y1; ++y) {
    compared += width;
    if (!allNearerInRow(buffer.row(y).data() + rect.x0, width, rect.nearest)) {
      return false;
    }
  }
  return true;
}

void SparseDepth::begin(const DepthBufferView& buffer) {
  if (retest_delay_ > 0) {
    --retest_delay_;
  } else if (use_ == Use::kWherePaying && peaks_ * kWorthwhileStep > made_) {
    retest_delay_ = kRetestDelay;
  }
  buffer_ = buffer;
  steps_.resize(std::size_t{buffer.width} * buffer.height);
  rows_.assign(buffer.height, {});
  made_ = peaks_ = compared_ = 0;
  rows_used_ = 0;
}

// Goes from right to left. Neighbouring pixels of equal depth count as one; the leftmost is the peak.
void SparseDepth::makeRow(std::uint32_t y) {
  const std::span<const float> row = buffer_.row(y);
  std::uint16_t* steps = &steps_[std::size_t{y} * buffer_.width];
  std::uint32_t next = buffer_.width;  // peak on the right of x, or the row's end
  std::uint32_t peaks = 0;
  bool nearer_beyond = false;  // from x + 1 to the right depth falls, or stays and then falls
  float right = comparable(row[buffer_.width - 1]);
  steps[buffer_.width - 1] = 1;
  for (std::uint32_t x = buffer_.width - 1; x-- > 0;) {
    const float here = comparable(row[x]);
    if (here > right && nearer_beyond) {
      next = x + 1;
      ++peaks;
    }
    nearer_beyond = here < right || (here == right && nearer_beyond);
    steps[x] = static_cast<std::uint16_t>(next - x);
    right = here;
  }
  made_ += buffer_.width;
  peaks_ += peaks;
  const bool too_many = use_ == Use::kWherePaying && peaks * kWorthwhileStep > buffer_.width;
  rows_[y].state = too_many ? RowState::kTooManyPeaks : RowState::kSteps;
  rows_used_ += too_many ? 0 : 1;
}

// The paper leaves out what happens where the next peak lies beyond the rectangle: depth may rise up to the
// last pixel, so that pixel is compared too.
bool SparseDepth::nearerAtPeaks(const PixelBox& rect, std::uint32_t y) {
  const float* row = buffer_.row(y).data();
  const std::uint16_t* steps = &steps_[std::size_t{y} * buffer_.width];
  for (std::uint32_t x = rect.x0; x < rect.x1; x += steps[x]) {
    ++compared_;
    if (fails(row[x], rect.nearest) != 0) {
      return false;
    }
  }
  ++compared_;
  return fails(row[rect.x1], rect.nearest) == 0;
}

SparseDepth::RowState SparseDepth::stateOf(std::uint32_t y, std::uint32_t asked) {
  Row& row = rows_[y];
  if (row.state == RowState::kNotMade) {
    if (use_ == Use::kWherePaying && row.compared < kWorthwhileQuestions * buffer_.width) {
      row.compared += asked;
    } else {
      makeRow(y);
    }
  }
  return row.state;
}

bool SparseDepth::allNearer(const PixelBox& rect) {
  const std::uint32_t width = rect.x1 - rect.x0 + 1u;
  if (use_ == Use::kWherePaying && (retest_delay_ > 0 || width < kWorthwhileWidth)) {
    return allNearerPixelwise(buffer_, rect, compared_);
  }
  for (std::uint32_t y = rect.y0; y <= rect.y1; ++y) {
    bool nearer;
    if (stateOf(y, width) == RowState::kSteps) {
      nearer = nearerAtPeaks(rect, y);
    } else {
      compared_ += width;
      nearer = allNearerInRow(buffer_.row(y).data() + rect.x0, width, rect.nearest);
    }
    if (!nearer) {
      return false;
    }
  }
  return true;
}

}  // namespace sightline::occlusion
