#pragma once

// Maps of a picture to another one that take lines to lines, and the best of them for some points.
//
// Based on: Lengyel, Snyder. Rendering with Coherent Layers. SIGGRAPH 1997 (affine maps, by least squares of
// characteristic points). Differs from the paper in: projective maps too, where an affine one is not good
// enough and there are points enough. They follow a plane that is seen at a slant, and whatever is far away
// when the camera turns, exactly, and their division costs little: in the canyon of 14 x 14 pieces a sixth
// fewer layers are drawn anew.

#include <array>
#include <optional>
#include <span>

namespace sightline::render {

// Of a picture, pixels, rows from the top: pixel (x, y) has its centre at (x + 0.5, y + 0.5).
struct PicturePoint {
  double x = 0.0, y = 0.0;

  friend bool operator==(const PicturePoint&, const PicturePoint&) = default;
};

// 3 x 3 matrix for columns (x, y, 1), stored by rows. Affine where the last row is 0 0 1.
struct Warp {
  std::array<double, 9> m{1, 0, 0, 0, 1, 0, 0, 0, 1};

  // > 0 where the map means anything; linear in x and y.
  double divisor(PicturePoint p) const { return m[6] * p.x + m[7] * p.y + m[8]; }
  PicturePoint operator()(PicturePoint p) const {
    const double w = divisor(p);
    return {(m[0] * p.x + m[1] * p.y + m[2]) / w, (m[3] * p.x + m[4] * p.y + m[5]) / w};
  }
};

Warp operator*(const Warp& after, const Warp& before);

// None: singular, or not finite. Divisors of the one are positive where those of the other are.
std::optional<Warp> inverseOf(const Warp& warp);

// The affine map with the least sum of squared distances from warp(from[i]) to to[i]. Where the points do not
// say (on a line, or all in one place), the map that changes least across it. As many of the one as of the
// other. None: no points, or some not finite.
std::optional<Warp> fitAffine(std::span<const PicturePoint> from, std::span<const PicturePoint> to);

// The same of projective maps, by a few rounds of linear least squares. None: fewer than four points, or none
// found that is finite and has divisors > 0 at all points.
std::optional<Warp> fitProjective(std::span<const PicturePoint> from, std::span<const PicturePoint> to);

// The largest distance from warp(from[i]) to to[i], pixels; 0 without points.
double largestDeviation(const Warp& warp, std::span<const PicturePoint> from,
                        std::span<const PicturePoint> to);

// By how much the map stretches or shrinks at most, in any direction, at a point: the largest of its singular
// values and of their reciprocals, so at least 1. Infinite where it is singular.
double largestStretch(const Warp& warp, PicturePoint at);

}  // namespace sightline::render
