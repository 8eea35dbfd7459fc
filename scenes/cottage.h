#pragma once

// A house with a pitched roof. Its walls are a closed solid of several quads, which begins below the ground.

#include <cstdint>
#include <string>
#include <vector>

#include "scenes/mesh_builder.h"
#include "scenes/random.h"

namespace sightline::scenes {

struct CottageSurfaces {
  MaterialId wall{}, roof{}, stone{}, wood{}, window{};
};
struct Cottage {
  double length = 9.0, width = 7.0;  // metres; the ridge runs along the length
  double storey = 2.6;
  std::uint32_t storeys = 1;
  double pitch = 0.9;  // rise of the roof per metre
  double sunk = 2.0;   // metres that the walls go on below the floor
  CottageSurfaces surfaces{};

  double eaves() const { return storey * storeys + 0.2; }
  double ridge() const { return eaves() + pitch * width * 0.5; }
};
// Walls, roof, chimney, door, windows, shutters and doorstep, an object each. The placement's origin is the
// middle of the floor; the door is in the middle of the side towards -y.
void addCottage(MeshBuilder& mesh, const Placement& placement, const Cottage& cottage, Random& random,
                const std::string& name);

// A closed roof of two slabs over length by width, its underside at the eaves at height z. The ridge runs
// along x. Each slope is `pieces` quads.
void addRoofSlabs(MeshBuilder& mesh, double length, double width, double z, double pitch,
                  std::uint32_t pieces);

// Closed walls with gables under such a roof, from z0 to the eaves at z1, cut into quads at these places. The
// cuts must include both ends and be ascending.
struct WallCuts {
  std::vector<double> xs, ys, zs;
};
void addGabledWalls(MeshBuilder& mesh, const WallCuts& cuts, double pitch);

}  // namespace sightline::scenes
