#pragma once

// What most benchmarks share: a stopwatch, averages, the command line.

#include <time.h>

#include <algorithm>
#include <string>
#include <vector>

#include "src/base/stopwatch.h"

namespace sightline::bench {

double microseconds(const auto& function) {
  base::Stopwatch watch;
  function();
  return watch.lap();
}

// Processor time of this thread so far.
inline double processorMicroseconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

inline double medianOf(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0.0 : values[values.size() / 2];
}

inline double meanOf(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) {
    sum += value;
  }
  return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

struct Arguments {
  std::vector<std::string> words;  // without the options: scenes, as a rule
  bool brief = false;              // --benchmark_min_time=...
};

inline Arguments argumentsOf(int argc, char** argv) {
  Arguments arguments;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument.rfind("--benchmark_min_time", 0) == 0) {
      arguments.brief = true;
    } else if (argument.rfind("--", 0) != 0) {
      arguments.words.push_back(argument);
    }
  }
  return arguments;
}

}  // namespace sightline::bench
