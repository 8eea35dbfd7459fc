// The ship: hull, holds, the block with its rooms and stairs, the engine room, and the camera paths.

#include "scenes/procedural.h"
#include "scenes/ship_parts.h"

namespace sightline {

Scene makeShip(const ShipOptions& options) {
  using namespace scenes;
  const ship::Plan plan{.decks = options.decks, .rooms = options.rooms};
  Scene scene;
  scene.materials = ship::materials();
  {
    MeshBuilder mesh(scene);
    ship::addHull(mesh, plan);
    ship::addHolds(mesh, plan, Random(options.seed, 1));
    ship::addDeckGear(mesh, plan, Random(options.seed, 2));
    ship::addDecks(mesh, plan, options.seed);
    ship::addStairs(mesh, plan);
    ship::addMachinery(mesh, plan, options.machinery, options.seed);
  }
  weldPositions(scene);
  updateBounds(scene);
  scene.paths = {ship::walk(plan), ship::randomViews(plan, scene, Random(options.seed, 3))};
  return scene;
}

}  // namespace sightline
