// The angles under which the eye sees a hull, for code compiled for one instruction set; included as
// support-inl.h is. Other code includes angular_extent.h.
//
// Finding the greatest angle by heights. Let all points p = (x, z) of a hull lie on the positive side of a
// line through the eye. The points with a greater angle than a vertex v are those above the line from the eye
// through v, where the linear function f(p) = n . p is positive; n is the unit normal of v, and f(v) = 0. So
// go uphill from v. If v is the highest vertex of f, it has the greatest angle; otherwise continue with the
// vertex found and its line. Angles only grow, so this ends; from the last frame's vertex it mostly ends at
// once. (This is Dinkelbach's method for the greatest ratio of two linear functions.)
//
// Rounding. Let r = map.rounding and k = ConvexHull::descent_factor. In the hull's space, f is the height
// along a direction no longer than map.stretch. At the end v is the highest vertex that farthest() finds, so
// no input point of the hull is higher than v by more than supportError(), which is below slack + r (1 + 2
// k). Rounding of the direction changes heights by less than r, and the error of v is sqrt(2) r. So no point
// is above the line by more than e = slack + r (4 k + 4). At a distance of at least d - e from the eye that
// is an angle of asin(e / (d - e)), which is below 2 e / d for d >= 4 e. The pseudo-angle grows no faster
// than the angle.
//
// d is the distance along any reference direction in the plane, which also proves that the hull is on one
// side of the eye. If no such direction is known, all vertices are compared.

#if defined(SIGHTLINE_LAYERS_ANGULAR_EXTENT_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SIGHTLINE_LAYERS_ANGULAR_EXTENT_INL_H
#undef SIGHTLINE_LAYERS_ANGULAR_EXTENT_INL_H
#else
#define SIGHTLINE_LAYERS_ANGULAR_EXTENT_INL_H
#endif

#include <cmath>

#include "src/layers/extents/angular_extent.h"
#include "src/layers/hull/support-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sightline::layers::HWY_NAMESPACE {

constexpr std::size_t kFewVertices = 12;  // up to this many, all vertices are compared
constexpr int kMaxSteps = 256;
// A ball nearer to the eye than this times its distance makes the error of the angles too large.
constexpr double kClearBall = 0x1p-16;

// A lower bound of the hull's heights along a direction of unit length.
HWY_INLINE double minAlong(const ConvexHull& hull, const PlaneMap& map, const PlanePoint& direction,
                           double error, std::uint32_t& vertex) {
  const Support end = farthestHere(hull, -(map.x * direction.x + map.z * direction.z), vertex);
  vertex = end.vertex;
  return dot(direction, map.origin) - end.height - error;
}

// A lower bound of the hull's distance from the eye along a direction in which all of it lies ahead; not
// positive if no such direction was found.
HWY_INLINE double distanceAhead(const ConvexHull& hull, const PlaneMap& map, double error,
                                std::uint32_t& nearest) {
  const PlanePoint centre = map.at(hull.centre);
  const double to_centre = std::sqrt(dot(centre, centre));
  const double ball = map.stretch * hull.radius;
  const double clear = to_centre - ball - map.rounding;
  if (clear > kClearBall * (to_centre + ball) || !(to_centre > 0.0)) {
    return clear;
  }
  const PlanePoint along_zero{0.0, centre.z < 0.0 ? -1.0 : 1.0};
  const PlanePoint along_centre{centre.x / to_centre, centre.z / to_centre};
  const double by_zero = minAlong(hull, map, along_zero, error, nearest);
  return by_zero > 4.0 * error ? by_zero : minAlong(hull, map, along_centre, error, nearest);
}

// Finds the vertex with the greatest (sign 1) or the smallest angle (sign -1). Returns false if rounding made
// the search cycle.
HWY_INLINE bool endOf(const ConvexHull& hull, const PlaneMap& map, double sign, std::uint32_t& vertex,
                      PlanePoint& end) {
  const bool uphill = climbs(hull);
  vertex = vertex < hull.vertices.size() ? vertex : 0;
  for (int step = 0; step < kMaxSteps; ++step) {
    const Vec3d& at = hull.vertices[vertex];
    end = map.at(at);
    const Vec3d ahead = map.x * (sign * end.z) - map.z * (sign * end.x);
    // One step uphill is enough, since the next step uses another line.
    const std::uint32_t found =
        (uphill ? highestAround(hull, ahead, {vertex, dot(ahead, at)}) : farthestOfAll(hull, ahead)).vertex;
    if (found == vertex) {
      return true;
    }
    vertex = found;
  }
  return false;
}

HWY_INLINE AngleRange angularExtentHere(const ConvexHull& hull, const PlaneMap& map, AngularVertices& start) {
  const double error = errorOf(hull, map);
  if (!(hull.descent_factor > 0.0) || hull.vertices.size() <= kFewVertices) {
    return anglesOfAll(hull, map, error, start);
  }
  const double distance = distanceAhead(hull, map, error, start.nearest);
  if (distance > 4.0 * error) {
    PlanePoint low, high;
    if (endOf(hull, map, -1.0, start.low, low) && endOf(hull, map, 1.0, start.high, high)) {
      return widened(low, high, distance, error);
    }
  }
  return anglesOfAll(hull, map, error, start);
}

}  // namespace sightline::layers::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
