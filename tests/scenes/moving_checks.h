#pragma once

// Checks shared by the tests of the scenes with moving parts.

#include <cstdint>
#include <string>
#include <vector>

#include "scenes/moving_scene.h"

namespace sightline::scene_checks {

// The poses of all parts in the frame.
std::vector<Mat4> posesOf(const MovingScene& scene, std::uint32_t frame);

// Uses the inverse of a rigid pose.
Vec3d partFromWorld(const Mat4& world_from_part, const Vec3d& world);

// Returns an empty text if everything is valid: an object, hulls, a class and a name for each part; planes
// between existing parts; poses that are rigid in all frames, reproducible, and constant for static parts;
// and a path with as many frames as the scene. Otherwise returns what is wrong.
std::string whatIsWrongWithParts(const MovingScene& scene);

// Returns an empty text if, in frame 0, each part's mesh lies within the planes of its hull's faces, for
// parts with one hull. Otherwise returns the part, and by how much it sticks out.
std::string whatSticksOut(const MovingScene& scene);

// Returns an empty text if the vertices of all hulls in this frame are within the view. Otherwise returns the
// part.
std::string whatIsOutOfView(const MovingScene& scene, std::uint32_t frame, const View& view);

}  // namespace sightline::scene_checks
