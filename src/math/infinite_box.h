#pragma once

#include <limits>

#include "sightline/math/box.h"

namespace sightline::math {

// All of space. It is not well formed, so that nothing hides it.
constexpr Box infiniteBox() {
  constexpr float kFar = std::numeric_limits<float>::infinity();
  return {{-kFar, -kFar, -kFar}, {kFar, kFar, kFar}};
}

}  // namespace sightline::math
