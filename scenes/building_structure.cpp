// Slabs, walls, pillars, windows and doors of the building.

#include <algorithm>

#include "scenes/building_parts.h"

namespace sightline::scenes {
namespace {

constexpr double kWindowSill = 0.875, kWindowHeight = 1.5, kWindowWidth = 1.375;

std::string floorName(std::uint32_t floor) {
  return "floor " + std::to_string(floor);
}

struct Context {
  MeshBuilder& mesh;
  const BuildingPlan& plan;
  Random& random;
  std::uint32_t floor;
};

// A wall between two pillars; the outside of an outer wall is on the right of a -> b.
struct Wall {
  Point2 a, b;
  std::string name;
  bool outer = false;
  std::vector<Rectangle> openings;  // x along the wall from a, y above the floor

  double length() const { return scenes::length(b - a); }
};

void addWall(const Context& at, const Wall& wall) {
  const double low = floorHeight(at.floor), high = ceilingHeight(at.floor);
  std::vector<Rectangle> openings = wall.openings;
  for (Rectangle& opening : openings) {
    opening.min.y += low;
    opening.max.y += low;
  }
  at.mesh.place(Placement{}.onWall(wall.a, wall.b, 0.0));
  at.mesh.startObject(wall.name, id(wall.outer ? BuildingMaterial::kFacade : BuildingMaterial::kPlaster));
  at.mesh.plate({{0.0, low}, {wall.length(), high}}, -kHalfWall, kHalfWall, openings);
}

// Adds frames and panes in the openings of an outer wall.
void addWindows(const Context& at, const Wall& wall) {
  at.mesh.place(Placement{}.onWall(wall.a, wall.b, floorHeight(at.floor)));
  for (std::size_t i = 0; i < wall.openings.size(); ++i) {
    const Rectangle& opening = wall.openings[i];
    const Point2 border{0.06, 0.06};
    const Rectangle pane{opening.min + border, opening.max - border};
    const std::string name = wall.name + " window " + std::to_string(i);
    at.mesh.startObject(name + " frame", id(BuildingMaterial::kFrame));
    at.mesh.ring(corners(opening), corners(pane), -0.05, 0.05);
    at.mesh.startObject(name + " pane", id(BuildingMaterial::kGlass));
    at.mesh.quad({pane.min.x, pane.min.y, 0}, {pane.max.x, pane.min.y, 0}, {pane.max.x, pane.max.y, 0},
                 {pane.min.x, pane.max.y, 0});
  }
}

void cutWindows(Wall& wall) {
  const double along = wall.length();
  const int count = along > 3.5 ? 2 : 1;
  for (int i = 0; i < count; ++i) {
    const double middle = along * (2 * i + 1) / (2 * count), half = std::min(kWindowWidth, along - 0.8) * 0.5;
    wall.openings.push_back({{middle - half, kWindowSill}, {middle + half, kWindowSill + kWindowHeight}});
  }
}

// Adds jambs, head, and a leaf that is open into the room by open_turns. A door of a plan of shut doors is
// shut, and its leaf reaches into jambs, head and floor, so that it leaves no gap.
void addDoor(const Context& at, Point2 middle, bool room_is_north, double open_turns,
             const std::string& name) {
  constexpr double kJamb = 0.04, kDepth = kHalfWall + 0.02, kHalf = kDoorWidth * 0.5;
  const Placement door = Placement{}.moved({middle.x, middle.y, floorHeight(at.floor)});
  at.mesh.place(door);
  at.mesh.startObject(name + " frame", id(BuildingMaterial::kFrame));
  at.mesh.box({-kHalf, -kDepth, 0}, {-kHalf + kJamb, kDepth, kDoorHeight - kJamb});
  at.mesh.box({kHalf - kJamb, -kDepth, 0}, {kHalf, kDepth, kDoorHeight - kJamb});
  at.mesh.box({-kHalf, -kDepth, kDoorHeight - kJamb}, {kHalf, kDepth, kDoorHeight});
  const double side = room_is_north ? 1.0 : -1.0;
  const bool shut = at.plan.shut_doors;
  const double reach = shut ? 0.01 : 0.0, bottom = shut ? -reach : 0.01;
  const Placement leaf =
      door.moved({-kHalf + kJamb, side * kHalfWall, 0}).turned(shut ? 0.0 : side * open_turns);
  at.mesh.place(leaf);
  at.mesh.startObject(name + " leaf", id(BuildingMaterial::kLeaf));
  const double width = kDoorWidth - 2 * kJamb;
  at.mesh.box({-reach, -0.02, bottom}, {width + reach, 0.02, kDoorHeight - kJamb + reach});
  at.mesh.box({width - 0.12, -0.06, 1.0}, {width - 0.04, 0.06, 1.04});
}

// The angle of a door: shut, half open or wide open.
double doorOpening(Random& random, bool on_walk) {
  const double kind = random.uniform(), part = random.uniform();
  if (on_walk || kind > 0.6) {
    return 0.25 + 0.03 * part;
  }
  return kind < 0.25 ? 0.0 : 0.08 + 0.12 * part;
}

Wall newWall(const Context& at, Point2 a, Point2 b, const std::string& what) {
  const Point2 d = (b - a) / length(b - a);
  Wall wall;
  wall.a = a + d * kHalfWall;
  wall.b = b - d * kHalfWall;
  wall.name = floorName(at.floor) + " wall " + what;
  return wall;
}

// Adds the wall between a room or the stairwell and its corridor.
void addCorridorWall(const Context& at, std::uint32_t bay, std::uint32_t row, const std::string& what) {
  const Room room = roomAt(at.plan, at.floor, bay, row);
  const double y = room.north ? at.plan.ys[row] : at.plan.ys[row + 1];
  Wall wall = newWall(at, {at.plan.xs[bay], y}, {at.plan.xs[bay + 1], y}, what);
  if (spaceAt(bay, row) == SpaceKind::kStairs) {
    wall.openings.push_back({{0.375, 0.0}, {wall.length() - 0.375, 2.625}});
    addWall(at, wall);
    return;
  }
  const double door = doorOf(at.plan, bay, row), along = door - wall.a.x;
  wall.openings.push_back({{along - kDoorWidth / 2, 0.0}, {along + kDoorWidth / 2, kDoorHeight}});
  addWall(at, wall);
  addDoor(at, {door, y}, room.north, doorOpening(at.random, room.on_walk), room.name + " door");
}

// Adds a wall along x, on the line between row - 1 and row.
void addLongWall(const Context& at, std::uint32_t bay, std::uint32_t row) {
  const double y = at.plan.ys[row];
  const Point2 west{at.plan.xs[bay], y}, east{at.plan.xs[bay + 1], y};
  const std::string what = "along " + std::to_string(row) + "-" + std::to_string(bay);
  if (row == 0 || row == kRows) {
    Wall wall = row == 0 ? newWall(at, west, east, what) : newWall(at, east, west, what);
    wall.outer = true;
    cutWindows(wall);
    addWall(at, wall);
    addWindows(at, wall);
    return;
  }
  const SpaceKind below = spaceAt(bay, row - 1), above = spaceAt(bay, row);
  if (below == SpaceKind::kCorridor && above == SpaceKind::kCorridor) {
    return;
  }
  if (below == SpaceKind::kCorridor || above == SpaceKind::kCorridor) {
    addCorridorWall(at, bay, below == SpaceKind::kCorridor ? row : row - 1, what);
    return;
  }
  addWall(at, newWall(at, west, east, what));
}

// Adds a wall along y, on the line between bay - 1 and bay.
void addCrossWall(const Context& at, std::uint32_t bay, std::uint32_t row) {
  const Point2 south{at.plan.xs[bay], at.plan.ys[row]}, north{at.plan.xs[bay], at.plan.ys[row + 1]};
  const std::string what = "across " + std::to_string(row) + "-" + std::to_string(bay);
  if (bay == 0 || bay == kBays) {
    Wall wall = bay == 0 ? newWall(at, north, south, what) : newWall(at, south, north, what);
    wall.outer = true;
    const bool entrance = at.floor == 0 && bay == 0 && row == kCorridorA;
    if (entrance) {
      const double middle = wall.length() * 0.5;
      wall.openings.push_back({{middle - 0.75, 0.0}, {middle + 0.75, 2.25}});
    } else {
      cutWindows(wall);
    }
    addWall(at, wall);
    if (!entrance) {
      addWindows(at, wall);
    }
    return;
  }
  const bool open =
      spaceAt(bay - 1, row) == SpaceKind::kCorridor && spaceAt(bay, row) == SpaceKind::kCorridor;
  if (!open) {
    addWall(at, newWall(at, south, north, what));
  }
}

// Walls join at every node of the plan, so each node has a pillar.
void addPillar(const Context& at, std::uint32_t bay, std::uint32_t row) {
  const Point2 p{at.plan.xs[bay], at.plan.ys[row]};
  const bool outer = bay == 0 || bay == kBays || row == 0 || row == kRows;
  at.mesh.startObject(floorName(at.floor) + " pillar " + std::to_string(row) + "-" + std::to_string(bay),
                      id(outer ? BuildingMaterial::kFacade : BuildingMaterial::kPillar));
  at.mesh.box({p.x - kHalfWall, p.y - kHalfWall, floorHeight(at.floor)},
              {p.x + kHalfWall, p.y + kHalfWall, ceilingHeight(at.floor)});
}

// Adds a cell's piece of the slab under `floor`; one above the last floor, it is the roof.
void addSlab(const Context& at, std::uint32_t bay, std::uint32_t row) {
  Rectangle area = at.plan.cell(bay, row);
  std::vector<Rectangle> openings;
  if (spaceAt(bay, row) == SpaceKind::kStairs && at.floor > 0 && at.floor < at.plan.floors) {
    openings.push_back({area.min + Point2{0.25, 0.25}, {area.max.x - 0.25, area.max.y - 0.925}});
  }
  // Outer slabs extend to the outer walls' faces.
  area.min = area.min - Point2{bay == 0 ? kHalfWall : 0.0, row == 0 ? kHalfWall : 0.0};
  area.max = area.max + Point2{bay + 1 == kBays ? kHalfWall : 0.0, row + 1 == kRows ? kHalfWall : 0.0};
  const BuildingMaterial material = at.floor == at.plan.floors ? BuildingMaterial::kRoof
                                    : spaceAt(bay, row) == SpaceKind::kRoom
                                        ? BuildingMaterial::kFloor
                                        : BuildingMaterial::kCorridorFloor;
  at.mesh.startObject(floorName(at.floor) + " slab " + std::to_string(row) + "-" + std::to_string(bay),
                      id(material));
  at.mesh.plate(area, floorHeight(at.floor) - kSlab, floorHeight(at.floor), openings);
}

void addFloor(const Context& at) {
  for (std::uint32_t row = 0; row <= kRows; ++row) {
    for (std::uint32_t bay = 0; bay <= kBays; ++bay) {
      at.mesh.place({});
      if (bay < kBays && row < kRows) {
        addSlab(at, bay, row);
      }
      if (at.floor == at.plan.floors) {
        continue;
      }
      addPillar(at, bay, row);
      if (bay < kBays) {
        addLongWall(at, bay, row);
      }
      if (row < kRows) {
        addCrossWall(at, bay, row);
      }
    }
  }
}

}  // namespace

void addStructure(MeshBuilder& mesh, const BuildingPlan& plan, Random random) {
  mesh.place({});
  mesh.startObject("ground", id(BuildingMaterial::kGround));
  mesh.quad({-40, -40, -0.2}, {plan.xs.back() + 40, -40, -0.2},
            {plan.xs.back() + 40, plan.ys.back() + 40, -0.2}, {-40, plan.ys.back() + 40, -0.2});
  for (std::uint32_t floor = 0; floor <= plan.floors; ++floor) {
    addFloor({mesh, plan, random, floor});
  }
}

}  // namespace sightline::scenes
