#include <algorithm>
#include <cmath>

#include "scenes/building_parts.h"

namespace sightline::scenes {

BuildingPlan planBuilding(std::uint32_t floors, std::uint32_t seed) {
  BuildingPlan plan;
  plan.floors = floors;
  Random random(seed, 1);
  for (std::uint32_t bay = 0; bay < kBays; ++bay) {
    const double any = 4.5 + 0.125 * random.below(9);
    plan.xs[bay + 1] = plan.xs[bay] + (bay == kHallBay ? 3.5 : bay == kStairBay ? 5.0 : any);
  }
  plan.ys = {0.0, 5.0, 7.5, 12.0, 16.5, 19.0, 24.0};
  return plan;
}

SpaceKind spaceAt(std::uint32_t bay, std::uint32_t row) {
  if (row == kCorridorA || row == kCorridorB) {
    return SpaceKind::kCorridor;
  }
  if (bay == kHallBay && row > kCorridorA && row < kCorridorB) {
    return SpaceKind::kCorridor;
  }
  return bay == kStairBay && row == 0 ? SpaceKind::kStairs : SpaceKind::kRoom;
}

double doorOf(const BuildingPlan& plan, std::uint32_t bay, std::uint32_t row) {
  // Doors are shifted by the row, so that those of neighbours do not face each other.
  const double middle = (plan.xs[bay] + plan.xs[bay + 1]) * 0.5;
  return std::floor(middle * 8.0) / 8.0 + ((bay + row) % 2 ? 0.25 : -0.25);
}

Room roomAt(const BuildingPlan& plan, std::uint32_t floor, std::uint32_t bay, std::uint32_t row) {
  Room room;
  room.floor = floor;
  room.bay = bay;
  room.row = row;
  room.north = row == kCorridorA + 1 || row == kCorridorB + 1;
  room.has_window = row == 0 || row + 1 == kRows;
  const Rectangle cell = plan.cell(bay, row);
  room.width = cell.max.x - cell.min.x - kWallThickness;
  room.depth = cell.max.y - cell.min.y - kWallThickness;
  const double door = doorOf(plan, bay, row), z = floorHeight(floor);
  if (room.north) {
    room.placement.origin = {cell.min.x + kHalfWall, cell.min.y + kHalfWall, z};
    room.door = door - room.placement.origin.x;
  } else {
    room.placement.origin = {cell.max.x - kHalfWall, cell.max.y - kHalfWall, z};
    room.placement = room.placement.turned(0.5);
    room.door = room.placement.origin.x - door;
  }
  room.on_walk = std::any_of(visits().begin(), visits().end(), [&](const Visit& visit) {
    return visit.floor == floor && visit.bay == bay && visit.row == row;
  });
  room.name = "floor " + std::to_string(floor) + " room " + std::to_string(row) + "-" + std::to_string(bay);
  return room;
}

const std::vector<Visit>& visits() {
  static const std::vector<Visit> kVisits = {{0, 1, 2}, {0, 3, 0}, {0, 2, 5},
                                             {0, 7, 2}, {1, 5, 0}, {1, 3, 2}};
  return kVisits;
}

std::vector<Material> buildingMaterials() {
  constexpr Opacity kOpaque = Opacity::kOpaque;
  return {
      {"ground", kOpaque, false, {0.16f, 0.28f, 0.10f, 1.0f}},
      {"plaster", kOpaque, false, {0.72f, 0.69f, 0.62f, 1.0f}},
      {"facade", kOpaque, false, {0.52f, 0.33f, 0.23f, 1.0f}},
      {"pillar", kOpaque, false, {0.60f, 0.57f, 0.52f, 1.0f}},
      {"parquet", kOpaque, false, {0.36f, 0.22f, 0.11f, 1.0f}},
      {"linoleum", kOpaque, false, {0.28f, 0.33f, 0.33f, 1.0f}},
      {"roof", kOpaque, false, {0.22f, 0.22f, 0.23f, 1.0f}},
      {"stairs", kOpaque, false, {0.45f, 0.44f, 0.42f, 1.0f}},
      {"rail", kOpaque, false, {0.12f, 0.13f, 0.15f, 1.0f}},
      {"frame", kOpaque, false, {0.80f, 0.79f, 0.75f, 1.0f}},
      {"door leaf", kOpaque, false, {0.42f, 0.20f, 0.09f, 1.0f}},
      {"glass", Opacity::kBlended, true, {0.45f, 0.62f, 0.70f, 0.35f}},
      {"light wood", kOpaque, false, {0.55f, 0.38f, 0.20f, 1.0f}},
      {"dark wood", kOpaque, false, {0.20f, 0.11f, 0.06f, 1.0f}},
      {"white", kOpaque, false, {0.80f, 0.80f, 0.78f, 1.0f}},
      {"metal", kOpaque, false, {0.32f, 0.34f, 0.36f, 1.0f}},
      {"fabric", kOpaque, false, {0.13f, 0.24f, 0.40f, 1.0f}},
      {"books", kOpaque, false, {0.46f, 0.13f, 0.10f, 1.0f}},
      {"screen", kOpaque, false, {0.03f, 0.04f, 0.06f, 1.0f}},
      {"ceramic", kOpaque, false, {0.85f, 0.86f, 0.87f, 1.0f}},
      {"light", kOpaque, false, {0.95f, 0.92f, 0.80f, 1.0f}},
      {"plant", kOpaque, true, {0.09f, 0.30f, 0.07f, 1.0f}},
  };
}

}  // namespace sightline::scenes
