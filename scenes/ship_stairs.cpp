// The stairwell: two flights and a landing in each storey from the engine room to the uppermost deck.

#include "scenes/ship_parts.h"
#include "scenes/stairs.h"

namespace sightline::scenes::ship {
namespace {

constexpr std::uint32_t kRisers = 10;  // per flight
constexpr double kRise = kStorey / (2 * kRisers);
constexpr double kTread = (kStairLanding - kStairFoot) / (kRisers - 1);
constexpr double kRun = kTread * (kRisers - 1);
constexpr double kFlightWidth = 2.0, kHalfWidth = kFlightWidth * 0.5;

// The flight rises along x from the placement's origin; its width is along z, with a rail on both sides.
void addFlight(MeshBuilder& mesh, const Placement& at, const std::string& name) {
  const double top = kRise * (kRisers - 1);
  mesh.place(at);
  mesh.startObject(name, id(Paint::kStairs));
  mesh.prism(flightProfile(kRisers, kRise, kTread), 0.0, kFlightWidth);
  for (const double z : {0.02, kFlightWidth - 0.07}) {
    const std::string rail = name + (z < 1.0 ? " rail 0" : " rail 1");
    const Point2 outline[] = {{0, 0.95}, {kRun, top + 0.95}, {kRun, top + 1.02}, {0, 1.02}};
    mesh.startObject(rail, id(Paint::kRail));
    mesh.prism(outline, z, z + 0.05);
    mesh.startObject(rail + " posts", id(Paint::kRail));
    for (std::uint32_t i = 0; i < 5; ++i) {
      const double x = 0.1 + i * 2 * kTread, foot = kRise * (2 * i + 1);
      mesh.box({x, foot, z + 0.01}, {x + 0.03, foot + 0.9, z + 0.04});
    }
  }
}

void addStorey(MeshBuilder& mesh, double bay, double z, const std::string& name) {
  const double half = kInnerWall * 0.5, middle = z + kStorey * 0.5;
  const Placement up{{bay + kStairUp - kHalfWidth, kStairFoot, z}, {0, 1, 0}, {0, 0, 1}, {1, 0, 0}};
  addFlight(mesh, up, name + " lower flight");
  const Placement on{{bay + kStairOn + kHalfWidth, kStairLanding, middle}, {0, -1, 0}, {0, 0, 1}, {-1, 0, 0}};
  addFlight(mesh, on, name + " upper flight");
  mesh.place({});
  mesh.startObject(name + " landing", id(Paint::kStairs));
  mesh.box({bay + half, kStairLanding, middle - 0.1875}, {bay + kStairBay - half, kBlockHalf, middle});
}

}  // namespace

void addStairs(MeshBuilder& mesh, const Plan& plan) {
  const double bay = plan.bayStart(plan.stairBay());
  for (std::uint32_t storey = 0; storey + 1 < kEngineStoreys + plan.decks; ++storey) {
    addStorey(mesh, bay, kTankTop + storey * kStorey, "stairs " + std::to_string(storey));
  }
  const double top = deckHeight(plan.decks - 1);
  mesh.startObject("stairs guard", id(Paint::kRail));
  mesh.box({bay + 0.1, kStairFoot - 0.1, top}, {bay + kStairUp + kHalfWidth, kStairFoot - 0.05, top + 1.0});
  for (std::uint32_t storey = 1; storey < kEngineStoreys; ++storey) {
    const double z = kTankTop + storey * kStorey;
    mesh.startObject("engine room platform " + std::to_string(storey), id(Paint::kFloor));
    mesh.box({bay, kCorridorHalf, z - 0.125}, {bay + kStairBay, kStairFoot, z});
    mesh.startObject("engine room platform rail " + std::to_string(storey), id(Paint::kRail));
    mesh.box({bay, kCorridorHalf + 0.02, z + 0.95}, {bay + kStairBay, kCorridorHalf + 0.07, z + 1.02});
  }
  for (const double x : {bay + 0.125, bay + kStairBay - 0.375}) {
    mesh.startObject("stairs pillar " + std::to_string(x < bay + 1 ? 0 : 1), id(Paint::kBulkhead));
    mesh.box({x, kBlockHalf + 0.0625, kTankTop}, {x + 0.25, kBlockHalf + 0.25, deckHeight(0) - kSlab});
  }
}

}  // namespace sightline::scenes::ship
