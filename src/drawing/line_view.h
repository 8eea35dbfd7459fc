#pragma once

// Transforms points to camera space (x right, y up, z forward, the eye at zero), to the screen and to the
// page. On the screen lines stay lines, and reciprocal depth is linear along them.

#include "sightline/math/vec3.h"
#include "sightline/scene/camera.h"

namespace sightline::drawing {

struct ScreenPoint {
  double x = 0.0, y = 0.0;        // perspective: at unit depth; orthographic: metres
  double reciprocal_depth = 0.0;  // greater is nearer: 1 / depth, or -depth
};

// Whether a view can be drawn on a page of this height: sizes and directions are finite and not zero, and
// both sides of the page are between 1e-15 and 1e15 units.
bool isDrawable(const View& view, double page_height);

class LineView {
 public:
  LineView() = default;  // a view that is not drawable and shows nothing
  LineView(const View& view, double page_height);

  // Its axes have unit length, and z_near > 0 in perspective.
  const View& view() const { return view_; }
  bool drawable() const { return drawable_; }

  Vec3d cameraPoint(const Vec3f& position) const;
  ScreenPoint onScreen(const Vec3d& camera) const;  // camera.z > 0 in perspective
  // What the page shows of the screen.
  double left() const { return left_; }
  double right() const { return right_; }
  double bottom() const { return bottom_; }
  double top() const { return top_; }
  double pageScale() const { return page_scale_; }  // page units for each unit of the screen

  // From the screen to the page: units, x to the right, y down, clamped to the page.
  double pageX(double screen_x) const;
  double pageY(double screen_y) const;

  // Clips the segment from a to b (camera space) by the view's volume to the shares [from, to]. False if
  // nothing is left.
  bool clip(const Vec3d& a, const Vec3d& b, double& from, double& to) const;

 private:
  View view_;
  bool drawable_ = false;
  double left_ = 0.0, right_ = 0.0, bottom_ = 0.0, top_ = 0.0;  // on the screen
  double page_scale_ = 0.0;
};

// Narrows [from, to] to where the linear function with these values at 0 and 1 is >= 0. False if that is
// nowhere, or if a value is NaN.
bool narrow(double at_0, double at_1, double& from, double& to);

}  // namespace sightline::drawing
