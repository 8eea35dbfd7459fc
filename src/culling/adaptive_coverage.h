#pragma once

// Measures whether occlusion culling saves more time than it takes, and adjusts it accordingly.

#include <cstdint>

namespace sightline::culling {

// Adjusts, by measured times, the coverage ratio below which an opacity map does not subdivide a node (Poon
// and Wang 1999, section 5.2; the paper does not say how to adjust it). While culling takes longer than it
// saves, the ratio rises in steps from the configured value to 1. If that does not help, occlusion culling is
// suspended and tried again after a delay. When culling saves more than it takes, the ratio falls again.
// Equal times give equal ratios. Where the configured ratio is 1 there are no steps: culling is suspended or
// not.
//
// Each decision is based on a window of several frames. The ratio is lowered only after a clear gain, so that
// it does not oscillate where gain and cost are about equal. If a step down had to be undone, the next one
// waits for more windows.
class AdaptiveCoverage {
 public:
  static constexpr std::uint32_t kWindow = 8;        // frames per decision
  static constexpr std::uint32_t kRetestDelay = 16;  // frames from suspending to the first trial
  static constexpr std::uint32_t kTrial = 2;         // frames per trial; only the last one is measured
  static constexpr std::uint32_t kMaxWait = 32;      // maximum number of windows before a step down

  // ratio: the minimum coverage ratio. It is clamped to [0, 1], and NaN counts as 0. longest_delay: with each
  // trial that fails, the delay before the next one doubles up to so many frames.
  explicit AdaptiveCoverage(double ratio, std::uint32_t longest_delay = kRetestDelay);

  // The coverage ratio to use in the next frame.
  double ratio() const;
  // True if the next frame should do without occlusion culling.
  bool suspended() const { return retest_delay_ > 0; }

  // The viewer is at another place: suspended culling is tried after one more frame, and delays are short
  // again.
  void tryAgain();

  // Reports the times of a frame that used these settings. culling_us: microseconds that culling took,
  // including its frustum tests. saved_us: microseconds that it would have taken to draw the objects that
  // occlusion culling removed in addition to frustum culling. Both are ignored while culling is suspended,
  // and so are frames whose times are not finite.
  void frame(double culling_us, double saved_us);

 private:
  static constexpr std::uint32_t kSteps = 4;  // from the configured ratio to 1

  void endTrial(bool pays);
  void endWindow();
  void raise();
  void lower();
  void suspend();
  void startWindow();

  double min_ratio_ = 0.0;
  std::uint32_t longest_delay_ = 0;
  std::uint32_t step_ = 0;                   // 0: the configured ratio; kSteps: a ratio of 1
  std::uint32_t retest_delay_ = 0;           // frames until suspended culling is tried again
  std::uint32_t next_delay_ = kRetestDelay;  // when it is suspended the next time
  std::uint32_t trial_ = 0;                  // frames left of the current trial
  // Frames measured in the current window, and the sums of their times, microseconds.
  std::uint32_t frames_ = 0;
  double culling_us_ = 0.0, saved_us_ = 0.0;
  // Consecutive windows with a clear gain: the number needed before a step down, and the number seen so far.
  std::uint32_t wait_ = 1, good_ = 0;
  bool lowered_ = false;  // the last window ended with a step down
};

}  // namespace sightline::culling
