#pragma once

// Where a camera will be: views for a WorldCuller that says what to fetch before it is seen.

#include <span>

#include "sightline/scene/camera.h"

namespace sightline {

struct CameraMotion {
  Vec3d velocity{};        // metres a second, world space
  Vec3d turn_rad_per_s{};  // about this axis, counter-clockwise as seen from its tip
  double spread = 0.0;     // metres a second by which the velocity may be another one
  // Distance, metres, of what should stay in view although the velocity is off by `spread`. 0 or less: the
  // geometric mean of the view's near and far planes, where a near plane within 1 cm counts as at 1 cm; 10 m
  // if the far one is infinite. Has no effect on orthographic views.
  double depth = 0.0;
};

// Sets the views to those that the camera will have within `seconds`, evenly spaced, the last one at their
// end. Each is wide enough for what the camera turns until the next one, and for `seconds` of `spread` at
// `depth`; more than about 75 degrees to a side are not taken in.
//
//   std::array<View, 3> views;
//   viewsAhead(view, {.velocity = velocity, .turn_rad_per_s = turn}, 0.5, views);
//   ahead.cull(world, views);  // a WorldCuller of its own
//   // what is in ahead.visible() and not in culler.visible() is what to fetch next
//
// A forecast, not a promise: between two of the positions something may be seen for a moment that none of
// them sees. What appears in the frame itself is always in WorldCuller::visible().
void viewsAhead(const View& view, const CameraMotion& motion, double seconds, std::span<View> views);

}  // namespace sightline
