#pragma once

// Whole numbers of any size and vectors of them. A coordinate in floating point is a whole number times a
// power of two, so with a common power of two all coordinates of a scene are whole numbers, and sums and
// products of them are exact.

#include <boost/multiprecision/cpp_int.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "sightline/math/vec3.h"

namespace sightline {

// Most numbers fit into the 512 bits that the object itself holds; larger ones are allocated.
using Whole = boost::multiprecision::number<
    boost::multiprecision::cpp_int_backend<512, 0, boost::multiprecision::signed_magnitude,
                                           boost::multiprecision::unchecked,
                                           std::allocator<boost::multiprecision::limb_type>>,
    boost::multiprecision::et_off>;

// The number divided by 2^dropped, rounded towards zero. Precondition: the result has at most 60 bits. It
// shifts the magnitude, because shifting a negative number of several limbs to the right loses its sign in
// Boost 1.74 if its lowest limb is 1.
inline double leadingPart(const Whole& number, unsigned dropped) {
  const auto part = static_cast<double>(Whole(Whole(abs(number)) >> dropped));
  return number.sign() < 0 ? -part : part;
}

struct WholeVec {
  Whole x, y, z;
};

inline WholeVec operator+(const WholeVec& a, const WholeVec& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline WholeVec operator-(const WholeVec& a, const WholeVec& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline WholeVec operator-(const WholeVec& a) {
  return {-a.x, -a.y, -a.z};
}
inline WholeVec operator*(const WholeVec& a, const Whole& factor) {
  return {a.x * factor, a.y * factor, a.z * factor};
}
inline Whole dot(const WholeVec& a, const WholeVec& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline WholeVec cross(const WholeVec& a, const WholeVec& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

// The exponent of the lowest bit that is set in a finite number; a large exponent for zero.
inline int lowestExponent(double value) {
  if (value == 0.0) {
    return std::numeric_limits<int>::max() / 4;
  }
  int exponent = 0;
  const auto mantissa = static_cast<std::int64_t>(std::ldexp(std::frexp(value, &exponent), 53));
  return exponent - 53 + std::countr_zero(static_cast<std::uint64_t>(mantissa));
}
inline int lowestExponent(const Vec3d& v) {
  return std::min({lowestExponent(v.x), lowestExponent(v.y), lowestExponent(v.z)});
}

// value * 2^-exponent, which must be whole: `exponent` is at most lowestExponent(value).
inline Whole wholeOf(double value, int exponent) {
  if (value == 0.0) {
    return 0;
  }
  int high = 0;
  const auto mantissa = static_cast<std::int64_t>(std::ldexp(std::frexp(value, &high), 53));
  const int shift = high - 53 - exponent;
  Whole whole = mantissa;
  return shift >= 0 ? Whole(whole << static_cast<unsigned>(shift))
                    : Whole(whole / (Whole(1) << static_cast<unsigned>(-shift)));
}
inline WholeVec wholeOf(const Vec3d& v, int exponent) {
  return {wholeOf(v.x, exponent), wholeOf(v.y, exponent), wholeOf(v.z, exponent)};
}
// A positive multiple of the vector, which need not be the same for two vectors.
inline WholeVec wholeMultipleOf(const Vec3d& v) {
  return wholeOf(v, lowestExponent(v));
}

}  // namespace sightline
