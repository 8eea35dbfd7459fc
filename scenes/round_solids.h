#pragma once

// Tubes, cylinders and spheres.

#include <cstdint>
#include <span>
#include <vector>

#include "scenes/mesh_builder.h"

namespace sightline::scenes {

// A round tube along straight legs with mitred corners, closed at both ends, in the placement of the mesh.
// Needs at least two corners.
void addTube(MeshBuilder& mesh, std::span<const Vec3d> corners, double radius, std::uint32_t segments = 12);
// A cylinder from `foot`, `length` metres along axis `axis` (0: x, 1: y, 2: z) of `at`. Sets the placement of
// the mesh.
void addCylinder(MeshBuilder& mesh, const Placement& at, const Vec3d& foot, std::uint32_t axis, double radius,
                 double length, std::uint32_t segments = 12);
// `at` moved to `foot` and turned so that its z axis runs along axis `axis` of `at`.
Placement standingAlong(const Placement& at, const Vec3d& foot, std::uint32_t axis);
// A half circle of `legs` segments from (0, -radius) up to (0, radius), moved up by z: the profile of a
// sphere.
std::vector<Point2> halfCircle(double radius, double z, std::uint32_t legs);

}  // namespace sightline::scenes
