#pragma once

// What a city's quarter is planned from, shared by the files that plan it, build it and walk through it.

#include <cstdint>
#include <string>
#include <vector>

#include "scenes/mesh_builder.h"
#include "scenes/placement.h"
#include "scenes/random.h"

namespace sightline::scenes {

// One copy is a square quarter. Streets run along its borders (half of each is the neighbour's), lanes cross
// in its middle; the four blocks between them are raised by a kerb.
inline constexpr double kQuarter = 96.0;    // metres, side of a quarter
inline constexpr double kRoadHalf = 5.5;    // from the middle of a street to the kerb
inline constexpr double kBlockStart = 9.0;  // from the middle of a street to the house fronts
inline constexpr double kBlock = 35.0;      // side of a block
inline constexpr double kLaneStart = kBlockStart + kBlock;
inline constexpr double kLaneEnd = kQuarter - kLaneStart;
inline constexpr double kLanePavement = 2.0;
inline constexpr double kKerb = 0.15;
inline constexpr std::uint32_t kQuarterTriangles = 10000;

enum class CityMaterial : std::uint32_t {
  kAsphalt,
  kPavement,
  kMarking,
  kGrass,
  kSand,
  kBrick,
  kStucco,
  kSandstone,
  kConcrete,
  kOchre,
  kSlateBlue,
  kTiles,
  kSlate,
  kGravel,
  kTrim,
  kDarkTrim,
  kWindow,
  kGlass,
  kDoor,
  kMetal,
  kWood,
  kStone,
  kBark,
  kCrown,
  kLightCrown,
  kRed,
  kBlue,
  kWhite,
  kGreen,
  kRubber,
  kLamp,
  kCount,
};
std::vector<Material> cityMaterials();
inline MaterialId id(CityMaterial material) {
  return MaterialId{static_cast<std::uint32_t>(material)};
}

// A stretch of wall that has windows, outside on the right of a -> b.
struct Front {
  Point2 a, b;
};

enum class RoofShape : std::uint8_t { kNone, kFlat, kGable, kHip };
enum class WindowStyle : std::uint8_t { kPlain, kSill, kFramed, kRibbon };

// An upright body of a building: one shell with storeys of windows on its fronts.
struct Mass {
  std::vector<Point2> footprint;  // anticlockwise
  double base = 0.0;              // metres above the pavement
  std::uint32_t storeys = 1;
  double storey_height = 3.1;
  RoofShape roof = RoofShape::kFlat;
  std::vector<Front> fronts;
  bool has_door = false;  // in the middle of the first front

  double top() const { return base + storeys * storey_height; }
};

// A wall with openings, standing by itself: in front of a recessed ground floor, or around the decks of a
// garage.
struct Arcade {
  Point2 a, b;
  double height = 4.0;         // of one row of openings
  std::uint32_t openings = 1;  // in a row
  std::uint32_t rows = 1;
  double parapet = 0.0;  // metres from each row's foot to its openings
};

struct CityBuilding {
  Placement placement;
  std::vector<Mass> masses;
  std::vector<Arcade> arcades;
  WindowStyle style = WindowStyle::kPlain;
  CityMaterial wall = CityMaterial::kBrick;
  CityMaterial roof = CityMaterial::kGravel;
  bool clear_glass = false;  // blended panes instead of dark ones
};

// Every edge of the footprint that is not left out, as fronts.
std::vector<Front> frontsOf(const std::vector<Point2>& footprint, std::uint32_t without_edges = 0);

// Triangles that a building's windows cost for each metre of storey when a window takes one metre.
double windowCost(const CityBuilding& building);
// Triangles of its bands of windows and arcades, whatever the spacing.
double fixedCost(const CityBuilding& building);
// spacing: metres of front for one window.
void addBuilding(MeshBuilder& mesh, const CityBuilding& building, double spacing, Random random,
                 const std::string& name);

enum class Furniture : std::uint8_t {
  kTree,
  kLamp,
  kBench,
  kBin,
  kHydrant,
  kCar,
  kTrafficLight,
  kHedge,
  kKiosk
};
// At the placement's origin, on its ground; what has a front looks along -y.
void addFurniture(MeshBuilder& mesh, Furniture what, const Placement& placement, Random& random,
                  const std::string& name);

// The buildings of a block whose south-west corner is the placement's origin, by the block's kind.
enum class BlockKind : std::uint8_t { kCourtyard, kRows, kTower, kTurned, kGarage, kSquare };
std::vector<CityBuilding> planBlock(BlockKind kind, const Placement& block, Random& random);

// What walks through the city need to know.
struct CityPlan {
  std::uint32_t columns = 1, rows = 1;
  Point2 courtyard;  // middle of one, near the middle of the city
  double far = 2000.0;
};
std::vector<CameraPath> cityWalks(const CityPlan& plan);

}  // namespace sightline::scenes
