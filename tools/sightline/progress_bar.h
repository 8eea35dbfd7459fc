#pragma once

#include <chrono>
#include <string>

namespace sightline::tool {

// A line on stderr with the remaining time, for what takes over a second, on a terminal only. Gone when
// destroyed.
class ProgressBar {
 public:
  explicit ProgressBar(std::string stage);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  // done: fraction in [0, 1]. Cheap: writes at most ten times a second.
  void update(double done);

 private:
  using Clock = std::chrono::steady_clock;

  std::string stage_;
  bool terminal_ = false, shown_ = false;
  Clock::time_point start_, last_;
};

}  // namespace sightline::tool
