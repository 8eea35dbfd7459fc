#pragma once

// Orientations of points that are given, or that lines and planes through given points define, without
// rounding. Each sign comes from floating-point numbers with a bound on their error, and where that does not
// decide, from whole numbers.

#include <span>

#include "sightline/math/vec3.h"
#include "src/geometry/whole.h"

namespace sightline::geometry {

// 1 where d lies on the side of the triangle's plane from which a, b, c run counter-clockwise, -1 on the
// other side, 0 in the plane. All four points must be of the lattice.
int orientation(const Lattice& lattice, const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d);

// Points of a plane are told apart by two of their coordinates, those after `axis`, along which the plane's
// normal is not zero. 1 where a, b, c run counter-clockwise as these coordinates are seen, that is, where the
// normal of the triangle is positive along the axis.
int orientation(const Lattice& lattice, int axis, const Vec3d& a, const Vec3d& b, const Vec3d& c);

// Whether three points lie exactly on one line. False where they have no lattice.
bool areOnOneLine(const Vec3f& a, const Vec3f& b, const Vec3f& c);
// Whether p lies exactly on the edge from a to b, between its ends or at one of them. False where the three
// have no lattice.
bool liesBetween(const Vec3f& a, const Vec3f& p, const Vec3f& b);

struct PlanePoints {
  Vec3d a, b, c;  // not on one line
};

// The axis along which the normal of a triangle is longest, the first of several; -1 if they are on one line.
int longestAxis(const Lattice& lattice, const PlanePoints& triangle);

// A point as the quotient of whole numbers of the lattice.
struct ExactPoint {
  WholeVec<7> numerator;
  Whole<6> denominator;  // above 0
  Vec3d rounded{};       // each coordinate to the nearest number in double precision
  double error = 0.0;    // at least the distance between the point and `rounded`, metres; 0 if they are equal
};

ExactPoint givenPoint(const Lattice& lattice, const Vec3d& point);
// Where the line through p and q meets a plane that it is not parallel to.
ExactPoint pointOfLine(const Lattice& lattice, const Vec3d& p, const Vec3d& q, const PlanePoints& plane);
// Where two lines of one plane meet that are not parallel. axis: as for orientation().
ExactPoint pointOfLines(const Lattice& lattice, int axis, const Vec3d& p, const Vec3d& q, const Vec3d& r,
                        const Vec3d& s);
// Where three planes meet of which no two intersect in parallel lines.
ExactPoint pointOfPlanes(const Lattice& lattice, std::span<const PlanePoints, 3> planes);

int orientation(int axis, const ExactPoint& a, const ExactPoint& b, const ExactPoint& c);
// -1, 0 or 1: the order of two points by one of their coordinates.
int compareAlong(int axis, const ExactPoint& a, const ExactPoint& b);
// Compares the coordinates after `axis`, then those after them; 0 only for equal points of the same plane.
inline int compareInPlane(int axis, const ExactPoint& a, const ExactPoint& b) {
  const int order = compareAlong((axis + 1) % 3, a, b);
  return order != 0 ? order : compareAlong((axis + 2) % 3, a, b);
}
inline bool operator==(const ExactPoint& a, const ExactPoint& b) {
  return a.rounded == b.rounded && compareAlong(0, a, b) == 0 && compareAlong(1, a, b) == 0 &&
         compareAlong(2, a, b) == 0;
}

}  // namespace sightline::geometry
