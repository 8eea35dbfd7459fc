#include "scenes/city_quarter.h"

#include <algorithm>
#include <utility>

namespace sightline::scenes {
namespace {

// A place for a piece of street furniture.
struct Slot {
  Furniture what;
  Placement at;
};

void addGround(MeshBuilder& mesh, const QuarterPlan& plan) {
  mesh.place(plan.corner);
  constexpr double kHalf = kQuarter * 0.5;
  for (std::uint32_t i = 0; i < 4; ++i) {
    const double x = i % 2 * kHalf, y = i / 2 * kHalf;
    mesh.startObject(plan.name + " road " + std::to_string(i), id(CityMaterial::kAsphalt));
    mesh.quad({x, y, 0}, {x + kHalf, y, 0}, {x + kHalf, y + kHalf, 0}, {x, y + kHalf, 0});
  }
  for (std::uint32_t i = 0; i < 4; ++i) {
    const Point2 corner = blockCorner(i);
    const double street = kBlockStart - kRoadHalf;
    const double west = i % 2 ? kLanePavement : street, south = i / 2 ? kLanePavement : street;
    const double east = i % 2 ? street : kLanePavement, north = i / 2 ? street : kLanePavement;
    mesh.startObject(plan.name + " pavement " + std::to_string(i), id(CityMaterial::kPavement));
    mesh.box({corner.x - west, corner.y - south, -0.1},
             {corner.x + kBlock + east, corner.y + kBlock + north, kKerb});
  }
}

void addMarkings(MeshBuilder& mesh, const QuarterPlan& plan) {
  mesh.place(plan.corner);
  const auto patch = [&](double x0, double y0, double x1, double y1) {
    mesh.quad({x0, y0, 0.02}, {x1, y0, 0.02}, {x1, y1, 0.02}, {x0, y1, 0.02});
  };
  mesh.startObject(plan.name + " markings west", id(CityMaterial::kMarking));
  for (double y = 12.0; y < 84.0; y += 6.0) {
    patch(0.05, y, 0.2, y + 3.0);
  }
  mesh.startObject(plan.name + " markings south", id(CityMaterial::kMarking));
  for (double x = 12.0; x < 84.0; x += 6.0) {
    patch(x, 0.05, x + 3.0, 0.2);
  }
  mesh.startObject(plan.name + " crossing", id(CityMaterial::kMarking));
  for (double x = 0.4; x < kRoadHalf - 0.5; x += 1.0) {
    patch(x, kRoadHalf + 0.5, x + 0.5, kRoadHalf + 3.0);
    patch(kRoadHalf + 0.5, x, kRoadHalf + 3.0, x + 0.5);
  }
}

// Plans a block's own ground cover and the furniture on it.
void planBlockSlots(BlockKind kind, const Placement& block, Random& random, std::vector<Slot>& slots) {
  const auto put = [&](Furniture what, double x, double y, double turns) {
    slots.push_back({what, block.moved({x, y, 0}).turned(turns)});
  };
  if (kind == BlockKind::kCourtyard) {
    put(Furniture::kTree, 11.5, 11.5, 0);
    put(Furniture::kTree, 23.5, 23.5, 0);
    put(Furniture::kBench, 11.0, 17.5, 0.25);
    put(Furniture::kBin, 10.0, 20.0, 0);
  } else if (kind == BlockKind::kRows) {
    for (double x = 4.0; x < 33.0; x += 7.0) {
      const double along = x + random.range(-1, 1);
      put(Furniture::kTree, along, random.range(15, 19), 0);
    }
    put(Furniture::kHedge, 9.0, 14.0, 0);
    put(Furniture::kHedge, 25.0, 14.0, 0);
  } else if (kind == BlockKind::kSquare) {
    for (std::uint32_t i = 0; i < 4; ++i) {
      const double t = 5.0 + 8.3 * i;
      put(Furniture::kTree, t, 3.5, 0);
      put(Furniture::kTree, t, 31.5, 0);
      put(Furniture::kTree, i % 2 ? 3.5 : 31.5, 9.0 + 5.0 * i, 0);
    }
    put(Furniture::kBench, 17.5, 6.5, 0);
    put(Furniture::kBench, 17.5, 28.5, 0.5);
    put(Furniture::kHedge, 8.0, 8.0, 0.125);
    put(Furniture::kHedge, 27.0, 27.0, 0.125);
    put(Furniture::kKiosk, 29.5, 5.5, 0.0);
  }
}

void addBlockGround(MeshBuilder& mesh, BlockKind kind, const Placement& block, const std::string& name) {
  mesh.place(block);
  if (kind == BlockKind::kSquare) {
    mesh.startObject(name + " lawn", id(CityMaterial::kGrass));
    mesh.plate({{1, 1}, {kBlock - 1, kBlock - 1}}, -0.05, 0.06,
               std::vector<Rectangle>{{{9.5, 9.5}, {25.5, 25.5}}, {{16.0, 1}, {19.0, 9.5}}});
  } else if (kind == BlockKind::kRows) {
    mesh.startObject(name + " yard", id(CityMaterial::kGrass));
    mesh.box({0.5, 11.5, -0.05}, {kBlock - 0.5, 22.5, 0.06});
  } else if (kind == BlockKind::kCourtyard) {
    mesh.startObject(name + " court", id(CityMaterial::kSand));
    mesh.box({9.5, 9.5, -0.05}, {25.5, 25.5, 0.04});
  }
}

// Plans the two street sides of each block: a row of slots on the pavement, cars at the kerb, lights at the
// corner.
void planStreetSlots(const QuarterPlan& plan, Random& random, std::vector<Slot>& needed,
                     std::vector<Slot>& spare) {
  for (std::uint32_t side = 0; side < 8; ++side) {
    // Coordinates of a side with its street to the south: x along it, y = 0 on the street's centre line.
    const std::uint32_t quarter_turns = side / 2;
    const Placement at =
        plan.corner.moved({kQuarter / 2, kQuarter / 2, 0}).turned(0.25 * quarter_turns).moved({-48, -48, 0});
    const double start = side % 2 ? kLaneEnd : kBlockStart;
    const auto put = [&](std::vector<Slot>& slots, Furniture what, double x, double y, double turns) {
      const double z = what == Furniture::kCar ? 0.0 : kKerb;
      slots.push_back({what, at.moved({x, y, z}).turned(turns)});
    };
    put(needed, Furniture::kLamp, start + 10.0, kRoadHalf + 0.5, 0);
    put(needed, Furniture::kTree, start + 5.0, kRoadHalf + 0.9, 0);
    put(spare, Furniture::kTree, start + 15.0, kRoadHalf + 0.9, 0);
    if (side % 2) {
      put(needed, Furniture::kTrafficLight, kQuarter - kRoadHalf - 0.6, kRoadHalf + 0.6, 0);
      put(needed, Furniture::kHydrant, start + 12.5, kRoadHalf + 0.5, 0);
    }
    put(spare, Furniture::kLamp, start + 26.0, kRoadHalf + 0.5, 0);
    put(spare, Furniture::kTree, start + 21.0, kRoadHalf + 0.9, 0);
    put(spare, Furniture::kTree, start + 31.0, kRoadHalf + 0.9, 0);
    put(spare, Furniture::kBench, start + 8.0, kRoadHalf + 0.8, 0.5);
    put(spare, Furniture::kBin, start + 28.0, kRoadHalf + 0.5, 0);
    for (double x = 4.0; x < 34.0; x += 5.6) {
      put(spare, Furniture::kCar, start + x + random.range(-0.3, 0.3), kRoadHalf - 1.15, 0.5);
    }
    // Along the lane, on the opposite pavement of the block.
    put(spare, Furniture::kLamp, 0.5 * kQuarter + (side % 2 ? 3.3 : -3.3), kBlockStart + 8.0,
        side % 2 ? 0.75 : 0.25);
  }
}

void shuffle(std::vector<Slot>& slots, Random& random) {
  for (std::size_t i = slots.size(); i > 1; --i) {
    std::swap(slots[i - 1], slots[random.below(static_cast<std::uint32_t>(i))]);
  }
}

void addSlots(MeshBuilder& mesh, const QuarterPlan& plan, Random& random, std::uint64_t start_count) {
  // Triangles of the largest piece; filling up stops this close to the budget.
  constexpr std::uint32_t kLargest = 120;
  std::vector<Slot> needed, spare;
  planStreetSlots(plan, random, needed, spare);
  for (std::uint32_t i = 0; i < 4; ++i) {
    planBlockSlots(plan.blocks[i], blockPlacement(plan, i), random, needed);
  }
  shuffle(spare, random);
  std::uint32_t number = 0;
  const auto add = [&](const Slot& slot) {
    addFurniture(mesh, slot.what, slot.at, random, plan.name + " furniture " + std::to_string(number++));
  };
  for (const Slot& slot : needed) {
    add(slot);
  }
  for (const Slot& slot : spare) {
    if (mesh.triangleCount() - start_count + kLargest > kQuarterTriangles) {
      break;
    }
    add(slot);
  }
}

}  // namespace

Point2 blockCorner(std::uint32_t block) {
  return {block % 2 ? kLaneEnd : kBlockStart, block / 2 ? kLaneEnd : kBlockStart};
}

Placement blockPlacement(const QuarterPlan& plan, std::uint32_t block) {
  constexpr double kMiddle = kBlock / 2;
  const Point2 corner = blockCorner(block);
  return plan.corner.moved({corner.x + kMiddle, corner.y + kMiddle, kKerb})
      .turned(0.25 * plan.turns[block])
      .moved({-kMiddle, -kMiddle, 0});
}

QuarterPlan planQuarter(std::uint32_t seed, std::uint32_t number, std::uint32_t columns) {
  QuarterPlan plan;
  plan.random = Random(seed, number);
  plan.name = "quarter " + std::to_string(number);
  plan.corner.origin = {number % columns * kQuarter, number / columns * kQuarter, 0.0};
  plan.blocks = {BlockKind::kCourtyard, BlockKind::kRows,
                 plan.random.chance(0.6) ? BlockKind::kTower : BlockKind::kTurned,
                 plan.random.chance(0.6) ? BlockKind::kSquare : BlockKind::kGarage};
  for (std::uint32_t i = 4; i > 1; --i) {
    std::swap(plan.blocks[i - 1], plan.blocks[plan.random.below(i)]);
  }
  for (std::uint32_t& turns : plan.turns) {
    turns = plan.random.below(4);
  }
  return plan;
}

void addQuarter(MeshBuilder& mesh, QuarterPlan plan) {
  constexpr double kFrontTriangles = 4700.0;  // triangles per quarter for windows and arcades
  const std::uint64_t start_count = mesh.triangleCount();
  addGround(mesh, plan);
  addMarkings(mesh, plan);
  std::vector<CityBuilding> buildings;
  double cost = 0.0, fixed = 0.0;
  for (std::uint32_t i = 0; i < 4; ++i) {
    const Placement block = blockPlacement(plan, i);
    addBlockGround(mesh, plan.blocks[i], block, plan.name + " block " + std::to_string(i));
    for (CityBuilding& building : planBlock(plan.blocks[i], block, plan.random)) {
      cost += windowCost(building);
      fixed += fixedCost(building);
      buildings.push_back(std::move(building));
    }
  }
  const double spacing = std::clamp(cost / (kFrontTriangles - fixed), 2.6, 9.0);
  for (std::size_t b = 0; b < buildings.size(); ++b) {
    const double own_spacing = spacing * plan.random.range(0.9, 1.1);
    addBuilding(mesh, buildings[b], own_spacing, Random(plan.random.next()),
                plan.name + " building " + std::to_string(b));
  }
  addSlots(mesh, plan, plan.random, start_count);
}

}  // namespace sightline::scenes
