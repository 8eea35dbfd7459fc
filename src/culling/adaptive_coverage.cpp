#include "src/culling/adaptive_coverage.h"

#include <algorithm>
#include <cmath>

namespace sightline::culling {
namespace {

// Culling has a clear gain if it saves more than this many times what it takes. With a smaller gain the ratio
// stays as it is.
constexpr double kClearGain = 1.5;
// Culling is suspended at once if it takes more than this many times what it saves.
constexpr double kHopeless = 4.0;

}  // namespace

AdaptiveCoverage::AdaptiveCoverage(double ratio, std::uint32_t longest_delay)
    : min_ratio_(std::isnan(ratio) ? 0.0 : std::clamp(ratio, 0.0, 1.0)), longest_delay_(longest_delay) {}

double AdaptiveCoverage::ratio() const {
  return min_ratio_ + (1.0 - min_ratio_) * step_ / kSteps;
}

void AdaptiveCoverage::tryAgain() {
  next_delay_ = kRetestDelay;
  retest_delay_ = std::min(retest_delay_, 1u);
}

void AdaptiveCoverage::frame(double culling_us, double saved_us) {
  if (suspended()) {
    if (--retest_delay_ == 0) {
      trial_ = kTrial;
      step_ = 0;
    }
    return;
  }
  if (!std::isfinite(culling_us) || !std::isfinite(saved_us)) {
    return;
  }
  if (trial_ > 0) {
    if (--trial_ == 0) {
      endTrial(saved_us > kClearGain * culling_us);
    }
    return;
  }
  culling_us_ += culling_us;
  saved_us_ += saved_us;
  if (++frames_ == kWindow) {
    endWindow();
    startWindow();
  }
}

void AdaptiveCoverage::endTrial(bool pays) {
  if (!pays) {
    suspend();
    return;
  }
  startWindow();
  next_delay_ = kRetestDelay;
  wait_ = 1;
  good_ = 0;
  lowered_ = false;
}

void AdaptiveCoverage::endWindow() {
  if (culling_us_ > kHopeless * saved_us_) {
    suspend();
  } else if (culling_us_ > saved_us_) {
    raise();
  } else {
    good_ = saved_us_ > kClearGain * culling_us_ ? good_ + 1 : 0;
    wait_ = lowered_ ? 1 : wait_;
    lowered_ = false;
    if (step_ > 0 && good_ >= wait_) {
      lower();
    }
  }
}

void AdaptiveCoverage::raise() {
  wait_ = lowered_ ? std::min(2 * wait_, kMaxWait) : wait_;
  lowered_ = false;
  good_ = 0;
  if (step_ == kSteps || min_ratio_ == 1.0) {
    suspend();
  } else {
    ++step_;
  }
}

void AdaptiveCoverage::lower() {
  --step_;
  good_ = 0;
  lowered_ = true;
}

void AdaptiveCoverage::suspend() {
  retest_delay_ = next_delay_;
  next_delay_ = std::min(2 * next_delay_, longest_delay_);
  step_ = kSteps;
  lowered_ = false;
  good_ = 0;
  startWindow();
}

void AdaptiveCoverage::startWindow() {
  frames_ = 0;
  culling_us_ = saved_us_ = 0.0;
}

}  // namespace sightline::culling
