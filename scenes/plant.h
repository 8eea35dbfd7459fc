#pragma once

#include "scenes/mesh_builder.h"
#include "scenes/random.h"

namespace sightline::scenes {

inline constexpr std::uint32_t kPlantTriangles = 644;
inline constexpr double kPlantRadius = 0.42;  // nothing of a plant is farther from its axis, metres

// A potted plant at the current placement: pot, stems and leaves, kPlantTriangles in all. Leaves are single
// sheets: the object's material is to be double-sided.
void addPlant(MeshBuilder& mesh, const Placement& placement, Random random);

}  // namespace sightline::scenes
