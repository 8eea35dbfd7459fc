#pragma once

// The image of a view in homogeneous coordinates, both rounded and exact.
//
// A point of the image is a direction d, a vector of three coordinates whose length is of no meaning. In a
// perspective view, d is the vector from the eye to a point in space. In an orthographic view, d consists of
// the two coordinates that remain when space is projected along the lines of sight, and of a constant. In
// both, a straight line of the image is a plane n . d = 0, and the image of a triangle is the cone of its
// corners' directions, also where some of them lie behind the eye.
//
// Whatever is nearer has a greater *nearness*: in a perspective view the reciprocal of the distance in
// lengths of d, in an orthographic view minus the depth. In both, the nearness of a plane is linear in d.

#include <cmath>
#include <cstdint>
#include <span>

#include "oracle/exact_number.h"
#include "oracle/view_rays.h"
#include "sightline/scene/scene.h"

namespace sightline {

inline constexpr double kRounding = 0x1p-53;  // the largest relative error of one operation

inline double maxNorm(const Vec3d& v) {
  return maxComponent(abs(v));
}

// A vector with a bound on the error of each coordinate.
struct RoundedVec {
  Vec3d value{};
  double error = 0.0;
};

// A part of the image: tangents of the angle from the forward axis, or metres.
struct ImageRectangle {
  double x_min = 0.0, x_max = 0.0, y_min = 0.0, y_max = 0.0;
};

class ImageSpace {
 public:
  // `lowest_exponent` is that of all finite positions. The memory of both lists must outlive this object.
  // `more`: positions whose numbers follow those of `positions`; their coordinates may change between uses.
  ImageSpace(const View& view, std::span<const Vec3f> positions, int lowest_exponent,
             std::span<const Vec3f> more = {});

  const View& view() const { return view_; }
  Vec3d position(std::uint32_t number) const {
    return Vec3d(number < positions_.size() ? positions_[number] : more_[number - positions_.size()]);
  }

  // The direction of a position with finite coordinates.
  RoundedVec direction(std::uint32_t position) const;
  WholeVec exactDirection(std::uint32_t position) const;
  // The difference of the directions of two positions.
  RoundedVec difference(std::uint32_t from, std::uint32_t to) const;

  // What the nearness of a plane is interpolated from: 1 in a perspective view, minus the depth in an
  // orthographic one.
  double weight(std::uint32_t position) const;
  double weightError(std::uint32_t position) const;
  Whole exactWeight(std::uint32_t position) const;
  // Nearness of all points at one depth, as n . d / c: a whole multiple of (n, c).
  struct ExactNearness {
    WholeVec n;
    Whole c;
  };
  ExactNearness exactNearnessAt(double depth) const;

  // A direction is at (right . d / forward . d, up . d / forward . d) of the picture, in tangents of the
  // angle or in metres; forward . d > 0 for everything before the eye.
  const Vec3d& right() const { return right_; }
  const Vec3d& up() const { return up_; }
  const Vec3d& forward() const { return forward_; }
  double halfHeight() const { return view_.orthographic ? 0.5 * view_.ortho_height : view_.tan_half_fovy; }
  double halfWidth() const { return halfHeight() * view_.aspect; }
  // What of the image the picture shows, in these coordinates.
  ImageRectangle picture() const {
    const double x = halfWidth(), y = halfHeight();
    return {x * (view_.shift_x - 1.0), x * (view_.shift_x + 1.0), y * (view_.shift_y - 1.0),
            y * (view_.shift_y + 1.0)};
  }

  // The line of sight in a direction before the eye, from the plane through the eye on. It follows from the
  // eye and, in an orthographic view, scene::sightDirection() alone, as the exact direction does: axes may be
  // off by single-precision rounding.
  ViewRay lineOfSight(const Vec3d& direction) const;
  // How far its origin may be off, metres, besides the rounding of its own coordinates: in an orthographic
  // view a direction is rounded to a part of the picture's size, however near the scene lies to the eye.
  double originSlack() const { return view_.orthographic ? 0x1p-36 * std::abs(last_) : 0.0; }
  // About the same line from the near plane, by the view's axes.
  ViewRay ray(const Vec3d& direction) const;
  // The direction of a point in space given in double precision: rounded in an orthographic view.
  Vec3d directionOf(const Vec3d& point) const;
  WholeVec exactDirectionOf(const Vec3d& point) const;

 private:
  Vec3d fromEye(std::uint32_t position) const;
  Vec3d project(const Vec3d& from_eye, double last) const;
  WholeVec exactProject(const WholeVec& from_eye, int exponent) const;

  View view_;
  std::span<const Vec3f> positions_, more_;
  int exponent_ = 0;  // of exact coordinates in space
  // The coordinates of exact_forward_ and exact_sight_ are whole multiples of 2 to the power of this.
  int direction_exponent_ = 0;
  WholeVec exact_eye_, exact_forward_;
  // Orthographic: the direction of the lines of sight, and the axis that it is nearest to. Depths are
  // measured along the view's forward, which is another direction where the axes are not quite perpendicular.
  Vec3d sight_{};
  WholeVec exact_sight_;
  int axis_ = 2;
  // Orthographic: the last coordinate of every direction. A power of two about as large as the picture,
  // beside which no coordinate of a direction is lost.
  double last_ = 1.0;
  Vec3d right_{}, up_{}, forward_{};
};

}  // namespace sightline
