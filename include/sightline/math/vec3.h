#pragma once

#include <algorithm>
#include <cmath>

#include "sightline/base/inline.h"

namespace sightline {

// Three coordinates. The variable's name says whether they are a point or a direction.
template <typename T>
struct Vec3 {
  T x{}, y{}, z{};

  constexpr Vec3() = default;
  constexpr Vec3(T x_, T y_, T z_) : x(x_), y(y_), z(z_) {}
  template <typename U>
  constexpr explicit Vec3(const Vec3<U>& v)
      : x(static_cast<T>(v.x)), y(static_cast<T>(v.y)), z(static_cast<T>(v.z)) {}

  constexpr T& operator[](int axis) { return axis == 0 ? x : axis == 1 ? y : z; }
  constexpr const T& operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }

  SIGHTLINE_INLINE friend constexpr Vec3 operator+(const Vec3& a, const Vec3& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  SIGHTLINE_INLINE friend constexpr Vec3 operator-(const Vec3& a, const Vec3& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  SIGHTLINE_INLINE friend constexpr Vec3 operator*(const Vec3& a, T s) { return {a.x * s, a.y * s, a.z * s}; }
  SIGHTLINE_INLINE friend constexpr Vec3 operator*(T s, const Vec3& a) { return a * s; }
  SIGHTLINE_INLINE friend constexpr Vec3 operator/(const Vec3& a, T s) { return {a.x / s, a.y / s, a.z / s}; }
  constexpr Vec3 operator-() const { return {-x, -y, -z}; }
  SIGHTLINE_INLINE constexpr Vec3& operator+=(const Vec3& b) { return *this = *this + b; }
  SIGHTLINE_INLINE constexpr Vec3& operator-=(const Vec3& b) { return *this = *this - b; }
  SIGHTLINE_INLINE friend constexpr bool operator==(const Vec3&, const Vec3&) = default;
};

using Vec3f = Vec3<float>;
using Vec3d = Vec3<double>;

template <typename T>
SIGHTLINE_INLINE constexpr T dot(const Vec3<T>& a, const Vec3<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <typename T>
SIGHTLINE_INLINE constexpr Vec3<T> cross(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <typename T>
SIGHTLINE_INLINE T length(const Vec3<T>& a) {
  return std::sqrt(dot(a, a));
}
// Unit vector; the zero vector stays zero.
template <typename T>
SIGHTLINE_INLINE Vec3<T> normalized(const Vec3<T>& a) {
  const T l = length(a);
  return l > T(0) ? a / l : a;
}
template <typename T>
SIGHTLINE_INLINE constexpr Vec3<T> min(const Vec3<T>& a, const Vec3<T>& b) {
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
template <typename T>
SIGHTLINE_INLINE constexpr Vec3<T> max(const Vec3<T>& a, const Vec3<T>& b) {
  return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}
template <typename T>
SIGHTLINE_INLINE constexpr Vec3<T> abs(const Vec3<T>& a) {
  return {a.x < T(0) ? -a.x : a.x, a.y < T(0) ? -a.y : a.y, a.z < T(0) ? -a.z : a.z};
}
template <typename T>
SIGHTLINE_INLINE constexpr T maxComponent(const Vec3<T>& a) {
  return std::max(a.x, std::max(a.y, a.z));
}
template <typename T>
SIGHTLINE_INLINE bool isFinite(const Vec3<T>& a) {
  // Not std::isfinite, which is a function where nothing is inlined.
  return __builtin_isfinite(a.x) && __builtin_isfinite(a.y) && __builtin_isfinite(a.z);
}

}  // namespace sightline
