#pragma once

// Walks: a route through a scene turned into the frames of a camera path.

#include <span>
#include <string>
#include <vector>

#include "scenes/placement.h"
#include "sightline/scene/camera.h"

namespace sightline::scenes {

// A dense line along straight legs between the corners, each corner rounded within `radius` of it. Plan
// space.
std::vector<Vec3d> roundedRoute(std::span<const Vec3d> corners, double radius);

struct WalkOptions {
  std::string name;
  std::uint32_t frames = 400;
  double look_ahead = 2.5;  // metres: the camera looks at the point of the route that lies this far ahead
  double glance = 0.0;      // how far the look swings to both sides, as the tangent of the angle
  double glance_turns = 3;  // how often it does so on the whole walk
  std::uint32_t calm = 0;   // frames before and after over whose looks each look is averaged, twice
  double max_turn = 0.5;    // of the look from frame to frame, as part of a full turn
  double tilt = 0.0;        // tangent of the look's angle above the route
  double far = 2000.0;
};
// Frames evenly spaced along the line, looking along it. The line has at least two different points.
CameraPath walkAlong(std::span<const Vec3d> line, const WalkOptions& options);

}  // namespace sightline::scenes
