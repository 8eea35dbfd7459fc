#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "sightline/base/inline.h"
#include "sightline/math/vec3.h"

namespace sightline {

// 4 x 4 matrix for column vectors, column-major: element(row, column) is m[4 * column + row]. Names are
// target-from-source: clip_from_world * point_world is in clip space.
struct Mat4 {
  std::array<double, 16> m{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

  constexpr double& operator()(int row, int column) { return m[static_cast<std::size_t>(4 * column + row)]; }
  constexpr double operator()(int row, int column) const {
    return m[static_cast<std::size_t>(4 * column + row)];
  }
};

SIGHTLINE_INLINE constexpr Mat4 operator*(const Mat4& a, const Mat4& b) {
  Mat4 r;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      double sum = 0.0;
      for (int k = 0; k < 4; ++k) {
        sum += a(row, k) * b(k, column);
      }
      r(row, column) = sum;
    }
  }
  return r;
}

constexpr Mat4 transposed(const Mat4& a) {
  Mat4 r;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      r(row, column) = a(column, row);
    }
  }
  return r;
}

// From a program's own matrix: 16 numbers, column by column. So lie those of OpenGL, glTF and GLM in memory,
// and those of DirectXMath too, whose rows are for row vectors. Use transposed() for the other order.
constexpr Mat4 mat4FromColumns(std::span<const float, 16> columns) {
  Mat4 r;
  for (std::size_t i = 0; i < 16; ++i) {
    r.m[i] = static_cast<double>(columns[i]);
  }
  return r;
}

// m: affine (last row 0 0 0 1).
SIGHTLINE_INLINE constexpr Vec3d transformPoint(const Mat4& m, const Vec3d& p) {
  return {m(0, 0) * p.x + m(0, 1) * p.y + m(0, 2) * p.z + m(0, 3),
          m(1, 0) * p.x + m(1, 1) * p.y + m(1, 2) * p.z + m(1, 3),
          m(2, 0) * p.x + m(2, 1) * p.y + m(2, 2) * p.z + m(2, 3)};
}
SIGHTLINE_INLINE constexpr Vec3d transformDirection(const Mat4& m, const Vec3d& d) {
  return {m(0, 0) * d.x + m(0, 1) * d.y + m(0, 2) * d.z, m(1, 0) * d.x + m(1, 1) * d.y + m(1, 2) * d.z,
          m(2, 0) * d.x + m(2, 1) * d.y + m(2, 2) * d.z};
}
// Determinant of the upper left 3 x 3 matrix; if negative, the matrix mirrors and reverses the winding of
// triangles.
SIGHTLINE_INLINE constexpr double determinant3(const Mat4& m) {
  return dot(Vec3d(m(0, 0), m(1, 0), m(2, 0)),
             cross(Vec3d(m(0, 1), m(1, 1), m(2, 1)), Vec3d(m(0, 2), m(1, 2), m(2, 2))));
}

}  // namespace sightline
