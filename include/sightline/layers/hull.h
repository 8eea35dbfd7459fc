#pragma once

// The convex polyhedron that stands for the geometry of a part in visibility sorting.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sightline/base/result.h"
#include "sightline/math/plane.h"
#include "sightline/math/vec3.h"

namespace sightline {

// The convex hull of some points; also of points that lie in a plane, on a line, or all in one place. In its
// own space; immutable, so that any number of parts may share it.
struct ConvexHull {
  int dimension = 0;              // 0 point, 1 segment, 2 flat polygon, 3 solid
  std::vector<Vec3d> vertices{};  // the extreme points, as given
  // The vertices at the other ends of vertex i's edges: neighbours[first_neighbour[i]] up to, not with,
  // neighbours[first_neighbour[i + 1]]; ascending. Edges of a solid are exact: triangles whose corners lie in
  // one plane without rounding have none between them.
  std::vector<std::uint32_t> first_neighbour{};  // vertices + 1
  std::vector<std::uint32_t> neighbours{};
  // Their coordinates, four neighbours after four (x of all four, then y, z), filled up with vertex i itself:
  // one step uphill reads them in a row. Of vertex i from 12 * first_quad[i] on.
  std::vector<std::uint32_t> first_quad{};  // vertices + 1
  std::vector<double> neighbour_quads{};
  // Of a solid: its faces' planes, unit normals outwards; the vertices lie behind each or on it. Moved
  // outwards by what rounding may have hidden. Triangles in one plane make one face. Otherwise empty.
  std::vector<Plane> faces{};
  // Of a solid: its surface, counter-clockwise seen from outside. Otherwise empty.
  std::vector<std::array<std::uint32_t, 3>> triangles{};
  Vec3d centre{};       // mean of the vertices
  double radius = 0.0;  // of the ball around the centre that holds all vertices, rounded up
  // No point that the hull was made of lies farther than this outside the convex hull of `vertices`: what
  // rounding left out. About 1e-14 of the size, or some last digits of the coordinates where they are larger.
  double slack = 0.0;
  // Going uphill along edges ends at the farthest vertex up to a height of this times rounding (relative to
  // the size). 0: not so, some vertex hardly stands out, or the hull is no solid; look at all vertices.
  double descent_factor = 0.0;
};

// Errors: no points, a coordinate that is not finite or is beyond 1e100, more than 2^24 points, or no memory.
// Vertices are in the order of the points. Source: Barber, Dobkin, Huhdanpaa. The Quickhull algorithm for
// convex hulls. ACM TOMS 1996 (Qhull does the solids).
Result<ConvexHull> buildHull(std::span<const Vec3d> points);

}  // namespace sightline
