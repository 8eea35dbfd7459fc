#pragma once

#include <chrono>
#include <string>

namespace sightline::tool {

// A line on stderr with the remaining time, for what takes over a second, on a terminal only. Gone when
// destroyed.
class ProgressBar {
 public:
  // begun: the fraction that was done before, which says nothing about the remaining time.
  explicit ProgressBar(std::string stage, double begun = 0.0);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  // done: fraction in [0, 1]. note: behind the bar. Cheap: writes at most ten times a second.
  void update(double done, const std::string& note = "");
  // A line on stderr that stays, whether or not this is a terminal.
  void say(const std::string& line);

 private:
  using Clock = std::chrono::steady_clock;

  std::string stage_;
  double begun_ = 0.0;
  bool terminal_ = false, shown_ = false;
  Clock::time_point start_, last_;
};

}  // namespace sightline::tool
