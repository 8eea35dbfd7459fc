#pragma once

#include <cstddef>

#include "sightline/scene/camera.h"

namespace sightline::culling {

// Whether so many of the objects that are kept are new, compared with the last frame, that the view changes
// fast: what the last frame kept is then not enough to hide what is behind the new ones.
constexpr bool changesFast(std::size_t new_count, std::size_t kept_count) {
  constexpr std::size_t kCalm = 16;  // one of so many may be new
  return new_count * kCalm > kept_count;
}

// Whether most of what is kept is new: what was of no use in earlier frames says nothing of this one.
constexpr bool mostIsNew(std::size_t new_count, std::size_t kept_count) {
  return 2 * new_count > kept_count;
}

// Keeps the view of the last frame, to detect jumps of the camera.
class LastView {
 public:
  // Takes the next view. Returns true if the camera jumped: there was no last view, the camera turned by more
  // than 60 degrees, or its step is more than ten times the last one.
  bool jumpsTo(const View& view) {
    const double step = known_ ? length(view.eye - eye_) : 0.0;
    const bool jump =
        !known_ || dot(view.forward, forward_) < kJumpCosine || (step_ > 0.0 && step > kJumpSteps * step_);
    step_ = !jump && step > 0.0 ? step : step_;
    known_ = true;
    eye_ = view.eye;
    forward_ = view.forward;
    return jump;
  }
  void forget() { known_ = false; }

  // Length of the last step that was neither a jump nor 0, metres; 0 if there was none yet.
  double step() const { return step_; }

 private:
  static constexpr double kJumpCosine = 0.5;
  static constexpr double kJumpSteps = 10.0;

  bool known_ = false;
  Vec3d eye_, forward_;
  double step_ = 0.0;
};

}  // namespace sightline::culling
