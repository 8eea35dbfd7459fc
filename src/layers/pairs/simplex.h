#pragma once

// A simplex of up to four differences of two sets' points: which part of it is nearest to the origin.

#include <array>
#include <cstdint>

#include "sightline/math/vec3.h"

namespace sightline::layers {

// A point of the second set less one of the first, in units in which no coordinate of either exceeds 1: so
// every component is off by no more than a few roundings of 1.
struct Difference {
  Vec3d point;
  std::uint32_t first = 0, second = 0;  // the sets' vertices
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
  double square = 0.0;        // of its distance from the origin
  Vec3d direction;            // unit, from the origin towards it; zero: not known, as the origin is on it
  bool holds_origin = false;  // a tetrahedron that holds the origin by more than rounding
};

// simplex: at least one corner; corners may coincide or lie in a line or plane.
NearestPart nearestPart(const Simplex& simplex);
// Leaves the corners whose bits are set, in their order.
void keepCorners(Simplex& simplex, std::uint32_t corners);
// Perpendicular to a triangle, right-handed about a, b, c, any length; zero if it has no area.
Vec3d normalOf(const Vec3d& a, const Vec3d& b, const Vec3d& c);

// Unit; zero if it is zero or not finite.
Vec3d unitOrZero(const Vec3d& v);

}  // namespace sightline::layers
