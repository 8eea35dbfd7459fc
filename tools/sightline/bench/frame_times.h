#pragma once

// Statistics of measured times, with the noise from round to round.

#include <cstddef>
#include <span>
#include <vector>

namespace sightline::tool {

// A statistic over the frames of all rounds, and the least and the greatest that a round alone gives.
struct RoundSpread {
  double value = 0.0, low = 0.0, high = 0.0;
};

struct FrameTimes {
  RoundSpread median{}, mean{}, p99{};
};

// medianOf: between the two middle values if their number is even. percentileOf: the smallest value that at
// least this fraction of the values does not exceed (the nearest rank). All are 0 if there are no values.
double medianOf(std::vector<double> values);
double meanOf(std::span<const double> values);
double percentileOf(std::vector<double> values, double fraction);

// samples: round after round, each with the same number of frames. Precondition: rounds divides their number.
FrameTimes frameTimesOf(std::span<const double> samples, std::size_t rounds);

}  // namespace sightline::tool
