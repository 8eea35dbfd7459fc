#pragma once

// Trees, shrubs and stones. Everything but foliage is a closed solid.

#include <cstdint>
#include <string>

#include "scenes/mesh_builder.h"
#include "scenes/random.h"

namespace sightline::scenes {

// A solid like a potato: a sphere of 20 * 4^level triangles, scaled to the radii, each vertex moved in or
// out by up to about `rough` of its distance from the middle. One object may hold several.
void addBlob(MeshBuilder& mesh, const Vec3d& middle, const Vec3d& radii, double rough, std::uint32_t level,
             std::uint64_t seed);

// `count` square leaves of these sides, of any direction, spread over the surface of an ellipsoid.
void addLeaves(MeshBuilder& mesh, const Vec3d& middle, const Vec3d& radii, std::uint32_t count, double side,
               Random& random);

enum class TreeKind : std::uint8_t {
  kConifer,    // crown: a solid of tiers
  kBroadleaf,  // crown: solid blobs
  kLeafy,      // crown: see-through leaves
};
struct TreeSurfaces {
  MaterialId bark{}, needles{}, crown{}, leaves{};
};
// Two objects, trunk and crown, on the placement's ground; the trunk begins below it.
void addTree(MeshBuilder& mesh, const Placement& foot, TreeKind kind, double height,
             const TreeSurfaces& surfaces, Random& random, const std::string& name);
// Radius of the crown of a tree, and height of its lowest point, for a tree of this height.
double crownRadius(TreeKind kind, double height);
double crownBase(TreeKind kind, double height);

// A stone of about this radius, partly in the ground: one object.
void addStone(MeshBuilder& mesh, const Placement& foot, double radius, MaterialId material, Random& random,
              const std::string& name);

}  // namespace sightline::scenes
