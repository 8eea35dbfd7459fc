#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/math/vec3.h"

namespace sightline::layers {

// Returns the numbers of the points that Qhull takes for vertices of their convex hull, ascending: all clear
// vertices and perhaps some points on faces. Empty if Qhull fails. Writes nothing to the program's outputs.
// Source: Barber, Dobkin, Huhdanpaa. The Quickhull algorithm for convex hulls. ACM TOMS 1996.
std::vector<std::uint32_t> qhullCandidates(std::span<const Vec3d> points, const Vec3d& middle);

}  // namespace sightline::layers
