#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "src/layers/hull/hull_mesh.h"

namespace sightline::layers {

// About the farthest point outside a mesh, a facet that it is above, and a bound of its distance.
struct HullExcess {
  std::uint32_t point = 0, facet = 0;
  double distance = 0.0;  // bound of the distance of any point; 0: all are inside or on the surface
};

// Finds the farthest point outside. inside: a point strictly behind all facets.
HullExcess hullExcess(const HullMesh& mesh, std::span<const Vec3d> points, const Vec3d& inside);

// Whether a point is strictly behind all facets; exact.
bool strictlyInside(const HullMesh& mesh, const Vec3d& point);

}  // namespace sightline::layers
