#pragma once

#include <optional>
#include <span>

#include "src/io/corner_order.h"
#include "src/io/gltf/gltf_primitives.h"

namespace sightline::io {

// Says where the triangles of one object are placed.
struct Placement {
  Mat4 world_from_node;                     // or from an instance of its mesh
  std::span<const ActiveTarget> targets{};  // morph targets that displace its vertices
  std::span<const Mat4> joints{};           // of its skin, as Skins::open() makes them; empty: it has none
  std::optional<std::uint64_t> instance{};
  CornerOrder order = CornerOrder::kKept;
  std::size_t node = 0;  // its number, in errors
};

// The world position of a vertex. Precondition: index < positions->count().
Result<Vec3d> placeVertex(const Document& document, const PrimitiveSource& source, const Placement& placement,
                          std::uint64_t index);

}  // namespace sightline::io
