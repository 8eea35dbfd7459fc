#pragma once

// A rock tower: a closed connected mesh with ledges. Plan space.

#include <cstdint>

#include "scenes/mesh_builder.h"

namespace sightline::scenes {

struct Butte {
  Point2 middle;
  double radius = 15.0, height = 50.0;  // metres; the radius is that of the foot, on average
  double foot = 0.0;                    // height of the lowest ground around it
  std::uint64_t seed = 0;

  // The surface at a direction, as a fraction of a full turn, and a part of the height, 0 (below the ground)
  // to 1 (the top).
  Vec3d at(double turns, double part) const;
  // Unit vector off the rock.
  Vec3d normal(double turns, double part) const;
  // Maximum distance of its surface from its axis, metres.
  double reach() const { return 1.5 * radius; }
};
void addButte(MeshBuilder& mesh, const Butte& butte);

}  // namespace sightline::scenes
