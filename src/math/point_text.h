#pragma once

#include <string>

#include "sightline/math/vec3.h"

namespace sightline::math {

// The coordinates of a point, for an error message.
template <typename T>
std::string textOf(const Vec3<T>& point) {
  return "(" + std::to_string(point.x) + ", " + std::to_string(point.y) + ", " + std::to_string(point.z) +
         ")";
}

}  // namespace sightline::math
