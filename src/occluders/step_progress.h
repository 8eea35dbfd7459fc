#pragma once

#include <cstdint>
#include <mutex>

#include "sightline/base/progress.h"

namespace sightline::occluders {

// Counts finished steps, from any thread, and passes their fraction on, one call at a time.
class StepProgress {
 public:
  // progress must outlive this.
  StepProgress(const Progress& progress, std::uint32_t steps) : progress_(progress), steps_(steps) {}

  void stepDone() {
    if (progress_) {
      const std::lock_guard lock(mutex_);
      progress_(static_cast<double>(++done_) / steps_);
    }
  }

 private:
  const Progress& progress_;
  std::mutex mutex_;
  std::uint32_t steps_, done_ = 0;
};

}  // namespace sightline::occluders
