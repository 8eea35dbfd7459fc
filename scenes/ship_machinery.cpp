// The engine room: main engine, galleries, and machines on the floor and on the galleries.

#include <utility>

#include "scenes/ship_parts.h"

namespace sightline::scenes::ship {
namespace {

constexpr double kEngineY = -4.0;  // y of its centre; the aisle beside it runs along y = 0
constexpr double kGalleryEdge = 2.0;

// Builds one machine of convex and other parts. It stands on z = 0, within 1 m in x and 0.9 m in y.
class Machine {
 public:
  Machine(MeshBuilder& mesh, const Placement& at, std::string name)
      : mesh_(mesh), at_(at), name_(std::move(name)) {}

  void pump(Random& random);
  void generator();
  void console();
  void vessel(Random& random);
  void cooler(Random& random);
  void switchboard(Random& random);

 private:
  void start(const char* part, Paint paint) {
    mesh_.startObject(name_ + " " + part + " " + std::to_string(count_++), id(paint));
    mesh_.place(at_);
  }
  void box(const char* part, Paint paint, const Vec3d& low, const Vec3d& high) {
    start(part, paint);
    mesh_.box(low, high);
  }
  void cylinder(const char* part, Paint paint, const Vec3d& foot, std::uint32_t axis, double radius,
                double length) {
    start(part, paint);
    addCylinder(mesh_, at_, foot, axis, radius, length, radius < 0.2 ? 10 : 16);
  }
  void tube(const char* part, std::span<const Vec3d> corners, double radius) {
    start(part, Paint::kPipe);
    addTube(mesh_, corners, radius, 10);
  }

  MeshBuilder& mesh_;
  Placement at_;
  std::string name_;
  std::uint32_t count_ = 0;
};

void Machine::pump(Random& random) {
  const double high = random.range(1.6, 2.4);
  box("base", Paint::kMetal, {-0.9, -0.4, 0}, {0.9, 0.4, 0.25});
  cylinder("motor", Paint::kMachine, {-0.85, 0, 0.6}, 0, 0.3, 0.9);
  start("casing", Paint::kEngine);
  mesh_.place(at_.moved({0.45, 0, 0.25}));
  mesh_.lathe(std::array<Point2, 6>{{{0, 0}, {0.35, 0}, {0.4, 0.3}, {0.35, 0.6}, {0.15, 0.75}, {0, 0.75}}},
              16);
  tube("suction", std::array<Vec3d, 3>{{{0.45, 0.2, 0.5}, {0.45, 0.75, 0.5}, {0.45, 0.75, 0.05}}}, 0.12);
  tube("delivery",
       std::array<Vec3d, 4>{{{0.45, 0, 0.9}, {0.45, 0, high}, {-0.7, 0, high}, {-0.7, 0.7, high}}}, 0.1);
}

void Machine::generator() {
  box("base", Paint::kMetal, {-1, -0.6, 0}, {1, 0.6, 0.2});
  box("block", Paint::kEngine, {-0.95, -0.45, 0.2}, {0.3, 0.45, 1.1});
  cylinder("alternator", Paint::kMachine, {0.32, 0, 0.75}, 0, 0.5, 0.65);
  for (std::uint32_t i = 0; i < 5; ++i) {
    cylinder("head", Paint::kMetal, {-0.82 + 0.24 * i, 0, 1.1}, 2, 0.1, 0.35);
  }
  tube("exhaust", std::array<Vec3d, 3>{{{-0.9, 0.3, 1.3}, {0.6, 0.3, 1.3}, {0.6, 0.3, 2.5}}}, 0.11);
}

void Machine::console() {
  start("desk", Paint::kConsole);
  mesh_.prism(
      std::array<Point2, 6>{{{-0.9, -0.8}, {0.9, -0.8}, {0.9, 0.8}, {0.3, 0.8}, {0.3, -0.2}, {-0.9, -0.2}}},
      0.0, 0.95);
  box("panel", Paint::kScreen, {-0.8, -0.75, 0.95}, {0.2, -0.65, 1.6});
  box("panel", Paint::kScreen, {0.75, -0.4, 0.95}, {0.85, 0.7, 1.6});
  for (std::uint32_t i = 0; i < 4; ++i) {
    cylinder("knob", Paint::kRedPipe, {-0.7 + 0.25 * i, -0.4, 0.95}, 2, 0.05, 0.06);
  }
}

void Machine::vessel(Random& random) {
  const double r = random.range(0.5, 0.75), high = random.range(1.7, 2.4);
  start("body", Paint::kTank);
  mesh_.lathe(std::array<Point2, 8>{{{0, 0.2},
                                     {0.6 * r, 0.25},
                                     {r, 0.5},
                                     {r, high - 0.3},
                                     {0.85 * r, high - 0.12},
                                     {0.5 * r, high - 0.03},
                                     {0.2 * r, high},
                                     {0, high}}},
              20);
  for (const double x : {-0.4, 0.3}) {
    box("foot", Paint::kMetal, {x, -0.4, 0}, {x + 0.1, 0.4, 0.45});
  }
  tube("pipe", std::array<Vec3d, 3>{{{r - 0.05, 0, 1.2}, {0.9, 0, 1.2}, {0.9, 0, 0.05}}}, 0.08);
}

void Machine::cooler(Random& random) {
  const double z = random.range(0.8, 1.3);
  cylinder("shell", Paint::kPipe, {-0.95, 0, z}, 0, 0.4, 1.9);
  for (const double x : {-0.65, 0.45}) {
    box("saddle", Paint::kMetal, {x, -0.35, 0}, {x + 0.2, 0.35, z - 0.25});
  }
  for (const double x : {-0.98, 0.9}) {
    cylinder("flange", Paint::kMachine, {x, 0, z}, 0, 0.47, 0.08);
  }
  tube("inlet",
       std::array<Vec3d, 4>{{{-0.5, 0, z + 0.3}, {-0.5, 0, 2.2}, {-0.5, 0.8, 2.2}, {-0.5, 0.8, 0.1}}}, 0.1);
  tube("outlet", std::array<Vec3d, 3>{{{0.6, 0, z + 0.3}, {0.6, 0, 1.9}, {0.6, -0.7, 1.9}}}, 0.1);
}

void Machine::switchboard(Random& random) {
  for (std::uint32_t i = 0; i < 3; ++i) {
    const double x = -0.95 + 0.64 * i;
    box("cabinet", Paint::kConsole, {x, -0.3, 0}, {x + 0.62, 0.5, random.range(1.6, 2.2)});
    box("door", Paint::kMetal, {x + 0.06, -0.33, 0.2}, {x + 0.56, -0.301, 1.4});
    cylinder("dial", Paint::kWhite, {x + 0.31, -0.36, 1.2}, 1, 0.12, 0.05);
  }
}

// The places where a machine may stand.
std::vector<Placement> places(const Plan& plan) {
  constexpr double kPitch = 2.5, kHalf = 1.1;
  const double bay = plan.bayStart(plan.stairBay());
  std::vector<Placement> list;
  for (double x = kBlockStart + 1.5; x + kHalf < plan.blockEnd(); x += kPitch) {
    if (x + kHalf > bay && x - kHalf < bay + kStairBay) {
      continue;
    }
    for (std::uint32_t storey = 0; storey < kEngineStoreys; ++storey) {
      for (const double y : {3.5, 6.1}) {
        list.push_back({.origin = {x, y, kTankTop + storey * kStorey}});
      }
    }
    list.push_back(Placement{.origin = {x, -7.2, kTankTop}}.turned(0.5));
  }
  return list;
}

void addMachine(MeshBuilder& mesh, const Placement& at, std::uint32_t number, Random random) {
  Machine machine(mesh, at, "machine " + std::to_string(number));
  switch (random.below(6)) {
    case 0:
      return machine.pump(random);
    case 1:
      return machine.generator();
    case 2:
      return machine.console();
    case 3:
      return machine.vessel(random);
    case 4:
      return machine.cooler(random);
    default:
      return machine.switchboard(random);
  }
}

void addCylinderOfEngine(MeshBuilder& mesh, double x, std::uint32_t number) {
  const std::string name = "main engine cylinder " + std::to_string(number);
  mesh.place({.origin = {x, kEngineY, kTankTop + 3.5}});
  mesh.startObject(name, id(Paint::kEngine));
  mesh.lathe(
      std::array<Point2, 8>{
          {{0, 0}, {0.85, 0}, {0.85, 1.4}, {0.95, 1.5}, {0.95, 1.8}, {0.5, 2.0}, {0.3, 2.4}, {0, 2.4}}},
      20);
  mesh.place({});
  mesh.startObject(name + " exhaust", id(Paint::kPipe));
  const double z = kTankTop + 5.2;
  addTube(
      mesh,
      std::array<Vec3d, 3>{{{x, kEngineY - 0.6, z}, {x, kEngineY - 1.6, z}, {x, kEngineY - 1.6, z + 1.0}}},
      0.25, 16);
  mesh.startObject(name + " fuel pump", id(Paint::kMachine));
  mesh.box({x - 0.3, kEngineY + 1.5, kTankTop + 2.0}, {x + 0.3, kEngineY + 1.9, kTankTop + 3.0});
}

void addMainEngine(MeshBuilder& mesh, const Plan& plan) {
  const double x0 = kBlockStart + 3.0, x1 = plan.blockEnd() - 4.0, z = kTankTop;
  mesh.place({});
  mesh.startObject("main engine bedplate", id(Paint::kMetal));
  mesh.box({x0, kEngineY - 1.9, z}, {x1, kEngineY + 1.9, z + 1.0});
  mesh.startObject("main engine frame", id(Paint::kEngine));
  mesh.box({x0 + 0.2, kEngineY - 1.5, z + 1.0}, {x1 - 0.2, kEngineY + 1.5, z + 3.5});
  mesh.startObject("main engine walkway", id(Paint::kFloor));
  mesh.box({x0, kEngineY + 1.92, z + 3.3}, {x1, kEngineY + 2.7, z + 3.4});
  mesh.startObject("propeller shaft", id(Paint::kMetal));
  addCylinder(mesh, {}, {kBlockStart - kOuterWall, kEngineY, z + 0.8}, 0, 0.35, 3.0 + kOuterWall, 20);
  mesh.startObject("main engine exhaust receiver", id(Paint::kPipe));
  addCylinder(mesh, {}, {x0 + 0.5, kEngineY - 1.6, z + 6.6}, 0, 0.55, x1 - x0 - 1.0, 24);
  const double uptake = plan.bayStart(plan.stairBay()) + kStairBay * 0.5, top = deckHeight(0) - kSlab;
  mesh.startObject("main engine uptake", id(Paint::kMetal));
  addCylinder(mesh, {}, {uptake, -kRoomStart - 2.0, z + 6.3}, 2, 0.8, top - z - 6.3, 24);
  const auto cylinders = static_cast<std::uint32_t>((x1 - x0 - 1.0) / 2.2);
  for (std::uint32_t i = 0; i < cylinders; ++i) {
    addCylinderOfEngine(mesh, x0 + 1.5 + 2.2 * i, i);
  }
}

void addGallery(MeshBuilder& mesh, double x0, double x1, double z, const std::string& name) {
  mesh.place({});
  mesh.startObject(name, id(Paint::kFloor));
  mesh.box({x0, kGalleryEdge, z - 0.125}, {x1, kBlockHalf, z});
  mesh.startObject(name + " rail", id(Paint::kRail));
  mesh.box({x0 + 0.01, kGalleryEdge + 0.02, z + 0.95}, {x1 - 0.01, kGalleryEdge + 0.07, z + 1.02});
  mesh.startObject(name + " rail posts", id(Paint::kRail));
  for (std::uint32_t i = 0; i < 4; ++i) {
    const double x = x0 + (x1 - x0) * (i + 0.5) / 4;
    mesh.box({x - 0.02, kGalleryEdge + 0.03, z}, {x + 0.02, kGalleryEdge + 0.06, z + 0.95});
  }
  mesh.startObject(name + " pillar", id(Paint::kBulkhead));
  mesh.box({x1 - 0.35, kGalleryEdge, z - kStorey}, {x1 - 0.15, kGalleryEdge + 0.2, z - 0.125});
}

void addGalleries(MeshBuilder& mesh, const Plan& plan) {
  for (std::uint32_t storey = 1; storey < kEngineStoreys; ++storey) {
    for (std::uint32_t bay = 0; bay < plan.bays(); ++bay) {
      if (bay != plan.stairBay()) {
        addGallery(mesh, plan.bayStart(bay), plan.bayStart(bay + 1), kTankTop + storey * kStorey,
                   "gallery " + std::to_string(storey) + "-" + std::to_string(bay));
      }
    }
  }
}

// Adds pipes along the engine room below its ceiling, each with a step down.
void addOverheadPipes(MeshBuilder& mesh, const Plan& plan, Random random) {
  const double x0 = kBlockStart, x1 = plan.blockEnd(), z = deckHeight(0) - 1.0;
  mesh.place({});
  for (std::uint32_t i = 0; i < 8; ++i) {
    const double y = -9.0 + 0.35 * i, x = random.range(x0 + 2.0, x1 - 2.0), down = random.range(0.4, 0.8);
    mesh.startObject("engine room pipe " + std::to_string(i),
                     id(i % 3 == 0 ? Paint::kRedPipe : Paint::kPipe));
    addTube(mesh, std::array<Vec3d, 4>{{{x0, y, z}, {x, y, z}, {x, y, z - down}, {x1, y, z - down}}},
            random.range(0.08, 0.15), 10);
  }
}

}  // namespace

void addMachinery(MeshBuilder& mesh, const Plan& plan, std::uint32_t machines, std::uint32_t seed) {
  addMainEngine(mesh, plan);
  addGalleries(mesh, plan);
  addOverheadPipes(mesh, plan, Random(seed, 5));
  std::vector<Placement> free = places(plan);
  Random random(seed, 6);
  for (std::uint32_t i = 0; i < machines && !free.empty(); ++i) {
    std::swap(free[random.below(static_cast<std::uint32_t>(free.size()))], free.back());
    addMachine(mesh, free.back(), i, Random(random.next()));
    free.pop_back();
  }
}

}  // namespace sightline::scenes::ship
