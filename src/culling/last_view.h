#pragma once

#include "sightline/scene/camera.h"

namespace sightline::culling {

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
