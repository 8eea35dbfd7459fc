#pragma once

// How much occlusion culling is worth its time, learned from what it took and saved.

#include <cstdint>

namespace sightline::culling {

// The coverage ratio below which an opacity map gives up a node, adjusted by measured times (Poon and Wang
// 1999, section 5.2, who leave open how). From the configured ratio it rises in steps to 1 while culling
// takes longer than it saves; after that occlusion culling is suspended, and tried again now and then. Where
// it pays, the ratio falls back. The same times give the same ratios.
//
// Decisions are made over windows of frames, and to lower the ratio takes a clear gain, so that it stays
// where both are about equal. A step down that had to be taken back makes the next one wait longer.
class AdaptiveCoverage {
 public:
  static constexpr std::uint32_t kWindow = 8;        // frames of a decision
  static constexpr std::uint32_t kRest = 16;         // frames from suspending to the next trial
  static constexpr std::uint32_t kTrial = 2;         // frames of a trial; only the last counts
  static constexpr std::uint32_t kLongestWait = 32;  // windows before a step down, at most

  // The configured ratio, the least that is used: 0 to 1, what lies outside is clamped, and NaN is 0.
  explicit AdaptiveCoverage(double ratio);

  // For the next frame.
  double ratio() const;
  bool suspended() const { return rest_ > 0; }

  // What a frame with these settings took and saved. culling_us: microseconds of the whole culling, its
  // frustum tests included. saved_us: microseconds that drawing what it removed beyond frustum
  // culling would have taken. Of frames while suspended both are ignored. Frames with times that are not
  // finite count as not measured.
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
  std::uint32_t step_ = 0;                    // 0: the configured ratio; kSteps: 1
  std::uint32_t rest_ = 0, trial_ = 0;        // frames left of each
  std::uint32_t frames_ = 0;                  // in this window
  double culling_us_ = 0.0, saved_us_ = 0.0;  // in this window
  std::uint32_t wait_ = 1, good_ = 0;         // windows with a clear gain: wanted before a step down, seen
  bool lowered_ = false;                      // the window before ended with a step down
};

}  // namespace sightline::culling
