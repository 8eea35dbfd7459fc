// Solids that the ship is made of.

#include "scenes/ship_parts.h"

namespace sightline::scenes::ship {

void addHexahedron(MeshBuilder& mesh, const std::array<Vec3d, 8>& c) {
  mesh.quad(c[0], c[4], c[6], c[2]);
  mesh.quad(c[1], c[3], c[7], c[5]);
  mesh.quad(c[0], c[1], c[5], c[4]);
  mesh.quad(c[2], c[6], c[7], c[3]);
  mesh.quad(c[0], c[2], c[3], c[1]);
  mesh.quad(c[4], c[5], c[7], c[6]);
}

void addWall(MeshBuilder& mesh, const Wall& wall) {
  std::uint32_t count = 0;
  mesh.place(wall.at);
  const auto piece = [&](double x0, double x1, double z0, double z1) {
    if (x0 < x1 && z0 < z1) {
      mesh.startObject(wall.name + " " + std::to_string(count++), id(wall.paint));
      mesh.box({x0, 0, z0}, {x1, wall.thickness, z1});
    }
  };
  double x = 0.0;
  for (const Rectangle& opening : wall.openings) {
    piece(x, opening.min.x, 0.0, wall.height);
    piece(opening.min.x, opening.max.x, 0.0, opening.min.y);
    piece(opening.min.x, opening.max.x, opening.max.y, wall.height);
    x = opening.max.x;
  }
  piece(x, wall.length, 0.0, wall.height);
}

}  // namespace sightline::scenes::ship
