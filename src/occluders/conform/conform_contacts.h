#pragma once

// How two triangles meet, exactly.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "src/geometry/exact_point.h"
#include "src/occluders/conform/conform.h"

namespace sightline::occluders {

// What is conformed, with the lattice of its coordinates.
struct ConformScene {
  std::span<const Vec3d> vertices;
  std::span<const std::uint32_t> triangles;
  geometry::Lattice lattice;

  const std::uint32_t* corners(std::uint32_t triangle) const { return &triangles[std::size_t{3} * triangle]; }
  geometry::PlanePoints planeOf(std::uint32_t triangle) const {
    const std::uint32_t* corner = corners(triangle);
    return {vertices[corner[0]], vertices[corner[1]], vertices[corner[2]]};
  }
};

// Where a point lies in a triangle: bit k for edge k, which goes from corner k to the next one. So a corner
// has two bits, and a point inside none.
using Borders = std::uint8_t;
inline constexpr Borders kBordersOfCorner[3] = {0b101, 0b011, 0b110};

// A point of a triangle, or a segment across it, that it has in common with another triangle.
struct Contact {
  enum class Kind : std::uint8_t {
    kPoint,       // ends[0] alone
    kAlongPlane,  // in the plane of triangle along[0]
    kAlongEdge,   // on the line through vertices along[0] and along[1], which lies in the triangle's plane
  };
  std::uint32_t triangle = 0;
  Kind kind = Kind::kPoint;
  std::array<Borders, 2> borders{};
  std::array<PointName, 2> ends{};
  std::array<std::uint32_t, 2> along{};
};

// Whether a triangle has an area.
bool hasArea(const ConformScene& scene, std::uint32_t triangle);

// Adds what each of two triangles with areas has in common with the other, beyond its own corners and parts
// of its own edges between them. Contacts along an edge of the triangle are points: the ends of the common
// part.
void addContacts(const ConformScene& scene, const ConformSettings& settings, std::uint32_t a, std::uint32_t b,
                 std::vector<Contact>& contacts, ContactCounts& counts);

}  // namespace sightline::occluders
