#include "src/hierarchy/sliced_division.h"

#include <algorithm>
#include <utility>

#include "src/math/longest_axis.h"

namespace sightline::hierarchy {
namespace {

constexpr std::size_t kScannedInStep = 8, kComparedInStep = 4, kSelectedInStep = 2;  // items
constexpr std::size_t kFew = 1024;  // items that are always selected at once

void spend(std::uint32_t& steps, std::size_t spent) {
  steps -= static_cast<std::uint32_t>(std::min<std::size_t>(steps, spent));
}

}  // namespace

void SlicedDivision::begin(std::size_t first, std::size_t count, std::size_t left) {
  *this = SlicedDivision();
  low_ = scanned_ = first;
  high_ = end_ = first + count;
  middle_ = first + left;
}

bool SlicedDivision::proceed(std::span<NumberedBox> items, std::uint32_t& steps) {
  if (scanned_ < end_) {
    if (scanned_ == low_) {
      least_ = most_ = center(items[low_].box);
    }
    const std::size_t stop = scanned_ + std::min(end_ - scanned_, std::size_t{steps} * kScannedInStep);
    spend(steps, (stop - scanned_) / kScannedInStep + 1);
    for (; scanned_ < stop; ++scanned_) {
      const Vec3d at = center(items[scanned_].box);
      least_ = min(least_, at);
      most_ = max(most_, at);
    }
    if (scanned_ < end_) {
      return false;
    }
    const Vec3d size = most_ - least_;
    before_.axis = math::longestAxis(size);
  }
  while (low_ < middle_ && middle_ < high_) {
    if (!partitioning_ && high_ - low_ <= std::max(kFew, std::size_t{steps} * kSelectedInStep)) {
      const auto at = [&](std::size_t i) { return items.begin() + static_cast<std::ptrdiff_t>(i); };
      std::nth_element(at(low_), at(middle_), at(high_), before_);
      spend(steps, (high_ - low_) / kSelectedInStep);
      return true;
    }
    if (steps == 0) {
      return false;
    }
    if (!partitioning_) {
      choosePivot(items);
    }
    partition(items, steps);
  }
  return true;
}

// Puts the median of three items to low_.
void SlicedDivision::choosePivot(std::span<NumberedBox> items) {
  std::size_t a = low_, b = low_ + (high_ - low_) / 2, c = high_ - 1;
  if (before_(items[b], items[a])) {
    std::swap(a, b);
  }
  if (before_(items[c], items[b])) {
    b = before_(items[c], items[a]) ? a : c;
  }
  std::swap(items[low_], items[b]);
  partitioning_ = true;
  next_ = low_ + 1;
  last_ = high_;
}

void SlicedDivision::partition(std::span<NumberedBox> items, std::uint32_t& steps) {
  const std::size_t unknown = last_ - next_;
  const std::size_t stop = unknown - std::min(unknown, std::size_t{steps} * kComparedInStep);
  const NumberedBox pivot = items[low_];
  while (last_ - next_ > stop) {
    if (before_(items[next_], pivot)) {
      ++next_;
    } else if (before_(pivot, items[last_ - 1])) {
      --last_;
    } else {
      std::swap(items[next_], items[last_ - 1]);
    }
  }
  spend(steps, (unknown - stop) / kComparedInStep + 1);
  if (next_ < last_) {
    return;
  }
  partitioning_ = false;
  const std::size_t place = next_ - 1;
  std::swap(items[low_], items[place]);
  if (place < middle_) {
    low_ = place + 1;
  } else {
    high_ = place;
  }
}

}  // namespace sightline::hierarchy
