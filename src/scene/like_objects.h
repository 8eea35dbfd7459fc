#pragma once

// Objects that are copies of each other at other places: chairs, windows, trees.

#include <cstdint>
#include <vector>

#include "sightline/base/parallel_for.h"
#include "sightline/scene/scene.h"

namespace sightline::scene {

// By object: the first one in the scene that is as good as a copy of it, or itself. Both have as many
// triangles, and corner for corner their places in their boxes differ by at most kLikeness of the longest
// side. Not all copies are found. The result does not depend on parallel_for.
inline constexpr float kLikeness = 1.0f / 512.0f;
std::vector<std::uint32_t> findLikeObjects(const SceneView& scene, const ParallelFor& parallel_for);

}  // namespace sightline::scene
