// The greatest angle by heights. Let all points p = (x, z) of a hull lie on the positive side of a line
// through the eye. From a vertex v, the points of a greater angle are those above the line from the eye
// through v: where the linear function f(p) = n . p is positive, n being the unit normal of v, f(v) = 0. So
// look for the highest vertex of f; where that is v, v has the greatest angle, otherwise go on from the
// vertex found. Angles only grow, so this ends; from the last frame's vertex it mostly ends at once. (This is
// Dinkelbach's method for the greatest ratio of two linear functions.)
//
// Rounding. Let r = map.rounding and k = ConvexHull::descent_factor. In the hull's space, f is the height
// along a direction of at most map.stretch. At the end v is the highest vertex that farthest() finds, so that
// no point that the hull was made of is higher than v by more than supportError(), which is below slack + r
// (1 + 2 k). Rounding of the direction changes heights by less than r, and v is off by sqrt(2) r. So no
// point is above the line by more than e = slack + r (4 k + 4). At a distance of at least d - e from the eye
// that is an angle of asin(e / (d - e)), and for d >= 4 e that is below 2 e / d. The pseudo-angle grows no
// faster.
//
// d is the distance along any direction of reference in the plane, which also proves that the hull is on one
// side of the eye. If no such direction is at hand, all vertices are looked at.

#include "layers/angular_extent.h"

#include <algorithm>
#include <optional>

#include "layers/support.h"

namespace sightline::layers {
namespace {

constexpr std::size_t kScanUpTo = 12;  // vertices
constexpr int kMostSteps = 64;
// A ball that comes nearer than this times its distance leaves too much room for rounding.
constexpr double kClearBall = 0x1p-16;

double errorOf(const ConvexHull& hull, const PlaneMap& map) {
  return map.slack + map.rounding * (4.0 + 4.0 * hull.descent_factor);
}

// From low to high with the hull at least `distance` from the eye.
AngleRange widened(const PlanePoint& low, const PlanePoint& high, double distance, double error) {
  if (!(distance > 4.0 * error)) {
    return {};
  }
  const double room = 2.0 * error / distance;
  const AngleRange range = rangeBetween(low, high);
  return {range.low - room, range.high + room};
}

// Along a direction of unit length, the least height of the hull, less what rounding can do.
double leastAlong(const ConvexHull& hull, const PlaneMap& map, const PlanePoint& direction, double error,
                  std::uint32_t& vertex) {
  const Support end = farthest(hull, -(map.x * direction.x + map.z * direction.z), vertex);
  vertex = end.vertex;
  return dot(direction, map.origin) - end.height - error;
}

// A lower bound of the hull's distance from the eye, along a direction of which all of it is ahead; not
// positive where none was found.
double distanceAhead(const ConvexHull& hull, const PlaneMap& map, double error, std::uint32_t& nearest) {
  const PlanePoint centre = map.at(hull.centre);
  const double to_centre = std::sqrt(dot(centre, centre));
  const double ball = map.stretch * hull.radius;
  const double clear = to_centre - ball - map.rounding;
  if (clear > kClearBall * (to_centre + ball) || !(to_centre > 0.0)) {
    return clear;
  }
  const PlanePoint along_zero{0.0, centre.z < 0.0 ? -1.0 : 1.0};
  const PlanePoint along_centre{centre.x / to_centre, centre.z / to_centre};
  const double by_zero = leastAlong(hull, map, along_zero, error, nearest);
  return by_zero > 4.0 * error ? by_zero : leastAlong(hull, map, along_centre, error, nearest);
}

// The vertex with the greatest angle (sign 1) or the least one (-1). None: rounding led round in circles.
std::optional<PlanePoint> endOf(const ConvexHull& hull, const PlaneMap& map, double sign,
                                std::uint32_t& vertex) {
  vertex = vertex < hull.vertices.size() ? vertex : 0;
  for (int step = 0; step < kMostSteps; ++step) {
    const PlanePoint end = map.at(hull.vertices[vertex]);
    const Vec3d ahead = map.x * (sign * end.z) - map.z * (sign * end.x);
    const std::uint32_t found = farthest(hull, ahead, vertex).vertex;
    if (found == vertex) {
      return end;
    }
    vertex = found;
  }
  return std::nullopt;
}

// By looking at all vertices: keeps the ends of the angles so far, which span less than half a turn.
AngleRange lookAtAll(const ConvexHull& hull, const PlaneMap& map, double error, AngularVertices& ends) {
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
  // The direction in the middle; where the ends are more than a quarter turn apart, across their chord.
  const double low_length = std::sqrt(dot(low, low)), high_length = std::sqrt(dot(high, high));
  const PlanePoint a{low.x / low_length, low.z / low_length}, b{high.x / high_length, high.z / high_length};
  PlanePoint middle = dot(a, b) >= 0.0 ? PlanePoint{a.x + b.x, a.z + b.z} : PlanePoint{a.z - b.z, b.x - a.x};
  const double middle_length = std::sqrt(dot(middle, middle));
  middle = {middle.x / middle_length, middle.z / middle_length};
  // Also catches a point exactly opposite to another, and all that is not a number.
  double distance = std::min(dot(middle, low), dot(middle, high));
  for (const Vec3d& vertex : hull.vertices) {
    const double height = dot(middle, map.at(vertex));
    distance = height < distance ? height : distance;
  }
  return widened(low, high, distance - 2.0 * map.rounding, error);
}

}  // namespace

AngleRange angularExtent(const ConvexHull& hull, const PlaneMap& map, AngularVertices& start) {
  const double error = errorOf(hull, map);
  if (hull.vertices.size() <= kScanUpTo || !(hull.descent_factor > 0.0)) {
    return lookAtAll(hull, map, error, start);
  }
  const double distance = distanceAhead(hull, map, error, start.nearest);
  if (distance > 4.0 * error) {
    const std::optional<PlanePoint> low = endOf(hull, map, -1.0, start.low);
    const std::optional<PlanePoint> high = endOf(hull, map, 1.0, start.high);
    if (low && high) {
      return widened(*low, *high, distance, error);
    }
  }
  return lookAtAll(hull, map, error, start);
}

}  // namespace sightline::layers
