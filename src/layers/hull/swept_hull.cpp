#include <algorithm>

#include "sightline/geometry/tolerance.h"
#include "sightline/layers/hull.h"
#include "src/layers/pairs/placement.h"

namespace sightline {

// At the share t a point p is at (1 - t) A p + t B p, on the segment between its first and its last place. So
// all places are in the convex hull of the vertices' first and last ones.
Result<ConvexHull> sweptHull(const ConvexHull& hull, const Mat4& world_from_first,
                             const Mat4& world_from_last) {
  std::vector<Vec3d> points;
  double error = 0.0;
  for (const Mat4& transform : {world_from_first, world_from_last}) {
    const layers::Placement place = layers::placementOf(transform);
    for (const Vec3d& vertex : hull.vertices) {
      points.push_back(place.point(vertex));
    }
    // A placed vertex is off by a few roundings of its terms, and the hull's own slack grows with it.
    const double reach = l1Norm(hull.centre) + hull.radius;
    const double terms = (l1Norm(place.x) + l1Norm(place.y) + l1Norm(place.z)) * reach + l1Norm(place.origin);
    error = std::max(error, 0x1p-49 * terms + 1.00001 * hull.slack * layers::stretchOf(place));
  }
  Result<ConvexHull> swept = buildHull(points);
  if (swept) {
    swept->slack += error;
  }
  return swept;
}

}  // namespace sightline
