#pragma once

#include "sightline/math/vec3.h"

namespace sightline::math {

// The axis along which a vector's coordinate is largest, the first of equal ones.
template <typename T>
constexpr int longestAxis(const Vec3<T>& size) {
  return size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
}

}  // namespace sightline::math
