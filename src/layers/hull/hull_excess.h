#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "src/layers/hull/hull_mesh.h"

namespace sightline::layers {

// The point that is farthest outside a mesh, about: how far at most, and a facet that it is above.
struct HullExcess {
  std::uint32_t point = 0, facet = 0;
  double distance = 0.0;  // no point is farther outside; 0: all are inside or on the surface
};

// inside: a point strictly behind all facets.
HullExcess hullExcess(const HullMesh& mesh, std::span<const Vec3d> points, const Vec3d& inside);

// Whether a point is strictly behind all facets. Exact.
bool strictlyInside(const HullMesh& mesh, const Vec3d& point);

}  // namespace sightline::layers
