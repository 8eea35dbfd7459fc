#pragma once

#include <algorithm>

namespace sightline::culling {

// How much may be drawn in a frame that is to take so many microseconds in all, from what the last frames
// took.
class TimedBudget {
 public:
  explicit TimedBudget(double frame_us) : frame_us_(frame_us) {}

  bool limits() const { return frame_us_ > 0.0; }
  // As SurfaceLimits::budget counts.
  double work() const { return std::max(frame_us_ - rest_us_, 0.0) * (drawn_ / drawing_us_); }

  // Reports a frame: what was drawn first, how long building the frame's structure took, most of which is
  // that drawing, what was drawn later, and how long all the rest took, later drawing included. What a frame
  // took far beyond expectation, as when the thread had to wait, says little about the next one.
  void frame(double drawn, double building_us, double drawn_later, double rest_us) {
    rest_us = std::max(rest_us - drawn_later * (drawing_us_ / drawn_), 0.0);
    if (drawn > 0.0 && building_us > 0.0) {
      const double expected_us = drawn * (drawing_us_ / drawn_);
      drawn_ = kMemory * drawn_ + drawn;
      drawing_us_ = kMemory * drawing_us_ + std::min(building_us, kOutlier * expected_us);
    }
    rest_us_ = kMemory * rest_us_ + (1.0 - kMemory) * std::min(rest_us, frame_us_);
  }

 private:
  static constexpr double kMemory = 0.75, kOutlier = 2.0;

  double frame_us_;
  double drawn_ = 100.0, drawing_us_ = 10.0;  // of the last frames, fading; at first about what is usual
  double rest_us_ = 0.0;                      // of a frame
};

}  // namespace sightline::culling
