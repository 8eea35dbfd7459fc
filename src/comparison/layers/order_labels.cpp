#include "src/comparison/layers/order_labels.h"

#include <algorithm>

namespace sightline::comparison {

namespace {

constexpr int kLabelBits = 62;
constexpr std::uint64_t kEndLabel = std::uint64_t{1} << kLabelBits;

// A range of 2^i labels is crowded if it holds (2 / T)^i items or more, for some 1 < T < 2. Here 2 / T = 4 /
// 3, so that labels differ by at least 2 after spreading.
constexpr double kCrowdGrowth = 4.0 / 3.0;

}  // namespace

void OrderLabels::assign(std::span<const std::uint32_t> items, std::size_t bound) {
  head_ = static_cast<std::uint32_t>(bound);
  labels_.resize(bound + 1);
  next_.resize(bound + 1);
  previous_.resize(bound + 1);
  // Half of the labels stay free behind the last item, where most insertions go.
  step_ = kEndLabel / 2 / (items.size() + 1);
  labels_[head_] = 0;
  std::uint32_t last = head_;
  for (const std::uint32_t item : items) {
    labels_[item] = labels_[last] + step_;
    next_[last] = item;
    previous_[item] = last;
    last = item;
  }
  next_[last] = head_;
  previous_[head_] = last;
}

void OrderLabels::remove(std::uint32_t item) {
  next_[previous_[item]] = next_[item];
  previous_[next_[item]] = previous_[item];
}

void OrderLabels::insertAfter(std::uint32_t item, std::uint32_t place) {
  if (gapAfter(place) < 2) {
    spread(place);
  }
  labels_[item] = labels_[place] + std::min(gapAfter(place) / 2, step_);
  const std::uint32_t after = next_[place];
  next_[place] = item;
  previous_[item] = place;
  next_[item] = after;
  previous_[after] = item;
}

std::uint64_t OrderLabels::gapAfter(std::uint32_t place) const {
  const std::uint32_t after = next_[place];
  return (after == head_ ? kEndLabel : labels_[after]) - labels_[place];
}

// Finds the smallest aligned range around the place that is not crowded, and labels its items evenly.
void OrderLabels::spread(std::uint32_t place) {
  std::uint32_t first = place;
  std::uint32_t last = place;
  std::uint64_t count = 1;
  double crowd = 1.0;
  for (int bits = 1; bits <= kLabelBits; ++bits) {
    crowd *= kCrowdGrowth;
    const std::uint64_t size = std::uint64_t{1} << bits;
    const std::uint64_t low = labels_[place] & ~(size - 1);
    for (; first != head_ && labels_[previous_[first]] >= low; ++count) {
      first = previous_[first];
    }
    for (; next_[last] != head_ && labels_[next_[last]] < low + size; ++count) {
      last = next_[last];
    }
    if (static_cast<double>(count) < crowd || bits == kLabelBits) {
      const std::uint64_t step = size / count;
      std::uint32_t item = first;
      for (std::uint64_t i = 0; i < count; ++i, item = next_[item]) {
        labels_[item] = low + i * step;
      }
      return;
    }
  }
}

}  // namespace sightline::comparison
