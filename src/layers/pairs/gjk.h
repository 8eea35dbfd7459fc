#pragma once

// GJK: moves a simplex of differences of two sets' points towards the origin.
//
// Based on: E. Gilbert, D. Johnson, S. Keerthi. A fast procedure for computing the distance between complex
// objects in three-dimensional space. IEEE J. Robotics and Automation 4(2), 1988.
// Differs from the paper in: only intersection is asked for, so the first separating plane ends the search;
// the nearest part of the simplex is found by signed areas and volumes instead of Johnson's recursion;
// directions are cross products of edges.

#include "src/layers/pairs/convex_set.h"
#include "src/layers/pairs/simplex.h"

namespace sightline::layers {

// Two sets in one local space, and the state of the search.
struct PairQuestion {
  LocalSet first, second;
  double unit = 1.0;  // scale that brings all coordinates below 1

  Vec3d direction;                                    // the last direction tried, of unit length
  std::uint32_t first_vertex = 0, second_vertex = 0;  // the sets' farthest vertices along it
  std::uint32_t first_hull = 0, second_hull = 0;      // the hulls' farthest, where the next search starts
};

// Whether a plane across the direction separates the sets by more than the rounding error. Adds 1 to steps.
// direction: of unit length, from the first set to the second.
bool separates(PairQuestion& question, const Vec3d& direction, std::uint64_t& steps);
// The difference of two vertices, in the question's unit.
Difference differenceOf(const PairQuestion& question, std::uint32_t first, std::uint32_t second);

// Iterates from a simplex of at least one corner, which becomes the tetrahedron that contains the origin or
// the last nearest part. Adds the number of directions tried to steps.
Intersection gjk(PairQuestion& question, Simplex& simplex, std::uint64_t& steps);
// For sets that gjk() left undecided: tries other directions, then iterates from another simplex.
Intersection gjkAgain(PairQuestion& question, Simplex& simplex, std::uint64_t& steps);

}  // namespace sightline::layers
