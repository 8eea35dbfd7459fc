#pragma once

// A view as lines and triangles are taken to it: camera space (x right, y up, z forward, the eye at zero) and
// the screen. On the screen a line stays a line, and what is called reciprocal depth here is linear along it.

#include "sightline/math/vec3.h"
#include "sightline/scene/camera.h"

namespace sightline::drawing {

struct ScreenPoint {
  double x = 0.0, y = 0.0;        // perspective: at unit depth; orthographic: metres
  double reciprocal_depth = 0.0;  // greater is nearer: 1 / depth, or -depth
};

// Whether a view can be drawn on a page of this height: sizes and directions are finite, sizes above zero,
// and both sides of the page between 1e-15 and 1e15 units.
bool isDrawable(const View& view, double page_height);

class LineView {
 public:
  LineView() = default;  // nothing is in it
  LineView(const View& view, double page_height);

  const View& view() const { return view_; }
  bool drawable() const { return drawable_; }

  Vec3d cameraPoint(const Vec3f& position) const;
  ScreenPoint onScreen(const Vec3d& camera) const;  // camera.z > 0 in perspective
  double halfWidth() const { return half_width_; }  // of the screen
  double halfHeight() const { return half_height_; }
  double pageScale() const { return page_scale_; }  // page units a unit of the screen

  // On the page: units, x to the right, y down, clamped to it.
  double pageX(double screen_x) const;
  double pageY(double screen_y) const;

  // The part of the segment from a to b (camera space) within the view's volume; false: nothing.
  bool clip(const Vec3d& a, const Vec3d& b, double& from, double& to) const;

 private:
  View view_;
  bool drawable_ = false;
  double half_width_ = 0.0, half_height_ = 0.0, page_scale_ = 0.0;
};

// Narrows [from, to] to where the linear function with these values at 0 and 1 is not negative; false:
// nowhere, or it is not a number.
bool narrow(double at_0, double at_1, double& from, double& to);

}  // namespace sightline::drawing
