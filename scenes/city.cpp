// The city: quarters on a near-square grid, their surroundings, and the camera paths.

#include <cmath>

#include "scenes/city_quarter.h"
#include "scenes/procedural.h"

namespace sightline {
namespace scenes {
namespace {

CityPlan planCity(const CityOptions& options) {
  CityPlan plan;
  while (plan.columns * plan.columns < options.copies) {
    ++plan.columns;
  }
  plan.rows = (options.copies + plan.columns - 1) / plan.columns;
  const std::uint32_t middle = (plan.rows - 1) / 2 * plan.columns + (plan.columns - 1) / 2;
  const QuarterPlan quarter = planQuarter(options.seed, middle, plan.columns);
  for (std::uint32_t i = 0; i < 4; ++i) {
    if (quarter.blocks[i] == BlockKind::kCourtyard) {
      plan.courtyard = Point2{quarter.corner.origin.x, quarter.corner.origin.y} + blockCorner(i) +
                       Point2{kBlock / 2, kBlock / 2};
    }
  }
  plan.far = length(Point2{plan.columns * kQuarter, plan.rows * kQuarter}) + 300.0;
  return plan;
}

// Adds meadows around the city, so that its streets end at a horizon.
void addSurroundings(MeshBuilder& mesh, const CityPlan& plan) {
  constexpr double kWidth = 100.0;
  const Rectangle city{{0, 0}, {plan.columns * kQuarter, plan.rows * kQuarter}};
  mesh.place({});
  mesh.startObject("surroundings", id(CityMaterial::kGrass));
  mesh.ring(outset(corners(city), kWidth), corners(city), -0.1, -0.05, kTop);
}

}  // namespace
}  // namespace scenes

Scene makeCity(const CityOptions& options) {
  using namespace scenes;
  Scene scene;
  scene.materials = cityMaterials();
  const CityPlan plan = planCity(options);
  scene.indices.reserve(options.copies * std::size_t{kQuarterTriangles} * 3 + 1024);
  {
    MeshBuilder mesh(scene);
    addSurroundings(mesh, plan);
    for (std::uint32_t i = 0; i < options.copies; ++i) {
      addQuarter(mesh, planQuarter(options.seed, i, plan.columns));
    }
  }
  weldPositions(scene);
  updateBounds(scene);
  scene.paths = cityWalks(plan);
  return scene;
}

}  // namespace sightline
