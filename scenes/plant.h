#pragma once

#include "scenes/mesh_builder.h"
#include "scenes/random.h"

namespace sightline::scenes {

inline constexpr std::uint32_t kPlantTriangles = 644;
// Maximum distance of any point of a plant from its axis, metres.
inline constexpr double kPlantRadius = 0.42;

// Adds a potted plant at the current placement: pot, stems and leaves, kPlantTriangles in all. Leaves are
// single sheets, so the object's material should be double-sided.
void addPlant(MeshBuilder& mesh, const Placement& placement, Random random);

}  // namespace sightline::scenes
