#include "tools/sightline/bench/frame_times.h"

#include <algorithm>
#include <cmath>

namespace sightline::tool {
namespace {

template <typename Statistic>
RoundSpread roundSpreadOf(std::span<const double> samples, std::size_t rounds, Statistic&& statistic) {
  if (samples.empty() || rounds == 0) {
    return {};
  }
  RoundSpread spread{.value = statistic(samples)};
  const std::size_t frames = samples.size() / rounds;
  for (std::size_t round = 0; round < rounds; ++round) {
    const double of_round = statistic(samples.subspan(round * frames, frames));
    spread.low = round == 0 ? of_round : std::min(spread.low, of_round);
    spread.high = round == 0 ? of_round : std::max(spread.high, of_round);
  }
  return spread;
}

}  // namespace

double medianOf(std::vector<double> values) {
  if (values.empty()) {
    return 0.0;
  }
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

double meanTime(std::span<const double> values) {
  double sum = 0.0;
  for (const double value : values) {
    sum += value;
  }
  return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

double percentileOf(std::vector<double> values, double fraction) {
  if (values.empty()) {
    return 0.0;
  }
  std::sort(values.begin(), values.end());
  const auto rank = static_cast<std::size_t>(std::ceil(fraction * static_cast<double>(values.size())));
  return values[std::clamp<std::size_t>(rank, 1, values.size()) - 1];
}

FrameTimes frameTimesOf(std::span<const double> samples, std::size_t rounds) {
  const auto copy = [](std::span<const double> values) {
    return std::vector<double>(values.begin(), values.end());
  };
  return {
      roundSpreadOf(samples, rounds, [&](std::span<const double> values) { return medianOf(copy(values)); }),
      roundSpreadOf(samples, rounds, meanTime),
      roundSpreadOf(samples, rounds,
                    [&](std::span<const double> values) { return percentileOf(copy(values), 0.99); })};
}

}  // namespace sightline::tool
