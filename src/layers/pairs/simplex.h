#pragma once

// A simplex of up to four differences of two sets' points, and its part nearest to the origin.

#include <array>
#include <cstdint>

#include "sightline/math/vec3.h"

namespace sightline::layers {

// A point of the second set minus one of the first, in units in which no coordinate of either exceeds 1. So
// the error of each component is a few roundings of 1.
struct Difference {
  Vec3d point;
  std::uint32_t first = 0, second = 0;  // vertex numbers of the two sets
};

struct Simplex {
  std::array<Difference, 4> corners{};
  int size = 0;

  bool has(std::uint32_t first, std::uint32_t second) const;
  void add(const Difference& corner) { corners[static_cast<std::size_t>(size++)] = corner; }
};

// The part of a simplex that is nearest to the origin.
struct NearestPart {
  std::uint32_t corners = 0;  // bit i: corner i spans it
  double square = 0.0;        // squared distance from the origin
  Vec3d direction;            // of unit length, from the origin to it; zero: not known, the origin is on it
  bool holds_origin = false;  // whether a tetrahedron contains the origin by more than rounding
};

// Finds the nearest part. simplex: at least one corner; corners may coincide or lie on a line or in a plane.
NearestPart nearestPart(const Simplex& simplex);
// Removes the corners whose bits are not set and keeps the order of the others.
void keepCorners(Simplex& simplex, std::uint32_t corners);
// Returns a normal of a triangle, right-handed about a, b, c, of any length; zero if it has no area.
Vec3d normalOf(const Vec3d& a, const Vec3d& b, const Vec3d& c);

// Returns the unit vector, or zero for a vector that is zero or not finite.
Vec3d unitOrZero(const Vec3d& v);

}  // namespace sightline::layers
