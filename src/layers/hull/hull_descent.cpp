// Why going uphill along edges is safe.
//
// The vertices and edges are exactly those of a convex polyhedron. So at a vertex p with neighbours q, any
// point x of it is x = p + sum l_q (q - p) with l_q >= 0. Let D be the direction asked for and d a bound of
// the error of a dot product D . v. If the computed heights of all neighbours are at most that of p, then D .
// (q - p) <= 2 d, and
//
//   D . x <= D . p + 2 d sum l_q.
//
// Let n be a unit vector along which p is higher than each neighbour by at least h > 0, and higher than any
// point of the polyhedron by at most w. Then
//
//   w >= n . (p - x) = sum l_q n . (p - q) >= h sum l_q,
//
// so sum l_q <= w / h. The factor is the greatest w / h of all vertices; n is about the mean of the normals
// at p.

#include "src/layers/hull/hull_descent.h"

#include <algorithm>

namespace sightline::layers {
namespace {

constexpr double kMaxFactor = 1e6;
// Up to this many vertices, w is the greatest drop to any vertex; above, the diameter of a ball around the
// hull.
constexpr std::size_t kMeasureDrops = 2048;

double minDrop(const ConvexHull& hull, std::uint32_t p, const Vec3d& n) {
  if (hull.first_neighbour[p + 1] - hull.first_neighbour[p] < 3) {
    return 0.0;  // not a vertex of a solid, so there is no bound
  }
  double min_drop = 1e300;
  for (std::uint32_t i = hull.first_neighbour[p]; i < hull.first_neighbour[p + 1]; ++i) {
    const Vec3d fall = hull.vertices[p] - hull.vertices[hull.neighbours[i]];
    min_drop = std::min(min_drop, dot(n, fall) - 0x1p-49 * length(fall));
  }
  return min_drop;
}

double maxDrop(const ConvexHull& hull, std::uint32_t p, const Vec3d& n, double diameter) {
  if (hull.vertices.size() > kMeasureDrops) {
    return diameter;
  }
  double max_drop = 0.0;
  for (const Vec3d& v : hull.vertices) {
    max_drop = std::max(max_drop, dot(n, hull.vertices[p] - v));
  }
  return max_drop + 0x1p-49 * diameter;
}

}  // namespace

double descentFactor(const ConvexHull& hull, std::span<const Vec3d> outwards) {
  double reach = 0.0;
  for (const Vec3d& v : hull.vertices) {
    reach = std::max(reach, length(v - hull.vertices[0]));
  }
  double factor = 0.0;
  for (std::uint32_t p = 0; p < hull.vertices.size(); ++p) {
    const Vec3d n = normalized(outwards[p]);
    const double min_drop = minDrop(hull, p, n);
    const double max_drop = maxDrop(hull, p, n, 2.0 * reach);
    if (!(min_drop > 0.0) || !(max_drop <= kMaxFactor * min_drop)) {
      return 0.0;
    }
    factor = std::max(factor, 1.001 * max_drop / min_drop);
  }
  return factor;
}

}  // namespace sightline::layers
