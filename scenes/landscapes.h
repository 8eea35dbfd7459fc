#pragma once

// Landscapes and places whose large surfaces are connected meshes of thousands of small triangles, none of
// which hides anything alone: hills, the wall of a cave, walls and roofs of several quads, rock towers.

#include <cstdint>

#include "sightline/scene/scene.h"

namespace sightline {

struct TerrainOptions {
  std::uint32_t triangles = 100000;  // about this many in the ground; nothing else depends on it
  std::uint32_t seed = 1;
};
// Rocky mountains of 1.2 km by 1.2 km with cliffs, cut by a winding valley: 256 tiles of one connected sheet.
// Trees with solid crowns, some with see-through leaves; stones; huts in the valley.
// Camera path: "valley" (400 frames at eye height along the valley).
Scene makeTerrain(const TerrainOptions& options);

struct CaveOptions {
  std::uint32_t halls = 24;          // number of halls, joined by tunnels
  std::uint32_t triangles = 100000;  // about this many in the rock; limited by cells of 20 cm
  std::uint32_t seed = 1;
};
// Halls and tunnels. Their walls, floors and ceilings are one closed surface seen from inside, cut into
// objects by cubes of 12 m. Stalagmites, stalactites, boulders, crates, barrels and lamps.
// Camera path: "tunnels" (400 frames through the halls).
Scene makeCave(const CaveOptions& options);

struct VoxelOptions {
  std::uint32_t halls = 24;  // number of halls, joined by tunnels
  std::uint32_t seed = 1;
};
// Halls and tunnels in cubes of 1 m of three kinds of rock. In each chunk of 16 x 16 x 16 cubes the faces of
// a kind are one object, merged to rectangles, so that corners lie in the middle of others' edges
// (T-junctions), at whole coordinates. Crates and lamps stand on the floors. Camera path: "tunnels" (400
// frames through the halls).
Scene makeVoxels(const VoxelOptions& options);

struct VillageOptions {
  std::uint32_t houses = 160;  // at most this many; limited by the places beside the streets
  std::uint32_t seed = 1;
};
// Houses with pitched roofs along winding streets on a gentle hill, a church on the market square, fences,
// carts, trees and household things. Houses stand partly in the ground; each is several objects.
// Camera path: "streets" (400 frames at eye height).
Scene makeVillage(const VillageOptions& options);

struct JungleOptions {
  std::uint32_t buttes = 45;   // rock towers; limited by their places
  std::uint32_t trees = 1500;  // at most this many
  std::uint32_t seed = 1;
};
// Rock towers, each a closed connected mesh, between trees and shrubs of see-through leaves, which also grow
// on the towers, and boulders.
// Camera path: "ground" (400 frames at eye height between the towers).
Scene makeJungle(const JungleOptions& options);

}  // namespace sightline
