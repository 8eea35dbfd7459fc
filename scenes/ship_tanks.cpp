// The contents of the holds, and the pipes and gear on the main deck above them.

#include <algorithm>
#include <cmath>

#include "scenes/ship_parts.h"

namespace sightline::scenes::ship {
namespace {

struct Hold {
  std::uint32_t number;
  double x0, x1;  // between the faces of the bulkheads
  double middle() const { return (x0 + x1) * 0.5; }
  std::string name() const { return "hold " + std::to_string(number); }
};

Hold holdAt(const Plan& plan, std::uint32_t number) {
  return {number, plan.holdStart(number), plan.holdStart(number + 1) - 0.5};
}

// Two spheres, each on a skirt.
void addSpheres(MeshBuilder& mesh, const Hold& hold) {
  const double radius = std::min(6.4, (hold.x1 - hold.x0) * 0.5 - 0.8), middle = kTankTop + 8.0;
  for (const double y : {-6.9, 6.9}) {
    const std::string name = hold.name() + (y < 0 ? " starboard" : " port") + " sphere";
    mesh.place({.origin = {hold.middle(), y, 0.0}});
    mesh.startObject(name, id(Paint::kTank));
    mesh.lathe(halfCircle(radius, middle, 18), 36);
    mesh.startObject(name + " skirt", id(Paint::kBulkhead));
    const double r = 0.85 * radius, top = middle - 0.5 * radius;
    mesh.lathe(
        std::array<Point2, 5>{
            {{r - 0.15, kTankTop}, {r, kTankTop}, {r, top}, {r - 0.15, top}, {r - 0.15, kTankTop}}},
        32);
    mesh.startObject(name + " pump tower", id(Paint::kPipe));
    addCylinder(mesh, {}, {hold.middle(), y, middle + radius - 0.2}, 2, 0.5,
                kMainDeck - kSlab - middle - radius);
  }
}

// Six horizontal cylinders with round ends, in two layers.
void addCylinders(MeshBuilder& mesh, const Hold& hold) {
  constexpr double kRadius = 3.2;
  const double dome = 1.5, length = hold.x1 - hold.x0 - 2.0;
  std::vector<Point2> profile;
  for (std::uint32_t i = 0; i <= 4; ++i) {
    const Point2 d = unitVector(0.25 * i / 4.0);
    profile.push_back({i == 0 ? 0.0 : kRadius * d.y, dome - dome * d.x});
  }
  for (std::size_t i = profile.size(); i-- > 0;) {
    profile.push_back({profile[i].x, length - profile[i].y});
  }
  for (std::uint32_t i = 0; i < 6; ++i) {
    const double y = -8.5 + 8.5 * (i % 3), z = kTankTop + (i < 3 ? 4.0 : 11.5);
    const std::string name = hold.name() + " cylinder " + std::to_string(i);
    mesh.place(standingAlong({}, {hold.x0 + 1.0, y, z}, 0));
    mesh.startObject(name, id(Paint::kTank));
    mesh.lathe(profile, 28);
    mesh.place({});
    for (const double part : {0.25, 0.75}) {
      const double x = hold.x0 + 1.0 + part * length;
      mesh.startObject(name + (part < 0.5 ? " saddle 0" : " saddle 1"), id(Paint::kBulkhead));
      mesh.box({x - 0.3, y - 2.0, z - 4.0 + (i < 3 ? 0.0 : -0.4)}, {x + 0.3, y + 2.0, z - 2.0});
    }
  }
}

// Two thick walls along the hold, which make three tanks, with a ladder and a pump in each.
void addWalledTanks(MeshBuilder& mesh, const Hold& hold) {
  const double top = kMainDeck - kSlab;
  mesh.place({});
  for (const double y : {-5.0, 5.0}) {
    mesh.startObject(hold.name() + (y < 0 ? " starboard" : " port") + " tank wall", id(Paint::kBulkhead));
    mesh.box({hold.x0, y - 0.3, kTankTop}, {hold.x1, y + 0.3, top});
  }
  for (std::uint32_t i = 0; i < 3; ++i) {
    const double y = -9.0 + 9.0 * i, x = hold.x0;
    const std::string name = hold.name() + " tank " + std::to_string(i);
    mesh.startObject(name + " ladder", id(Paint::kRail));
    mesh.box({x + 0.1, y - 0.3, kTankTop}, {x + 0.15, y - 0.25, top});
    mesh.box({x + 0.1, y + 0.25, kTankTop}, {x + 0.15, y + 0.3, top});
    for (double z = kTankTop + 0.3; z < top; z += 0.4) {
      mesh.box({x + 0.11, y - 0.25, z}, {x + 0.14, y + 0.25, z + 0.03});
    }
    mesh.startObject(name + " suction", id(Paint::kPipe));
    addTube(mesh,
            std::array<Vec3d, 3>{
                {{hold.x1 - 3, y, kTankTop + 0.5}, {hold.x1 - 1, y, kTankTop + 0.5}, {hold.x1 - 1, y, top}}},
            0.25, 16);
    mesh.startObject(name + " pump", id(Paint::kMachine));
    mesh.box({hold.x1 - 4, y - 0.5, kTankTop}, {hold.x1 - 3, y + 0.5, kTankTop + 1.2});
  }
}

// Adds a pipe along the deck with an expansion bend to one side, and the feet below it.
void addDeckPipe(MeshBuilder& mesh, const Hold& hold, std::uint32_t number, Random& random) {
  const double y = -2.8 + 0.8 * number, z = kMainDeck + 0.8, radius = random.range(0.12, 0.2);
  const double bend = hold.x0 + 3.0 + 0.5 * (number % 3), up = 0.5 + 0.2 * number;
  const std::string name = "deck pipe " + std::to_string(number) + " section " + std::to_string(hold.number);
  mesh.place({});
  mesh.startObject(name, id(number % 4 == 0 ? Paint::kRedPipe : Paint::kPipe));
  const Vec3d corners[] = {{hold.x0, y, z},         {bend, y, z},       {bend, y, z + up},
                           {bend + 1.5, y, z + up}, {bend + 1.5, y, z}, {hold.x1 + 0.45, y, z}};
  addTube(mesh, corners, radius, 10);
  mesh.startObject(name + " valve", id(Paint::kMachine));
  addCylinder(mesh, {}, {hold.x1 - 2.0, y, z + radius - 0.02}, 2, 0.08, 0.4, 8);
}

void addHatch(MeshBuilder& mesh, const Hold& hold, double y) {
  const std::string name = hold.name() + (y < 0 ? " starboard" : " port");
  mesh.place({.origin = {hold.middle(), y, kMainDeck}});
  mesh.startObject(name + " hatch", id(Paint::kTank));
  mesh.lathe(std::array<Point2, 6>{{{0, 0}, {1.2, 0}, {1.2, 0.6}, {1.0, 0.9}, {0.5, 1.05}, {0, 1.1}}}, 24);
  mesh.place({.origin = {hold.middle() + 3.0, y, kMainDeck}});
  mesh.startObject(name + " vent", id(Paint::kRedPipe));
  mesh.lathe(std::array<Point2, 6>{{{0, 0}, {0.15, 0}, {0.15, 2.0}, {0.35, 2.2}, {0.35, 2.5}, {0, 2.7}}}, 16);
  mesh.place({});
  mesh.startObject(name + " deck box", id(Paint::kMachine));
  mesh.box({hold.x0 + 1, y - 0.6, kMainDeck}, {hold.x0 + 3, y + 0.6, kMainDeck + 1.1});
}

// Adds the manifold across the deck at the middle hold, where hoses are attached.
void addManifold(MeshBuilder& mesh, const Hold& hold) {
  for (std::uint32_t i = 0; i < 6; ++i) {
    const double x = hold.middle() - 2.5 + i, z = kMainDeck + 0.35;
    mesh.startObject("manifold " + std::to_string(i), id(Paint::kRedPipe));
    const Vec3d corners[] = {{x, -12.5, z + 1.0}, {x, -11.5, z + 1.0}, {x, -11.5, z},
                             {x, 11.5, z},        {x, 11.5, z + 1.0},  {x, 12.5, z + 1.0}};
    addTube(mesh, corners, 0.2, 16);
  }
  const double x = hold.x0 + 1.0;
  mesh.startObject("crane post", id(Paint::kRail));
  addCylinder(mesh, {}, {x, 4.8, kMainDeck}, 2, 0.6, 9.0, 20);
  mesh.place({});
  mesh.startObject("crane jib", id(Paint::kRail));
  mesh.box({x - 0.4, 4.5, kMainDeck + 9.0}, {x + 12.0, 5.1, kMainDeck + 9.8});
}

void addWinches(MeshBuilder& mesh) {
  for (const double x : {3.0, 160.0, 166.0}) {
    for (const double y : {-4.0, 4.0}) {
      const std::string name =
          "winch " + std::to_string(static_cast<int>(x)) + (y < 0 ? " starboard" : " port");
      mesh.place({});
      mesh.startObject(name + " base", id(Paint::kMachine));
      mesh.box({x - 1.0, y - 1.2, kMainDeck}, {x + 1.0, y + 1.2, kMainDeck + 0.3});
      mesh.startObject(name + " drum", id(Paint::kEngine));
      addCylinder(mesh, {}, {x, y - 1.0, kMainDeck + 0.95}, 1, 0.6, 2.0, 24);
    }
  }
}

}  // namespace

void addHolds(MeshBuilder& mesh, const Plan& plan, Random random) {
  const std::uint32_t first = random.below(3);
  for (std::uint32_t number = 0; number < kHolds; ++number) {
    const Hold hold = holdAt(plan, number);
    switch ((number + first) % 3) {
      case 0:
        addSpheres(mesh, hold);
        break;
      case 1:
        addCylinders(mesh, hold);
        break;
      default:
        addWalledTanks(mesh, hold);
    }
  }
}

void addDeckGear(MeshBuilder& mesh, const Plan& plan, Random random) {
  for (std::uint32_t number = 0; number < kHolds; ++number) {
    const Hold hold = holdAt(plan, number);
    for (std::uint32_t pipe = 0; pipe < 8; ++pipe) {
      addDeckPipe(mesh, hold, pipe, random);
    }
    mesh.place({});
    for (std::uint32_t foot = 0; foot < 4; ++foot) {
      const double x = hold.x0 + (hold.x1 - hold.x0) * (foot + 0.5) / 4.0;
      mesh.startObject("deck pipe support " + std::to_string(4 * number + foot), id(Paint::kBulkhead));
      mesh.box({x - 0.1, -3.4, kMainDeck}, {x + 0.1, 3.4, kMainDeck + 0.62});
    }
    addHatch(mesh, hold, -8.0);
    addHatch(mesh, hold, 8.0);
  }
  mesh.place({});
  addManifold(mesh, holdAt(plan, kHolds / 2));
  addWinches(mesh);
}

}  // namespace sightline::scenes::ship
