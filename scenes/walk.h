#pragma once

// Turns a route through a scene into the frames of a camera path.

#include <span>
#include <string>
#include <vector>

#include "scenes/placement.h"
#include "sightline/scene/camera.h"

namespace sightline::scenes {

// A dense polyline along straight legs between the corners, with each corner rounded within `radius` metres
// of it. Plan space.
std::vector<Vec3d> roundedRoute(std::span<const Vec3d> corners, double radius);

struct WalkOptions {
  std::string name;
  std::uint32_t frames = 400;
  double look_ahead = 2.5;  // metres; the camera looks at the point of the route this far ahead
  double glance = 0.0;      // how far the view swings to both sides, as the tangent of the angle
  double glance_turns = 3;  // number of such swings along the whole path
  std::uint32_t calm = 0;   // number of frames before and after over which each direction is averaged, twice
  double max_turn = 0.5;    // maximum turn from frame to frame, as a fraction of a full turn
  double tilt = 0.0;        // tangent of the view's angle above the route
  double far = 2000.0;
};
// Frames evenly spaced along the line, looking along it. The line must have at least two different points.
CameraPath walkAlong(std::span<const Vec3d> line, const WalkOptions& options);

}  // namespace sightline::scenes
