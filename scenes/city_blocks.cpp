// Plans the buildings of a block of the city.

#include "scenes/city_parts.h"

namespace sightline::scenes {
namespace {

constexpr double kGroundStorey = 4.0;  // height of passages and arcades, metres

CityMaterial anyWall(Random& random) {
  static constexpr CityMaterial kWalls[] = {CityMaterial::kBrick,     CityMaterial::kStucco,
                                            CityMaterial::kSandstone, CityMaterial::kConcrete,
                                            CityMaterial::kOchre,     CityMaterial::kSlateBlue};
  return kWalls[random.below(6)];
}

CityBuilding newBuilding(const Placement& placement, WindowStyle style, Random& random) {
  CityBuilding building;
  building.placement = placement;
  building.style = style;
  building.wall = anyWall(random);
  building.clear_glass = random.chance(0.3);
  return building;
}

Mass box(const Rectangle& area, double base, std::uint32_t storeys, RoofShape roof,
         std::uint32_t without_edges = 0) {
  Mass mass;
  mass.footprint = corners(area);
  mass.base = base;
  mass.storeys = storeys;
  mass.roof = roof;
  mass.fronts = frontsOf(mass.footprint, without_edges);
  return mass;
}

// Two L-shaped houses around a closed court; a passage leads through the second one's east wing.
std::vector<CityBuilding> planCourtyard(const Placement& block, Random& random) {
  CityBuilding first = newBuilding(block, WindowStyle::kPlain, random);
  Mass l;
  l.footprint = {{0, 0}, {35, 0}, {35, 9}, {9, 9}, {9, 35}, {0, 35}};
  l.storeys = random.between(5, 6);
  l.fronts = {{{0, 0}, {35, 0}}, {{35, 0}, {35, 9}}, {{26, 9}, {9, 9}},
              {{9, 9}, {9, 26}}, {{9, 35}, {0, 35}}, {{0, 35}, {0, 0}}};
  l.has_door = true;
  first.masses.push_back(l);

  CityBuilding second = newBuilding(block, WindowStyle::kPlain, random);
  Mass upper;
  upper.footprint = {{35, 9}, {35, 35}, {9, 35}, {9, 26}, {26, 26}, {26, 9}};
  upper.base = kGroundStorey;
  upper.storeys = random.between(4, 5);
  upper.fronts = {{{35, 9}, {35, 35}}, {{35, 35}, {9, 35}}, {{9, 26}, {26, 26}}, {{26, 26}, {26, 9}}};
  Mass south = box({{26, 9}, {35, 16}}, 0.0, 1, RoofShape::kNone, 1 | 4);
  Mass north;
  north.footprint = {{26, 20}, {35, 20}, {35, 35}, {9, 35}, {9, 26}, {26, 26}};
  north.roof = RoofShape::kNone;
  north.fronts = {{{35, 20}, {35, 35}}, {{35, 35}, {9, 35}}, {{9, 26}, {26, 26}}, {{26, 26}, {26, 20}}};
  north.has_door = true;
  south.storey_height = north.storey_height = kGroundStorey;
  second.masses = {upper, south, north};
  return {first, second};
}

// Three gabled houses in a row, and behind them a long house over an arcade.
std::vector<CityBuilding> planRows(const Placement& block, Random& random) {
  std::vector<CityBuilding> buildings;
  const double cuts[] = {0.0, random.range(10.0, 12.5), random.range(22.0, 24.5), kBlock};
  for (std::uint32_t i = 0; i < 3; ++i) {
    CityBuilding house =
        newBuilding(block, random.chance(0.5) ? WindowStyle::kSill : WindowStyle::kFramed, random);
    house.roof = random.chance(0.6) ? CityMaterial::kTiles : CityMaterial::kSlate;
    const std::uint32_t party = (i < 2 ? 2u : 0u) | (i > 0 ? 8u : 0u);
    house.masses.push_back(box({{cuts[i], 0}, {cuts[i + 1], 11}}, 0.0, random.between(2, 4),
                               i == 1 ? RoofShape::kGable : RoofShape::kHip, party));
    house.masses.back().has_door = true;
    if (i != 1) {
      house.masses.back().roof = RoofShape::kGable;
    }
    buildings.push_back(house);
  }
  // Faces its own street, to the north, so it is placed with a half turn.
  CityBuilding slab = newBuilding(block.moved({kBlock, kBlock, 0}).turned(0.5), WindowStyle::kPlain, random);
  Mass shop = box({{0, 3}, {kBlock, 12}}, 0.0, 1, RoofShape::kNone);
  shop.storey_height = kGroundStorey;
  shop.has_door = true;
  slab.masses = {box({{0, 0}, {kBlock, 12}}, kGroundStorey, random.between(3, 4), RoofShape::kFlat), shop};
  slab.arcades = {{{0, 0}, {kBlock, 0}, kGroundStorey, 8},
                  {{kBlock, 0.5}, {kBlock, 3}, kGroundStorey, 1},
                  {{0, 3}, {0, 0.5}, kGroundStorey, 1}};
  buildings.push_back(slab);
  return buildings;
}

// A tower that steps back twice.
std::vector<CityBuilding> planTower(const Placement& block, Random& random) {
  const Placement middle = block.moved({kBlock / 2, kBlock / 2, 0});
  CityBuilding tower = newBuilding(random.chance(0.5) ? middle : middle.turned(random.range(-0.02, 0.02)),
                                   WindowStyle::kRibbon, random);
  tower.clear_glass = random.chance(0.5);
  double half = random.range(14.5, 15.5), base = 0.0;
  const std::uint32_t storeys[] = {random.between(2, 3), random.between(6, 8), random.between(2, 4)};
  for (std::uint32_t stage = 0; stage < 3; ++stage) {
    tower.masses.push_back(box({{-half, -half}, {half, half}}, base, storeys[stage], RoofShape::kFlat));
    tower.masses.back().has_door = stage == 0;
    base = tower.masses.back().top();
    half -= stage == 0 ? random.range(3.5, 5.0) : random.range(2.0, 3.5);
  }
  return {tower};
}

// Parking decks behind walls full of openings.
CityBuilding planGarage(const Placement& middle, Random& random) {
  constexpr double kDeck = 2.9, kThickness = 0.3;
  constexpr Rectangle kArea{{-11, 4.5}, {11, 12.5}};
  CityBuilding garage = newBuilding(middle, WindowStyle::kPlain, random);
  garage.wall = CityMaterial::kConcrete;
  constexpr std::uint32_t kDecks = 3;
  for (std::uint32_t deck = 1; deck <= kDecks; ++deck) {
    Mass slab = box({kArea.min + Point2{0.5, 0.5}, kArea.max - Point2{0.5, 0.5}}, deck * kDeck - 0.5, 1,
                    RoofShape::kNone);
    slab.storey_height = kThickness;
    slab.fronts.clear();
    garage.masses.push_back(slab);
  }
  const std::vector<Point2> outline = corners(kArea);
  for (std::uint32_t i = 0; i < 4; ++i) {
    // The short walls are between the long ones.
    const double inset = i % 2 ? 0.5 : 0.0;
    const Point2 a = outline[i], b = outline[(i + 1) % 4], d = (b - a) / length(b - a);
    garage.arcades.push_back({a + d * inset, b - d * inset, kDeck, i % 2 ? 1u : 4u, kDecks, 0.9});
  }
  return garage;
}

// Two buildings, the first of them T-shaped, turned by any angle.
std::vector<CityBuilding> planTurned(const Placement& block, bool with_garage, Random& random) {
  const Placement middle = block.moved({kBlock / 2, kBlock / 2, 0}).turned(random.uniform());
  CityBuilding first = newBuilding(middle, WindowStyle::kSill, random);
  Mass t;
  t.footprint = {{-12, -11}, {12, -11}, {12, -4}, {4, -4}, {4, 1}, {-4, 1}, {-4, -4}, {-12, -4}};
  t.storeys = random.between(3, 6);
  t.fronts = frontsOf(t.footprint);
  t.has_door = true;
  first.masses.push_back(t);
  if (with_garage) {
    return {first, planGarage(middle, random)};
  }
  CityBuilding second = newBuilding(middle, WindowStyle::kPlain, random);
  second.roof = CityMaterial::kTiles;
  second.masses.push_back(box({{-11, 4.5}, {11, 12.5}}, 0.0, random.between(2, 4), RoofShape::kHip));
  second.masses.back().has_door = true;
  return {first, second};
}

// A square with a pavilion.
std::vector<CityBuilding> planSquare(const Placement& block, Random& random) {
  const Placement middle = block.moved({kBlock / 2, kBlock / 2, 0}).turned(random.uniform());
  CityBuilding pavilion = newBuilding(middle, WindowStyle::kFramed, random);
  pavilion.roof = CityMaterial::kSlate;
  pavilion.masses.push_back(box({{-2.5, -2.5}, {2.5, 2.5}}, 0.0, 1, RoofShape::kNone));
  pavilion.masses.front().storey_height = 3.6;
  pavilion.masses.front().has_door = true;
  Mass loft = box({{-5, -5}, {5, 5}}, 3.6, 1, RoofShape::kHip);
  loft.storey_height = 2.8;
  pavilion.masses.push_back(loft);
  for (const Front& side : frontsOf(corners({{-5, -5}, {5, 5}}))) {
    pavilion.arcades.push_back({side.a, side.b, 3.6, 3});
  }
  return {pavilion};
}

}  // namespace

std::vector<CityBuilding> planBlock(BlockKind kind, const Placement& block, Random& random) {
  switch (kind) {
    case BlockKind::kCourtyard:
      return planCourtyard(block, random);
    case BlockKind::kRows:
      return planRows(block, random);
    case BlockKind::kTower:
      return planTower(block, random);
    case BlockKind::kTurned:
      return planTurned(block, false, random);
    case BlockKind::kGarage:
      return planTurned(block, true, random);
    default:
      return planSquare(block, random);
  }
}

}  // namespace sightline::scenes
