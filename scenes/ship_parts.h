#pragma once

// The plan of the ship, shared by the files that construct it, furnish it and lead the camera through it.
//
// x runs from the stern to the bow, y to port, z up from the keel. The block contains cabins and work rooms:
// decks of rooms along a corridor, two of them inside the hull, the others above the main deck. The engine
// room is below it, three storeys high; a stairwell connects them all. The holds are in front of the block.
// Dimensions of the block are multiples of 1/16 m, so that walls and slabs join exactly. Every object is a
// closed solid.

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "scenes/mesh_builder.h"
#include "scenes/placement.h"
#include "scenes/procedural.h"
#include "scenes/random.h"
#include "scenes/round_solids.h"

namespace sightline::scenes::ship {

inline constexpr double kHullLength = 180.0, kHalfBeam = 15.0, kShell = 0.3;
inline constexpr double kTankTop = 2.0, kMainDeck = 18.25, kBulwarkTop = 19.0;
inline constexpr double kStorey = 3.25, kSlab = 0.25;
inline constexpr double kBlockStart = 10.0, kBlockHalf = 7.5;  // between the faces of the outer walls
inline constexpr double kOuterWall = 0.25, kInnerWall = 0.125;
inline constexpr double kCorridorHalf = 1.0, kRoomStart = kCorridorHalf + kInnerWall;
inline constexpr double kBay = 4.0, kStairBay = 5.0;
inline constexpr double kDoorWidth = 0.9375, kDoorHeight = 2.125, kDoorMiddle = 1.0;  // x in the room
inline constexpr double kStairFoot = 2.5, kStairLanding = 5.1875;                     // y
inline constexpr double kStairUp = 1.25, kStairOn = 3.75;  // x of the flights' centre lines in their bay
inline constexpr double kHoldsEnd = 152.0;
inline constexpr std::uint32_t kEngineStoreys = 3, kMainDeckNumber = 2, kHolds = 5;
inline constexpr double kEyeHeight = 1.7;

enum class Paint : std::uint32_t {
  kHull,
  kDeck,
  kFloor,
  kWall,
  kBulkhead,
  kDoor,
  kFrame,
  kStairs,
  kRail,
  kTank,
  kPipe,
  kRedPipe,
  kEngine,
  kMachine,
  kConsole,
  kScreen,
  kWood,
  kFabric,
  kWhite,
  kMetal,
  kLight,
  kCrate,
  kCount,
};
std::vector<Material> materials();
inline MaterialId id(Paint paint) {
  return MaterialId{static_cast<std::uint32_t>(paint)};
}

// Half the breadth of the hull at the outside of the shell, above the bilge.
double halfBreadth(double x, double z);
// Half the breadth of the hull at the middle of the shell's thickness, including the bilge.
double halfBreadthInShell(double x, double z);

struct Plan {
  std::uint32_t decks = 6, rooms = 7;

  std::uint32_t bays() const { return rooms + 1; }
  std::uint32_t stairBay() const { return rooms / 2; }
  double bayStart(std::uint32_t bay) const {
    return kBlockStart + bay * kBay + (bay > stairBay() ? kStairBay - kBay : 0.0);
  }
  double blockEnd() const { return bayStart(bays()); }
  double holdStart(std::uint32_t hold) const {
    const double first = blockEnd() + 2 * kOuterWall;
    return first + (kHoldsEnd - first) * hold / kHolds;
  }
};
inline constexpr double deckHeight(std::uint32_t deck) {
  return kTankTop + (kEngineStoreys + deck) * kStorey;
}

// A room in coordinates of its door: x along the corridor, y from the corridor's wall to the outer one, z = 0
// on the floor.
struct Room {
  std::uint32_t deck = 0, bay = 0;
  bool port = false;
  Placement placement;
  double width = 0.0, depth = 0.0;  // between the faces of the walls
  std::string name;
};
Room roomAt(const Plan& plan, std::uint32_t deck, std::uint32_t bay, bool port);
// Rooms that the camera path enters: one to port, one to starboard.
std::array<Room, 2> roomsOnWalk(const Plan& plan);
bool isOnWalk(const Plan& plan, const Room& room);

// A convex solid with six faces, in the placement of the mesh. Bits of the corner index: bit 0 for east, bit
// 1 for north, bit 2 for top.
void addHexahedron(MeshBuilder& mesh, const std::array<Vec3d, 8>& corners);

// A wall from (0, 0, 0) of `at` along its x axis, with its thickness along y. Each convex piece is an object,
// named `name` and a number. Openings must not overlap in x and are in ascending order of x; their y is the
// height.
struct Wall {
  std::string name;
  Placement at;
  double length = 0.0, thickness = 0.0, height = 0.0;
  std::vector<Rectangle> openings;
  Paint paint = Paint::kWall;
};
void addWall(MeshBuilder& mesh, const Wall& wall);

void addHull(MeshBuilder& mesh, const Plan& plan);
void addDecks(MeshBuilder& mesh, const Plan& plan, std::uint32_t seed);
void addStairs(MeshBuilder& mesh, const Plan& plan);
void furnish(MeshBuilder& mesh, const Plan& plan, const Room& room, Random random);
void addHolds(MeshBuilder& mesh, const Plan& plan, Random random);
void addDeckGear(MeshBuilder& mesh, const Plan& plan, Random random);
// Adds the main engine and this many machines around it; limited by the number of places.
void addMachinery(MeshBuilder& mesh, const Plan& plan, std::uint32_t machines, std::uint32_t seed);
CameraPath walk(const Plan& plan);
// Requires the bounds of the finished scene's objects.
CameraPath randomViews(const Plan& plan, const Scene& scene, Random random);

}  // namespace sightline::scenes::ship
