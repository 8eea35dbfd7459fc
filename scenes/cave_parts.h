#pragma once

// The pieces of the cave: the plan of its halls and tunnels, the free space in the rock, and the things that
// stand and hang in it. Plan space.

#include <cstdint>
#include <vector>

#include "scenes/mesh_builder.h"
#include "scenes/random.h"
#include "scenes/surface_nets.h"

namespace sightline::scenes::cave {

inline constexpr double kEyeHeight = 1.6;  // of all lines above the floor, metres

// Indices into Scene::materials.
enum Surface : std::uint32_t {
  kLimestone,
  kDarkLimestone,
  kDripstone,
  kBoulder,
  kCrate,
  kBarrel,
  kIron,
  kFlame
};

struct Hall {
  Vec3d eye;  // at eye height above the middle of its floor
  Vec3d radii;
};
struct Tunnel {
  std::vector<Vec3d> corners;  // of its line at eye height, from hall to hall
  double radius = 2.5;
};
struct Plan {
  std::vector<Hall> halls;
  std::vector<Tunnel> tunnels;  // tunnel i leads from hall i to hall i + 1; further ones follow
};
Plan makePlan(std::uint32_t halls, Random random);

// The line of the walk through at most 12 halls, at eye height.
std::vector<Vec3d> walkLine(const Plan& plan);

// The cave as depth in the rock, metres: negative in the free space, which is in one piece. The surface has
// about this many triangles.
ValueGrid hollow(const Plan& plan, std::uint32_t triangles, std::uint64_t seed);

// The same for cubes of 1 m whose corners have whole coordinates: a point of the grid is the middle of a
// cube.
ValueGrid hollowCubes(const Plan& plan, std::uint64_t seed);

// The surface, an object for each cube of 12 m.
void addRock(MeshBuilder& mesh, const ValueGrid& grid);
// Dripstone, boulders, crates, barrels and lamps, off the walk.
void addThings(MeshBuilder& mesh, const Plan& plan, const ValueGrid& grid, std::uint64_t seed);

}  // namespace sightline::scenes::cave
