#pragma once

#include <chrono>
#include <utility>

namespace sightline::base {

// Wall-clock time, from construction on.
class Stopwatch {
 public:
  // Microseconds since the last call, or since construction.
  double lap() {
    const Clock::time_point now = Clock::now();
    return std::chrono::duration<double, std::micro>(now - std::exchange(last_, now)).count();
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point last_ = Clock::now();
};

}  // namespace sightline::base
