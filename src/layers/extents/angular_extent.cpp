#include "src/layers/extents/angular_extent.h"

#include <algorithm>
#include <cmath>

namespace sightline::layers {

// Keeps the two ends of the angles of the vertices so far, which span less than half a turn.
AngleRange anglesOfAll(const ConvexHull& hull, const PlaneMap& map, double error, AngularVertices& ends) {
  const auto count = static_cast<std::uint32_t>(hull.vertices.size());
  PlanePoint low = map.at(hull.vertices[0]), high = low;
  ends.low = ends.high = 0;
  for (std::uint32_t v = 1; v < count; ++v) {
    const PlanePoint p = map.at(hull.vertices[v]);
    const double after_low = turn(low, p), before_high = turn(p, high);
    if (after_low >= 0.0 && before_high >= 0.0) {
      continue;
    }
    if (after_low > 0.0) {
      high = p;
      ends.high = v;
    } else if (before_high > 0.0) {
      low = p;
      ends.low = v;
    } else {
      return {};
    }
  }
  // The direction halfway between the ends; if they span more than a quarter turn, across their chord.
  const double low_length = std::sqrt(dot(low, low)), high_length = std::sqrt(dot(high, high));
  const PlanePoint a{low.x / low_length, low.z / low_length}, b{high.x / high_length, high.z / high_length};
  PlanePoint middle = dot(a, b) >= 0.0 ? PlanePoint{a.x + b.x, a.z + b.z} : PlanePoint{a.z - b.z, b.x - a.x};
  const double middle_length = std::sqrt(dot(middle, middle));
  middle = {middle.x / middle_length, middle.z / middle_length};
  // This also detects two points in exactly opposite directions, and NaN.
  double distance = std::min(dot(middle, low), dot(middle, high));
  for (const Vec3d& vertex : hull.vertices) {
    const double height = dot(middle, map.at(vertex));
    distance = height < distance ? height : distance;
  }
  return widened(low, high, distance - 2.0 * map.rounding, error);
}

}  // namespace sightline::layers
