#pragma once

// The plan of the building, shared by the files that construct it, furnish it and lead the camera through it.
//
// A floor has four rows of rooms along two corridors, joined by a hall across them; one bay of the first row
// is the stairwell. All structural dimensions are multiples of 1/16 m, so that walls, pillars and slabs join
// exactly.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "scenes/mesh_builder.h"
#include "scenes/placement.h"
#include "scenes/random.h"

namespace sightline::scenes {

inline constexpr double kWallThickness = 0.25, kHalfWall = 0.125;
inline constexpr double kStorey = 3.25, kSlab = 0.25;
inline constexpr double kDoorWidth = 1.0, kDoorHeight = 2.125;
inline constexpr std::uint32_t kBays = 8, kRows = 6;
inline constexpr std::uint32_t kHallBay = 4, kStairBay = 6;
inline constexpr std::uint32_t kCorridorA = 1, kCorridorB = 4;  // rows

enum class BuildingMaterial : std::uint32_t {
  kGround,
  kPlaster,
  kFacade,
  kPillar,
  kFloor,
  kCorridorFloor,
  kRoof,
  kStairs,
  kRail,
  kFrame,
  kLeaf,
  kGlass,
  kWood,
  kDarkWood,
  kWhite,
  kMetal,
  kFabric,
  kBooks,
  kScreen,
  kCeramic,
  kLight,
  kPlant,
  kCount,
};
std::vector<Material> buildingMaterials();
inline MaterialId id(BuildingMaterial material) {
  return MaterialId{static_cast<std::uint32_t>(material)};
}

inline constexpr double floorHeight(std::uint32_t floor) {
  return floor * kStorey;
}
inline constexpr double ceilingHeight(std::uint32_t floor) {
  return floorHeight(floor + 1) - kSlab;
}

enum class SpaceKind : std::uint8_t { kRoom, kCorridor, kStairs };

struct BuildingPlan {
  std::uint32_t floors = 1;
  std::array<double, kBays + 1> xs{};  // centre lines of the walls between bays
  std::array<double, kRows + 1> ys{};  // ... and between rows
  bool shut_doors = false;             // BuildingOptions::shut_doors

  Rectangle cell(std::uint32_t bay, std::uint32_t row) const {
    return {{xs[bay], ys[row]}, {xs[bay + 1], ys[row + 1]}};
  }
};
BuildingPlan planBuilding(std::uint32_t floors, std::uint32_t seed);
SpaceKind spaceAt(std::uint32_t bay, std::uint32_t row);
inline bool isRoom(std::uint32_t bay, std::uint32_t row) {
  return spaceAt(bay, row) == SpaceKind::kRoom;
}

// A room in coordinates of its door: x along the door's wall, y into the room, z = 0 on the floor.
struct Room {
  std::uint32_t floor = 0, bay = 0, row = 0;
  Placement placement;
  double width = 0.0, depth = 0.0;  // between the faces of the walls
  double door = 0.0;                // x of the door's centre
  bool north = false;               // the room is north of its corridor
  bool has_window = false;          // in the wall opposite the door
  bool on_walk = false;             // the camera path enters the room
  std::string name;

  // x of the place from which the camera path may go round the room.
  double loopStart() const { return 1.0; }
  double loopReach() const { return 0.7; }
};
Room roomAt(const BuildingPlan& plan, std::uint32_t floor, std::uint32_t bay, std::uint32_t row);
// x of a room's door in the plan.
double doorOf(const BuildingPlan& plan, std::uint32_t bay, std::uint32_t row);

// A room that the camera path visits, in this order on each floor.
struct Visit {
  std::uint32_t floor, bay, row;
};
const std::vector<Visit>& visits();

void addStructure(MeshBuilder& mesh, const BuildingPlan& plan, Random random);
void addStairs(MeshBuilder& mesh, const BuildingPlan& plan);
// Furnishes the room. Returns the rectangle in which a plant may stand on its floor, possibly empty.
Rectangle furnish(MeshBuilder& mesh, const Room& room, Random random);
CameraPath buildingWalk(const BuildingPlan& plan);

}  // namespace sightline::scenes
