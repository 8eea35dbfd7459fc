#pragma once

// Makes triangles that touch share edges: wherever two triangles meet, both are divided so that they meet in
// common vertices and common edges, or lie on each other as equal pieces. All decisions are exact.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sightline/base/parallel_for.h"
#include "sightline/math/vec3.h"

namespace sightline::occluders {

struct ConformInput {
  std::span<const Vec3d> vertices;           // metres; no two are equal
  std::span<const std::uint32_t> triangles;  // three vertices each
};

// What is divided. Each includes those before it.
enum class Divide : std::uint8_t {
  // Edges, at vertices that lie on them. No vertex is new, so nothing is rounded. It is all that surfaces of
  // whole triangles need, for which verticesOnEdges() and TriangleBender do the same faster: what of a
  // triangle's border cancels does not depend on how it is divided inside.
  kEdges,
  // Faces, where an edge or a vertex of another triangle lies in them, and overlaps.
  kFaces,
  // Faces that penetrate each other, along their common segment. In foliage this makes thousands of pieces
  // of what hides nothing.
  kPenetrations,
};

struct ConformSettings {
  Divide divide = Divide::kPenetrations;
  // Metres. If it is above 0, cracks that are narrower are closed first: see closeCracks(). What is promised
  // then holds of the triangles as that leaves them, and `slack` includes how far it moves them.
  double crack_width = 0.0;
  // Where a triangle has more contacts than this and segments among them, or its segments cross each other
  // more often, only its borders are divided: that is more than is worth the memory.
  std::size_t most_contacts = 65536;
};

// A point by what defines it: vertices and triangles of the input, or triangles that closeCracks() made of
// it.
struct PointName {
  enum class Kind : std::uint8_t {
    kVertex,        // vertex of[0]
    kLineAndPlane,  // where the line through vertices of[0] and of[1] meets the plane of triangle of[2]
    kLines,         // where that line meets the one through vertices of[2] and of[3], of the same plane
    kPlanes,        // where the planes of three triangles meet
  };
  Kind kind = Kind::kVertex;
  std::uint8_t axis = 0;  // kLines: the plane is not parallel to this axis
  std::uint32_t of[4] = {};

  friend auto operator<=>(const PointName&, const PointName&) = default;
};

// Pairs of triangles by how they meet, as far as they meet outside of common vertices and edges.
struct ContactCounts {
  std::uint64_t points = 0;          // in single points
  std::uint64_t edges_on_edges = 0;  // along parts of an edge of each
  std::uint64_t edges_in_faces = 0;  // an edge of one lies in the other
  std::uint64_t penetrations = 0;    // neither's edge runs along the common line
  std::uint64_t overlaps = 0;        // in one plane, with a common area
};

struct ConformedMesh {
  std::vector<Vec3d> vertices;           // those of the input, then the new ones
  std::vector<PointName> names;          // of the new ones
  std::vector<std::uint32_t> triangles;  // three vertices each, by source
  std::vector<std::uint32_t> source;     // of each triangle: the one of the input that it is a piece of
  // No point of a piece is farther than this from where it would be without rounding, metres. New vertices
  // are computed exactly and then rounded to double precision.
  double slack = 0.0;
  std::uint32_t degenerate = 0;  // triangles without area, which are left out
  std::uint32_t untouched = 0;   // triangles passed on without a look at their contacts: see conform()
  std::uint32_t divided = 0;     // triangles of the input that have several pieces, or new vertices
  // Divided triangles of which only the borders are: see ConformSettings::most_contacts.
  std::uint32_t overfull = 0;
  ContactCounts contacts;
};

// The pieces of a triangle cover it exactly, without overlap, and face as it does; a triangle that touches
// others only in common vertices and edges is its own only piece. No vertex lies inside an edge or a face,
// and no edge crosses another or a face, before new vertices are rounded and as far as
// ConformSettings::divide says. What this promises of lines of sight, and what `slack` is for:
// docs/conservative.md, "Contacts". Triangles without area are left out: divided at their corners, their
// three edges cancel each other. A triangle with coordinates that are not finite, of 2^64 metres and more, or
// with bits below 2^-149 metres is passed on and divides no other. The result does not depend on the threads,
// and but for numbers not on the order of the input either.
ConformedMesh conform(const ConformInput& input, const ConformSettings& settings = {},
                      const ParallelFor& parallel_for = serialFor);

}  // namespace sightline::occluders
