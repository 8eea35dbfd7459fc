#include "src/comparison/layers/min_cost.h"

#include <algorithm>

namespace sightline::comparison {
namespace {

constexpr Bound kMarkAndPart = 0xffffffffu;

// Returns the number of lower bounds that are at most the upper bound.
std::uint32_t lowsUpTo(std::span<const Bound> lows, Bound high) {
  return static_cast<std::uint32_t>(std::upper_bound(lows.begin(), lows.end(), high | kMarkAndPart) -
                                    lows.begin());
}

Division divisionAfter(Bound high, std::uint32_t lower, std::uint32_t upper, std::uint32_t count) {
  Division division;
  division.value = keyOf(high);
  division.left = lower;
  division.right = count - upper;
  division.shared = lower - upper;
  division.cost = division.longer() + division.shared;
  division.place = lower + upper;
  return division;
}

}  // namespace

// With l lower and u upper bounds before a division of n intervals, cost = max(l, n - u) + l - u >= max(l, n
// - u). So once some division costs c, divisions with n - u > c or l > c are worse and need not be compared.
// The division after the middle upper bound gives the first c. Of equal upper bounds only the last is a
// division by value; the ones before it cost more, since u is smaller.
Division minCost(std::span<const Bound> lows, std::span<const Bound> highs) {
  const auto count = static_cast<std::uint32_t>(highs.size());
  if (count == 0) {
    return {};
  }
  const std::uint32_t middle = count / 2;
  const Division probe = divisionAfter(highs[middle], lowsUpTo(lows, highs[middle]), middle + 1, count);
  std::uint32_t max_cost = std::min(probe.cost, count);
  std::uint32_t upper =
      max_cost < count ? count - max_cost - 1 : 0;  // index of the first one with n - u <= c
  std::uint32_t lower = lowsUpTo(lows, highs[upper]);
  Division best;
  best.cost = count + 1;
  for (; upper < count; ++upper) {
    const Bound high = highs[upper] | kMarkAndPart;
    while (lower < count && lows[lower] <= high) {
      ++lower;
    }
    if (lower > max_cost) {
      break;
    }
    const Division division = divisionAfter(high, lower, upper + 1, count);
    if (division.betterThan(best)) {
      best = division;
      max_cost = std::min(max_cost, best.cost);
    }
  }
  return best;
}

}  // namespace sightline::comparison
