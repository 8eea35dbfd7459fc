#pragma once

// The convex polyhedron that stands for the geometry of a part in visibility sorting.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sightline/base/result.h"
#include "sightline/math/mat4.h"
#include "sightline/math/plane.h"
#include "sightline/math/vec3.h"

namespace sightline {

// The convex hull of some points, which may also lie in a plane, on a line, or all in one place. The hull has
// a space of its own and does not change, so any number of parts may share it.
struct ConvexHull {
  int dimension = 0;              // 0 point, 1 segment, 2 flat polygon, 3 solid
  std::vector<Vec3d> vertices{};  // the extreme points, as given
  // The edges of vertex i lead to neighbours[first_neighbour[i]] up to, but not including,
  // neighbours[first_neighbour[i + 1]], ascending. Edges of a solid are exact: triangles whose corners lie in
  // one plane without rounding have no edge between them.
  std::vector<std::uint32_t> first_neighbour{};  // vertices + 1
  std::vector<std::uint32_t> neighbours{};
  // The neighbours' coordinates in groups of four (four x, four y, four z), so that one step uphill reads
  // them in a row. Those of vertex i begin at 12 * first_quad[i]; vertex i itself fills up the last group.
  std::vector<std::uint32_t> first_quad{};  // vertices + 1
  std::vector<double> neighbour_quads{};
  // The planes of a solid's faces, with outward unit normals; empty for other hulls. All vertices lie behind
  // or on each plane, which is moved outwards by the rounding error. Triangles in one plane make one face.
  std::vector<Plane> faces{};
  // A solid's surface, counter-clockwise seen from outside; empty for other hulls.
  std::vector<std::array<std::uint32_t, 3>> triangles{};
  Vec3d centre{};       // mean of the vertices
  double radius = 0.0;  // radius of the ball around the centre that holds all vertices, rounded up
  // No input point lies farther than this outside the convex hull of `vertices`, which rounding may have made
  // too small. It is about 1e-14 of the size, or a few last digits of larger coordinates.
  double slack = 0.0;
  // A search that goes uphill along edges ends within this times the rounding error of the greatest height.
  // 0: no such bound exists (a vertex hardly stands out, or the hull is no solid), so all vertices are
  // compared.
  double descent_factor = 0.0;
  // A hull with many vertices has the farthest vertex along a direction of each of 96 ranges here, from which
  // searches go uphill that know no better one, and the sizes of the box by which directions are divided into
  // ranges. They are empty for other hulls.
  std::vector<std::uint32_t> starts{};
  Vec3d start_size{};
};

// Builds the convex hull; vertices are in the order of the points. Solids are made by Qhull.
// The time grows faster than the number of vertices does, and fastest where one face has many of them: of a
// sphere, 4,000 vertices take 0.15 s and 8,000 0.5 s; of a cylinder, half of them around each end, 0.7 s and
// 4 s.
// Errors: no points, a coordinate that is not finite or is beyond 1e100, more than 2^24 points, or no memory.
// Source: Barber, Dobkin, Huhdanpaa. The Quickhull algorithm for convex hulls. ACM TOMS 1996.
Result<ConvexHull> buildHull(std::span<const Vec3d> points);

// Builds the convex hull, in world space, of all places of a hull whose transform goes evenly from one affine
// transform to another: at the share t of the way it is from * (1 - t) + to * t, so that every point moves
// along a line. Something that turns does not move so: take it from one angle to the next in steps, and the
// hull of the steps' vertices.
// Errors: those of buildHull().
Result<ConvexHull> sweptHull(const ConvexHull& hull, const Mat4& world_from_first,
                             const Mat4& world_from_last);

}  // namespace sightline
