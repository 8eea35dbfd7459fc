// The stairs: two flights with a landing between them in each storey except the last.

#include "scenes/building_parts.h"
#include "scenes/stairs.h"

namespace sightline::scenes {
namespace {

constexpr std::uint32_t kRisers = 10;  // per flight
constexpr double kRise = kStorey / (2 * kRisers), kTread = 0.3;
constexpr double kRun = kTread * (kRisers - 1);
constexpr double kWidth = 2.0;

// The flight starts at the placement's origin and rises along its x axis; its width is along z.
void addFlight(MeshBuilder& mesh, const Placement& at, double rail_z, const std::string& name) {
  mesh.place(at);
  mesh.startObject(name, id(BuildingMaterial::kStairs));
  mesh.prism(flightProfile(kRisers, kRise, kTread), 0.0, kWidth);
  mesh.startObject(name + " rail", id(BuildingMaterial::kRail));
  const double top = kRise * (kRisers - 1);
  const Point2 rail[] = {{0, 0.95}, {kRun, top + 0.95}, {kRun, top + 1.02}, {0, 1.02}};
  mesh.prism(rail, rail_z, rail_z + 0.05);
  for (std::uint32_t i = 0; i < 5; ++i) {
    const double x = 0.1 + i * 2 * kTread, foot = kRise * (2 * i + 1);
    mesh.box({x, foot, rail_z + 0.01}, {x + 0.03, foot + 0.9, rail_z + 0.04}, kAllFaces & ~kBottom & ~kTop);
  }
}

}  // namespace

void addStairs(MeshBuilder& mesh, const BuildingPlan& plan) {
  const Rectangle well = plan.cell(kStairBay, 0);
  const double foot = well.max.y - 0.925, landing = foot - kRun;
  for (std::uint32_t floor = 0; floor + 1 < plan.floors; ++floor) {
    const double z = floorHeight(floor);
    const std::string name = "floor " + std::to_string(floor) + " stairs";
    const Placement up{{well.min.x + 0.25 + kWidth, foot, z}, {0, -1, 0}, {0, 0, 1}, {-1, 0, 0}};
    addFlight(mesh, up, 0.0, name + " lower flight");
    const Placement on{
        {well.max.x - 0.25 - kWidth, landing, z + kStorey / 2}, {0, 1, 0}, {0, 0, 1}, {1, 0, 0}};
    addFlight(mesh, on, 0.0, name + " upper flight");
    mesh.place({});
    mesh.startObject(name + " landing", id(BuildingMaterial::kStairs));
    mesh.box({well.min.x + kHalfWall, well.min.y + kHalfWall, z + kStorey / 2 - 0.2},
             {well.max.x - kHalfWall, landing, z + kStorey / 2});
  }
  if (plan.floors > 1) {
    const double z = floorHeight(plan.floors - 1);
    mesh.place({});
    mesh.startObject("stairs guard", id(BuildingMaterial::kRail));
    mesh.box({well.min.x + kHalfWall, foot + 0.02, z}, {well.min.x + 0.25 + kWidth, foot + 0.07, z + 1.0});
  }
}

}  // namespace sightline::scenes
