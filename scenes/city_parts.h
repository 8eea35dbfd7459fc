#pragma once

// The elements of a quarter of the city, shared by the files that plan it, build it and lead the camera
// through it.

#include <cstdint>
#include <string>
#include <vector>

#include "scenes/mesh_builder.h"
#include "scenes/placement.h"
#include "scenes/random.h"

namespace sightline::scenes {

// One copy of the city is a square quarter. Streets run along its borders (half of each belongs to the
// neighbour), and lanes cross in its centre; the four blocks between them are raised by a kerb.
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

// A stretch of wall that has windows; its outside is on the right of a -> b.
struct Front {
  Point2 a, b;
};

enum class RoofShape : std::uint8_t { kNone, kFlat, kGable, kHip };
enum class WindowStyle : std::uint8_t { kPlain, kSill, kFramed, kRibbon };

// An upright part of a building: one shell with storeys of windows on its fronts.
struct Mass {
  std::vector<Point2> footprint;  // counter-clockwise
  double base = 0.0;              // metres above the pavement
  std::uint32_t storeys = 1;
  double storey_height = 3.1;
  RoofShape roof = RoofShape::kFlat;
  std::vector<Front> fronts;
  bool has_door = false;  // in the middle of the first front

  double top() const { return base + storeys * storey_height; }
};

// A free-standing wall with openings, in front of a recessed ground floor or around the decks of a garage.
struct Arcade {
  Point2 a, b;
  double height = 4.0;         // metres, of one row of openings
  std::uint32_t openings = 1;  // number per row
  std::uint32_t rows = 1;
  double parapet = 0.0;  // metres from the foot of each row to its openings
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

// Every edge of the footprint as a front, except those in without_edges.
std::vector<Front> frontsOf(const std::vector<Point2>& footprint, std::uint32_t without_edges = 0);

// Number of triangles that a building's windows take per metre of storey, at one window per metre.
double windowCost(const CityBuilding& building);
// Number of triangles of its bands of windows and arcades, which does not depend on the spacing.
double fixedCost(const CityBuilding& building);
// spacing: metres of front per window.
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
// Adds a piece of street furniture at the placement's origin, on its ground. Pieces with a front look along
// -y.
void addFurniture(MeshBuilder& mesh, Furniture what, const Placement& placement, Random& random,
                  const std::string& name);

// The buildings of a block, by the kind of block. The placement's origin is the block's south-west corner.
enum class BlockKind : std::uint8_t { kCourtyard, kRows, kTower, kTurned, kGarage, kSquare };
std::vector<CityBuilding> planBlock(BlockKind kind, const Placement& block, Random& random);

// The places of a city that its camera paths need.
struct CityPlan {
  std::uint32_t columns = 1, rows = 1;
  Point2 courtyard;  // centre of a courtyard near the centre of the city
  double far = 2000.0;
};
std::vector<CameraPath> cityWalks(const CityPlan& plan);

}  // namespace sightline::scenes
