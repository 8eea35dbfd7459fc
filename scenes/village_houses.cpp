// The places of the houses, the houses, and the church.

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "scenes/cottage.h"
#include "scenes/village_parts.h"
#include "scenes/walk.h"

namespace sightline::scenes::village {
namespace {

Placement placementOf(const Footprint& footprint, double floor) {
  const Point2 x = footprint.along;
  return {{footprint.middle.x, footprint.middle.y, floor}, {x.x, x.y, 0}, {-x.y, x.x, 0}, {0, 0, 1}};
}

struct GroundLevels {
  double low = 1e30, high = -1e30;
};
GroundLevels levelsUnder(const HeightField& ground, const Footprint& footprint) {
  GroundLevels levels;
  for (int i = -2; i <= 2; ++i) {
    for (int k = -2; k <= 2; ++k) {
      const double height = ground.height(footprint.at(0.5 * i, 0.5 * k));
      levels = {std::min(levels.low, height), std::max(levels.high, height)};
    }
  }
  return levels;
}

// Houses along one side of a leg of a street; side is 1 for the left.
void planSide(std::vector<HousePlace>& places, FreeGround& free, std::uint32_t count, Point2 a, Point2 b,
              double side, Random& random) {
  const double leg = length(b - a);
  const Point2 on = (b - a) / leg, out = Point2{-on.y, on.x} * side;
  double at = random.range(0.0, 2.0);
  while (at < leg && places.size() < count) {
    const double frontage = random.range(7.0, 12.5), depth = random.range(6.5, 9.0);
    const double setback = kStreetHalf + random.range(0.8, 2.0);
    // The door, on the footprint's south side, looks to the street.
    Footprint walls{a + on * (at + 0.5 * frontage) + out * (setback + 0.5 * depth), on * side, 0.5 * frontage,
                    0.5 * depth};
    Footprint taken = walls;
    taken.half_length += 0.55;
    taken.half_width += 0.55;
    if (free.tryFootprint(taken)) {
      places.push_back({walls, length(walls.middle) < 75.0});
      at += frontage + 1.2 + (random.chance(0.35) ? random.range(1.0, 6.0) : 0.0);
    } else {
      at += 1.5;
    }
  }
}

}  // namespace

const std::vector<std::vector<Vec3d>>& streets() {
  static const std::vector<std::vector<Vec3d>> kStreets = [] {
    const std::vector<std::vector<Vec3d>> corners{
        {{-150, -25, 0}, {-75, -45, 0}, {0, 0, 0}, {65, 32, 0}, {150, 10, 0}},
        {{15, 150, 0}, {25, 80, 0}, {0, 0, 0}, {-28, -72, 0}, {8, -150, 0}},
        {{-110, -130, 0}, {-75, -45, 0}, {-98, 55, 0}, {-60, 140, 0}},
        {{-98, 55, 0}, {-40, 50, 0}, {25, 80, 0}, {100, 105, 0}, {150, 90, 0}},
        {{65, 32, 0}, {85, -55, 0}, {30, -85, 0}, {-28, -72, 0}, {-110, -130, 0}},
        {{85, -55, 0}, {145, -90, 0}}};
    std::vector<std::vector<Vec3d>> rounded;
    for (const std::vector<Vec3d>& street : corners) {
      rounded.push_back(roundedRoute(street, 14.0));
    }
    return rounded;
  }();
  return kStreets;
}

std::vector<HousePlace> planHouses(FreeGround& free, std::uint32_t count, Random& random) {
  std::vector<HousePlace> places;
  for (const std::vector<Vec3d>& street : streets()) {
    for (const double side : {1.0, -1.0}) {
      // Curves are short legs; houses stand along what is left of the straight ones.
      for (std::size_t i = 0; i + 1 < street.size(); ++i) {
        const Point2 a{street[i].x, street[i].y}, b{street[i + 1].x, street[i + 1].y};
        if (length(b - a) > 8.0) {
          planSide(places, free, count, a, b, side, random);
        }
      }
    }
  }
  return places;
}

void addHouse(MeshBuilder& mesh, const HeightField& ground, const HousePlace& place, Random& random,
              const std::string& name) {
  static constexpr Surface kWalls[] = {kPlaster, kOchre, kTimber, kBrick};
  static constexpr Surface kRoofs[] = {kTiles, kTiles, kThatch, kSlate};
  Cottage plan;
  plan.surfaces = {MaterialId{kWalls[random.below(4)]}, MaterialId{kRoofs[random.below(4)]},
                   MaterialId{kStone}, MaterialId{kWood}, MaterialId{kWindow}};
  plan.length = 2.0 * place.footprint.half_length;
  plan.width = 2.0 * place.footprint.half_width;
  plan.storeys = random.chance(place.near_market ? 0.85 : 0.4) ? 2 : 1;
  plan.pitch = random.range(0.8, 1.2);
  const GroundLevels levels = levelsUnder(ground, place.footprint);
  const double floor = levels.low + 0.7 * (levels.high - levels.low) + 0.15;
  plan.sunk = floor - levels.low + 0.8;
  addCottage(mesh, placementOf(place.footprint, floor), plan, random, name);
}

void addChurch(MeshBuilder& mesh, const HeightField& ground, FreeGround& free, Random& random) {
  const Footprint nave{{-22.0, 27.0}, unitVector(0.06), 11.0, 5.0};
  Footprint taken = nave;
  taken.half_length += 5.5;
  taken.half_width += 1.0;
  free.takeFootprint(taken);
  const GroundLevels levels = levelsUnder(ground, taken);
  Cottage plan{.length = 22.0, .width = 10.0, .storey = 4.0, .storeys = 2, .pitch = 1.2};
  plan.surfaces = {MaterialId{kStone}, MaterialId{kSlate}, MaterialId{kStone}, MaterialId{kWood},
                   MaterialId{kWindow}};
  plan.sunk = levels.high - levels.low + 1.5;
  const Placement placement = placementOf(nave, levels.high + 0.3);
  addCottage(mesh, placement, plan, random, "church");
  mesh.place(placement);
  mesh.startObject("church tower", MaterialId{kStone});
  mesh.plate({{10.6, -2.6}, {15.8, 2.6}}, -plan.sunk, 21.0, {});
  mesh.place(placement.moved({13.2, 0.0, 21.02}).turned(0.125));
  mesh.startObject("church spire", MaterialId{kSlate});
  mesh.lathe(std::array<Point2, 3>{{{0, 0}, {4.1, 0}, {0, 10.0}}}, 4);
}

}  // namespace sightline::scenes::village
