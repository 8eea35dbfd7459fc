#pragma once

#include "sightline/math/mat4.h"

namespace sightline::test {

// The matrix that moves what it places by a vector.
constexpr Mat4 translation(const Vec3d& by) {
  Mat4 m;
  for (int axis = 0; axis < 3; ++axis) {
    m(axis, 3) = by[axis];
  }
  return m;
}

}  // namespace sightline::test
