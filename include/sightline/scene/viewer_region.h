#pragma once

#include <array>

#include "sightline/math/vec3.h"

namespace sightline {

// Viewers for whom a depth buffer that is drawn once, from the eye of one view, holds: all of those within
// `radius` of the triangle whose corners are that eye and two other points. Made without arguments it is the
// eye of that view alone.
struct ViewerRegion {
  std::array<Vec3d, 2> offsets{};  // of the two other corners, from the eye; scene space, metres
  double radius = 0.0;             // metres
  // What is no farther than this from one of the viewers hides nothing, since their near planes may clip it;
  // metres. nearDistance() of a view says how far its own near plane reaches.
  double near_distance = 0.0;

  // Whether it is anything but the view that the buffer is drawn for.
  bool several() const {
    return radius > 0.0 || near_distance > 0.0 || offsets[0] != Vec3d() || offsets[1] != Vec3d();
  }
};

}  // namespace sightline
