// Slabs, walls and doors of the block, and the equipment on its roof.

#include <algorithm>

#include "scenes/ship_parts.h"

namespace sightline::scenes::ship {
namespace {

constexpr double kWallHeight = kStorey - kSlab;
constexpr double kHalfDoor = kDoorWidth * 0.5;

std::string deckName(std::uint32_t deck) {
  return "deck " + std::to_string(deck);
}

// Adds boxes side by side. The stairwell's bay has none to port except under the walls and at the doors.
void addSlabs(MeshBuilder& mesh, const Plan& plan, std::uint32_t deck) {
  constexpr double kOutside = kBlockHalf + kOuterWall;
  const double top = deckHeight(deck), low = top - kSlab;
  std::uint32_t count = 0;
  mesh.place({});
  for (std::uint32_t bay = 0; bay < plan.bays(); ++bay) {
    const double x0 = plan.bayStart(bay) - (bay == 0 ? kOuterWall : 0.0);
    const double x1 = plan.bayStart(bay + 1) + (bay + 1 == plan.bays() ? kOuterWall : 0.0);
    const auto piece = [&](double y0, double y1) {
      mesh.startObject(deckName(deck) + " slab " + std::to_string(count++), id(Paint::kFloor));
      mesh.box({x0, y0, low}, {x1, y1, top});
    };
    piece(-kOutside, -kCorridorHalf);
    piece(-kCorridorHalf, kCorridorHalf);
    if (bay == plan.stairBay() && deck < plan.decks) {
      piece(kCorridorHalf, kStairFoot);
      piece(kBlockHalf, kOutside);
    } else {
      piece(kCorridorHalf, kOutside);
    }
  }
}

// Adds a wall across the block at its aft or fore end. On the main deck, the corridor's fore end is open to
// the deck.
void addEndWall(MeshBuilder& mesh, const Plan& plan, std::uint32_t deck, bool fore) {
  Wall wall{.name = deckName(deck) + (fore ? " fore wall" : " aft wall"),
            .length = 2 * (kBlockHalf + kOuterWall),
            .thickness = kOuterWall,
            .height = kWallHeight};
  const double x = fore ? plan.blockEnd() + kOuterWall : kBlockStart;
  wall.at = {{x, -kBlockHalf - kOuterWall, deckHeight(deck)}, {0, 1, 0}, {-1, 0, 0}, {0, 0, 1}};
  if (fore && deck == kMainDeckNumber) {
    const double middle = wall.length * 0.5;
    wall.openings = {{{middle - kHalfDoor, 0}, {middle + kHalfDoor, kDoorHeight}}};
  }
  addWall(mesh, wall);
}

// Adds a ring around a porthole on the outside of the outer wall.
void addPortholeFrame(MeshBuilder& mesh, const Room& room, double x, double z) {
  mesh.place(standingAlong(room.placement, {x, room.depth + kOuterWall, z}, 1));
  mesh.startObject(room.name + " porthole", id(Paint::kFrame));
  mesh.lathe(std::array<Point2, 5>{{{0.47, -0.02}, {0.55, -0.02}, {0.53, 0.06}, {0.49, 0.06}, {0.47, -0.02}}},
             10);
}

void addOuterWall(MeshBuilder& mesh, const Room& room) {
  const double half = kInnerWall * 0.5;
  Wall wall{.name = room.name + " outer wall",
            .at = room.placement.moved({-half, room.depth, 0}),
            .length = room.width + kInnerWall,
            .thickness = kOuterWall,
            .height = kWallHeight};
  if (room.deck >= kMainDeckNumber) {
    const double middle = wall.length * 0.5;
    wall.openings = {{{middle - 0.3125, 1.1875}, {middle + 0.3125, 1.8125}}};
  }
  addWall(mesh, wall);
  if (!wall.openings.empty()) {
    addPortholeFrame(mesh, room, room.width * 0.5, 1.5);
  }
}

// The leaf is shut in the wall, or open at a right angle to it.
void addDoor(MeshBuilder& mesh, const Room& room, bool open) {
  constexpr double kLeaf = 0.0625;
  mesh.place(room.placement);
  mesh.startObject(room.name + " door", id(Paint::kDoor));
  if (open) {
    const double hinge = kDoorMiddle - kHalfDoor;
    mesh.box({hinge - kLeaf, 0.01, 0.01}, {hinge, kDoorWidth, kDoorHeight - 0.01});
  } else {
    mesh.box({kDoorMiddle - kHalfDoor, -0.09375, 0.0}, {kDoorMiddle + kHalfDoor, -0.03125, kDoorHeight});
  }
}

void addCorridorWall(MeshBuilder& mesh, const Plan& plan, const Room& room) {
  const double half = kInnerWall * 0.5;
  Wall wall{.name = room.name + " wall",
            .at = room.placement.moved({-half, -kInnerWall, 0}),
            .length = room.width + kInnerWall,
            .thickness = kInnerWall,
            .height = kWallHeight};
  const auto doorAt = [&](double middle, double half_width) {
    wall.openings.push_back({{middle - half_width, 0}, {middle + half_width, kDoorHeight}});
  };
  if (room.bay != plan.stairBay()) {
    doorAt(kDoorMiddle + half, kHalfDoor);
  } else if (room.port) {
    doorAt(kStairUp, 0.625);
    doorAt(kStairOn, 0.625);
  }
  addWall(mesh, wall);
}

// Adds the wall between a room and the next one towards the bow.
void addCrossWall(MeshBuilder& mesh, const Plan& plan, const Room& room) {
  if (room.bay + 1 == plan.bays()) {
    return;
  }
  const double x = room.port ? room.width : -kInnerWall;
  mesh.place(room.placement);
  mesh.startObject(room.name + " cross wall", id(Paint::kWall));
  mesh.box({x, 0, 0}, {x + kInnerWall, room.depth, kWallHeight});
}

// Adds the shaft from the engine room to the funnel, which has no door.
void addCasing(MeshBuilder& mesh, const Room& room) {
  mesh.startObject(room.name + " uptake", id(Paint::kMetal));
  addCylinder(mesh, room.placement, {room.width * 0.5, 2.0, 0.0}, 2, 0.8, kWallHeight, 20);
  for (std::uint32_t i = 0; i < 4; ++i) {
    mesh.startObject(room.name + " duct " + std::to_string(i), id(Paint::kPipe));
    addCylinder(mesh, room.placement, {0.6 + 1.1 * i, 4.5, 0.0}, 2, 0.25, kWallHeight, 12);
  }
}

void addCorridor(MeshBuilder& mesh, const Plan& plan, std::uint32_t deck) {
  for (std::uint32_t bay = 0; bay < plan.bays(); ++bay) {
    const double x = plan.bayStart(bay) + 2.0, top = deckHeight(deck) + kWallHeight;
    const std::string name = deckName(deck) + " corridor ";
    mesh.place({});
    mesh.startObject(name + "light " + std::to_string(bay), id(Paint::kLight));
    mesh.box({x - 0.6, -0.1, top - 0.06}, {x + 0.6, 0.1, top});
    mesh.startObject(name + "handrail " + std::to_string(bay), id(Paint::kWood));
    addCylinder(mesh, {}, {plan.bayStart(bay) + 0.5, -0.94, deckHeight(deck) + 0.9}, 0, 0.025, 1.75, 8);
  }
}

void addRoof(MeshBuilder& mesh, const Plan& plan) {
  const double z = deckHeight(plan.decks), x = plan.bayStart(plan.stairBay());
  mesh.place({});
  mesh.startObject("funnel", id(Paint::kHull));
  const Point2 outline[] = {{x, -5.5}, {x + 4, -6}, {x + 5, -4}, {x + 4, -2}, {x, -2.5}, {x - 1, -4}};
  mesh.prism(outline, z, z + 6.0);
  mesh.startObject("mast", id(Paint::kWhite));
  addCylinder(mesh, {}, {x + 3, 4, z}, 2, 0.3, 7.0);
  mesh.startObject("radar", id(Paint::kWhite));
  mesh.place({});
  mesh.box({x + 2.8, 2, z + 7.0}, {x + 3.2, 6, z + 7.3});
}

}  // namespace

void addDecks(MeshBuilder& mesh, const Plan& plan, std::uint32_t seed) {
  for (std::uint32_t deck = 0; deck <= plan.decks; ++deck) {
    addSlabs(mesh, plan, deck);
  }
  for (std::uint32_t deck = 0; deck < plan.decks; ++deck) {
    addEndWall(mesh, plan, deck, false);
    addEndWall(mesh, plan, deck, true);
    addCorridor(mesh, plan, deck);
    for (std::uint32_t number = 0; number < 2 * plan.bays(); ++number) {
      const Room room = roomAt(plan, deck, number / 2, number % 2 == 0);
      Random random(seed, 1000 + deck * 100 + number);
      addCorridorWall(mesh, plan, room);
      addCrossWall(mesh, plan, room);
      addOuterWall(mesh, room);
      if (room.bay != plan.stairBay()) {
        addDoor(mesh, room, random.chance(0.6) || isOnWalk(plan, room));
        furnish(mesh, plan, room, random);
      } else if (!room.port) {
        addCasing(mesh, room);
      }
    }
  }
  addRoof(mesh, plan);
}

}  // namespace sightline::scenes::ship
