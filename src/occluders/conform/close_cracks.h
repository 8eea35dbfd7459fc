#pragma once

// Closes narrow cracks before triangles are conformed: boundaries that nearly meet are made to meet.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/base/parallel_for.h"
#include "src/occluders/conform/bend_triangles.h"
#include "src/occluders/conform/conform.h"

namespace sightline::occluders {

struct ClosedCracks : BentTriangles {
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
// twice the width. With a width below 2^-149, by which numbers of single precision differ at least, or one
// that is not finite, nothing changes.
ClosedCracks closeCracks(const ConformInput& input, double width,
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
