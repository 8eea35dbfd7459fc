#pragma once

// What the tests of the scenes with moving parts ask of any such scene.

#include <string>

#include "scenes/moving_scene.h"

namespace sightline::scene_checks {

// By the inverse of a rigid pose.
Vec3d partFromWorld(const Mat4& world_from_part, const Vec3d& world);

// Empty when everything is in order: an object, hulls, a class and a name for each part, planes between parts
// that there are, poses that are rigid in all frames, the same again, and unchanged for static parts, a path
// of as many frames as the scene has; otherwise what is wrong.
std::string whatIsWrongWithParts(const MovingScene& scene);

// Empty when in frame 0 each part's mesh lies within each of its faces' planes, for parts with one hull;
// otherwise the part, and how far something sticks out.
std::string whatSticksOut(const MovingScene& scene);

// Empty when all hulls' vertices, where they are in this frame, are within the view; otherwise the part.
std::string whatIsOutOfView(const MovingScene& scene, std::uint32_t frame, const View& view);

}  // namespace sightline::scene_checks
