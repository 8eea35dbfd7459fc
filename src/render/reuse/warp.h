#pragma once

// Projective and affine maps from one picture to another, and their fit to pairs of points.
//
// Based on: Lengyel, Snyder. Rendering with Coherent Layers. SIGGRAPH 1997 (affine maps, by least squares of
// characteristic points). Differs from the paper in: a projective map is fitted where an affine one is not
// good enough and there are points enough. Projective maps follow a plane seen at a slant exactly, and so
// they do distant objects while the camera turns. Their division costs little: in the canyon of 14 x 14
// pieces a sixth fewer layers are redrawn.

#include <array>
#include <optional>
#include <span>

namespace sightline::render {

// A place in a picture in pixels, rows from the top: pixel (x, y) has its centre at (x + 0.5, y + 0.5).
struct PicturePoint {
  double x = 0.0, y = 0.0;

  friend bool operator==(const PicturePoint&, const PicturePoint&) = default;
};

// A 3 x 3 matrix applied to columns (x, y, 1), stored by rows. It is affine if the last row is 0 0 1.
struct Warp {
  std::array<double, 9> m{1, 0, 0, 0, 1, 0, 0, 0, 1};

  // The homogeneous coordinate of the image; the map is defined where it is > 0. Linear in x and y.
  double divisor(PicturePoint p) const { return m[6] * p.x + m[7] * p.y + m[8]; }
  PicturePoint operator()(PicturePoint p) const {
    const double w = divisor(p);
    return {(m[0] * p.x + m[1] * p.y + m[2]) / w, (m[3] * p.x + m[4] * p.y + m[5]) / w};
  }
};

Warp operator*(const Warp& after, const Warp& before);

// None if the map is singular or not finite. The inverse's divisor is positive at the image of every point
// where the map's own is.
std::optional<Warp> inverseOf(const Warp& warp);

// The affine map with the smallest sum of squared distances from warp(from[i]) to to[i]. Where the points do
// not determine it (they lie on a line or in one place), the solution nearest to the identity is taken. None
// if there are no points or some are not finite. Precondition: from and to have the same size.
std::optional<Warp> fitAffine(std::span<const PicturePoint> from, std::span<const PicturePoint> to);

// The projective map with the smallest sum of squared distances, by a few rounds of linear least squares.
// None if there are fewer than four points, or if the map found is not finite or has a divisor <= 0 at some
// point.
std::optional<Warp> fitProjective(std::span<const PicturePoint> from, std::span<const PicturePoint> to);

// The largest distance from warp(from[i]) to to[i] in pixels; 0 without points.
double largestDeviation(const Warp& warp, std::span<const PicturePoint> from,
                        std::span<const PicturePoint> to);

// The factor by which the map stretches or shrinks at a point, in the direction where it does so most: the
// largest of its singular values and of their reciprocals, hence at least 1. Infinite where the map is
// singular.
double largestStretch(const Warp& warp, PicturePoint at);

}  // namespace sightline::render
