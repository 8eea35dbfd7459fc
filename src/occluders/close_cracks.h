#pragma once

// Closes narrow cracks before triangles are conformed: boundaries that nearly meet are made to meet.

#include <compare>
#include <cstdint>
#include <span>
#include <vector>

#include "sightline/base/parallel_for.h"
#include "src/base/rows.h"
#include "src/occluders/conform.h"

namespace sightline::occluders {

// An edge of a mesh, in either direction.
struct MeshEdge {
  std::uint32_t low = 0, high = 0;  // vertices
  friend auto operator<=>(const MeshEdge&, const MeshEdge&) = default;
};
inline MeshEdge meshEdge(std::uint32_t a, std::uint32_t b) {
  return a < b ? MeshEdge{a, b} : MeshEdge{b, a};
}

struct ClosedCracks {
  std::vector<std::uint32_t> triangles;  // three vertices of the input each, by source
  std::vector<std::uint32_t> source;     // of each triangle: the one of the input that it comes from
  // What has collapsed to a line or a point, as triangles of which two corners or all are the same. With
  // these, all of a triangle of the input is where it was, within the slack.
  std::vector<std::uint32_t> collapsed, collapsed_source;
  // No point of a triangle of the input is farther than this from where it is now, metres; at most twice the
  // width.
  double slack = 0.0;
  std::uint64_t merged = 0;  // vertices that another one replaces
  std::uint64_t bent = 0;    // places at which an edge is led through a vertex
};

// Of vertices at edges that are left after cancelling, those closer to each other than `width` metres become
// one of them. Then such an edge is led through all such vertices that are closer to it. Vertices do not
// move, edges are bent and triangles with them; what is connected stays connected. Edges that cancel are not
// looked at, and neither are vertices beside a face, nor edges that more than 4,096 vertices lie beside. A
// line of sight through a crack that was closed is then taken to be blocked: the crack was narrower than
// twice the width. With a width of 0, or one that is not finite, nothing changes.
ClosedCracks closeCracks(const ConformInput& input, double width,
                         const ParallelFor& parallel_for = serialFor);

// The same for vertices that lie on edges exactly: nothing moves, and what triangles cover stays the same.
// open: by triangle, bit k if the edge from corner k to the next may be led through vertices of other such
// edges; the same for all triangles at an edge. Vertices with coordinates of 2^64 metres and more, or with
// bits below 2^-149 metres, are left alone.
ClosedCracks joinEdges(const ConformInput& input, std::span<const std::uint8_t> open,
                       const ParallelFor& parallel_for = serialFor);

// For each edge, the vertices of the others that lie on it exactly, between its ends, from its lower vertex
// on. edges: ascending, none twice. Of the same coordinates as above.
base::Rows<std::uint32_t> verticesOnEdges(std::span<const Vec3d> vertices, std::span<const MeshEdge> edges,
                                          const ParallelFor& parallel_for = serialFor);

// A vertex beside an edge, both left after cancelling.
struct NearMiss {
  std::uint32_t vertex = 0;
  double distance = 0.0;                                 // metres, above 0
  std::uint32_t vertex_triangle = 0, edge_triangle = 0;  // one that has the vertex, one that has the edge
};

// For each vertex that is left after cancelling, the nearest edge that is left and closer than `width`
// metres, if it is neither the vertex's own nor next to one of its own; none if the vertex lies on one
// exactly. In order of the vertices' places.
std::vector<NearMiss> findNearMisses(const ConformInput& input, double width,
                                     const ParallelFor& parallel_for = serialFor);

}  // namespace sightline::occluders
