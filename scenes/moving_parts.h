#pragma once

// How the moving scenes are put together, part by part.

#include <cstdint>
#include <functional>
#include <string>

#include "scenes/mesh_builder.h"
#include "scenes/moving_scene.h"

namespace sightline::scenes {

// What `build` makes, in one object: a part's mesh, in the part's own space (Y up; the builder's is plan
// space).
Scene buildPartMesh(const std::function<void(MeshBuilder&)>& build);

// Of the mesh's vertices, moved away from the middle of their box by this part of their distance from it. The
// mesh is finite and not empty.
ConvexHull hullOf(const Scene& mesh, double growth = 0.0);

// Appends the part, which brings its hulls and its class, with the object that it is in frame 0.
void addMovingPart(MovingScene& scene, MovingPart part, const Scene& mesh, const Mat4& world_from_part,
                   MaterialId material);

// Columns x, y, z and then the origin.
Mat4 rigid(const Vec3d& x, const Vec3d& y, const Vec3d& z, const Vec3d& origin);

}  // namespace sightline::scenes
