#pragma once

// The pieces of the village: its streets and its houses and things. Plan space.

#include <cstdint>
#include <string>
#include <vector>

#include "scenes/free_ground.h"
#include "scenes/height_field.h"
#include "scenes/random.h"

namespace sightline::scenes::village {

inline constexpr double kStreetHalf = 3.0;  // from the middle of a street to its edge, metres

// Indices into Scene::materials.
enum Surface : std::uint32_t {
  kGrass,
  kEarth,
  kPlaster,
  kOchre,
  kTimber,
  kBrick,
  kTiles,
  kThatch,
  kSlate,
  kStone,
  kWood,
  kWindow,
  kIron,
  kLight,
  kHay,
  kBark,
  kNeedles,
  kCrown,
  kLeaves
};

// Middle lines of the streets; the first two meet in the market square, at the origin.
const std::vector<std::vector<Vec3d>>& streets();

struct HousePlace {
  Footprint footprint;  // of the walls; its second side looks away from the street
  bool near_market = false;
};
// Places along all streets, at most this many; takes them.
std::vector<HousePlace> planHouses(FreeGround& free, std::uint32_t count, Random& random);
void addHouse(MeshBuilder& mesh, const HeightField& ground, const HousePlace& place, Random& random,
              const std::string& name);
// Takes its place beside the market square.
void addChurch(MeshBuilder& mesh, const HeightField& ground, FreeGround& free, Random& random);

// The fence around the garden behind a house, and things in the garden and at the walls, where there is room.
void addGarden(MeshBuilder& mesh, const HeightField& ground, FreeGround& free, const HousePlace& place,
               Random& random, const std::string& name);
enum class Prop : std::uint8_t { kCart, kBarrel, kCrate, kHaystack, kWoodpile, kBench, kWell, kLamp, kCount };
// Adds the thing if there is room around the place.
void addProp(MeshBuilder& mesh, const HeightField& ground, FreeGround& free, Prop prop, Point2 at,
             Random& random, const std::string& name);

}  // namespace sightline::scenes::village
