#pragma once

#include <chrono>
#include <string>

namespace sightline::tool {

// A line on stderr with the remaining time. It appears after a second, on a terminal only, and is erased by
// the destructor.
class ProgressBar {
 public:
  // begun is the fraction that was done before; it does not count for the estimate of the remaining time.
  explicit ProgressBar(std::string stage, double begun = 0.0);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  // Shows the fraction in [0, 1] that is done, and a note behind the bar. Writes at most ten times a second.
  void update(double done, const std::string& note = "");
  // Prints a line on stderr that stays, on a terminal or not.
  void say(const std::string& line);

 private:
  using Clock = std::chrono::steady_clock;

  std::string stage_;
  double begun_ = 0.0;
  bool terminal_ = false, shown_ = false;
  Clock::time_point start_, last_;
};

}  // namespace sightline::tool
