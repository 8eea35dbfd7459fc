// The building: structure, stairs, furnished rooms, plants, and the camera path.

#include "scenes/building_parts.h"
#include "scenes/plant.h"
#include "scenes/procedural.h"

namespace sightline {
namespace scenes {
namespace {

// A rectangle in which a plant may stand, in x and y of the placement.
struct PlantSpot {
  Placement placement;
  Rectangle area;
};

// Adds spots along both sides of a corridor, beside the doors.
void addCorridorSpots(const BuildingPlan& plan, std::uint32_t floor, std::uint32_t row,
                      std::vector<PlantSpot>& spots) {
  constexpr double kFromWall = kHalfWall + 0.3, kFromDoor = 1.1, kDeep = 0.05;
  for (const std::uint32_t side_row : {row - 1, row + 1}) {
    for (std::uint32_t bay = 0; bay < kBays; ++bay) {
      if (!isRoom(bay, side_row)) {
        continue;
      }
      const double wall = side_row < row ? plan.ys[row] + kFromWall : plan.ys[row + 1] - kFromWall - kDeep;
      const double door = doorOf(plan, bay, side_row);
      const Placement at{{0, 0, floorHeight(floor)}};
      spots.push_back({at, {{plan.xs[bay] + 0.5, wall}, {door - kFromDoor, wall + kDeep}}});
      spots.push_back({at, {{door + kFromDoor, wall}, {plan.xs[bay + 1] - 0.5, wall + kDeep}}});
    }
  }
}

// Furnishes the floors. Rooms count three times, so that most plants are in rooms.
std::vector<PlantSpot> addRooms(MeshBuilder& mesh, const BuildingPlan& plan, std::uint32_t seed) {
  std::vector<PlantSpot> spots;
  for (std::uint32_t floor = 0; floor < plan.floors; ++floor) {
    for (std::uint32_t row = 0; row < kRows; ++row) {
      for (std::uint32_t bay = 0; bay < kBays; ++bay) {
        if (!isRoom(bay, row)) {
          continue;
        }
        const Room room = roomAt(plan, floor, bay, row);
        const std::uint32_t number = (floor * kRows + row) * kBays + bay;
        const Rectangle free = furnish(mesh, room, Random(seed, 1000 + number));
        spots.insert(spots.end(), 3, PlantSpot{room.placement, free});
      }
    }
    addCorridorSpots(plan, floor, kCorridorA, spots);
    addCorridorSpots(plan, floor, kCorridorB, spots);
  }
  std::erase_if(spots, [](const PlantSpot& spot) {
    return spot.area.min.x >= spot.area.max.x || spot.area.min.y >= spot.area.max.y;
  });
  return spots;
}

void addPlants(MeshBuilder& mesh, const std::vector<PlantSpot>& spots, std::uint32_t plants, Random random) {
  for (std::uint32_t i = 0; i < plants; ++i) {
    const PlantSpot& spot = spots[random.below(static_cast<std::uint32_t>(spots.size()))];
    const double x = random.range(spot.area.min.x, spot.area.max.x);
    const double y = random.range(spot.area.min.y, spot.area.max.y);
    mesh.startObject("plant " + std::to_string(i), id(BuildingMaterial::kPlant));
    addPlant(mesh, spot.placement.moved({x, y, 0}), Random(random.next()));
  }
}

}  // namespace
}  // namespace scenes

Scene makeBuilding(const BuildingOptions& options) {
  using namespace scenes;
  Scene scene;
  scene.materials = buildingMaterials();
  BuildingPlan plan = planBuilding(options.floors, options.seed);
  plan.shut_doors = options.shut_doors;
  {
    MeshBuilder mesh(scene);
    addStructure(mesh, plan, Random(options.seed, 2));
    addStairs(mesh, plan);
    const std::vector<PlantSpot> spots = addRooms(mesh, plan, options.seed);
    addPlants(mesh, spots, options.plants, Random(options.seed, 3));
  }
  weldPositions(scene);
  updateBounds(scene);
  scene.paths = {buildingWalk(plan)};
  return scene;
}

}  // namespace sightline
