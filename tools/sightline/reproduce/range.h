#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <string>

namespace sightline::tool {

// The smallest and the largest of some values.
struct Range {
  double low = std::numeric_limits<double>::infinity(), high = -low;

  void add(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  bool empty() const { return low > high; }
  std::string text(int decimals) const {
    return fmt::format("{:.{}f} to {:.{}f}", low, decimals, high, decimals);
  }
};

}  // namespace sightline::tool
