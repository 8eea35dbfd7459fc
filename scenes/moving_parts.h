#pragma once

// Assembles moving scenes part by part.

#include <cstdint>
#include <functional>
#include <string>

#include "scenes/mesh_builder.h"
#include "scenes/moving_scene.h"

namespace sightline::scenes {

// Builds a part's mesh with `build`, as one object in the part's own space (Y up; the builder's is plan
// space).
Scene buildPartMesh(const std::function<void(MeshBuilder&)>& build);

// The convex hull of the mesh's vertices, each moved away from the centre of their box by this fraction of
// its distance from it. The mesh must be finite and not empty.
ConvexHull hullOf(const Scene& mesh, double growth = 0.0);

// Appends the part, with its hulls and class set, and its object as it is in frame 0.
void addMovingPart(MovingScene& scene, MovingPart part, const Scene& mesh, const Mat4& world_from_part,
                   MaterialId material);

// The matrix with columns x, y, z and the origin.
Mat4 rigid(const Vec3d& x, const Vec3d& y, const Vec3d& z, const Vec3d& origin);

}  // namespace sightline::scenes
