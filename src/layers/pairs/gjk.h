#pragma once

// Gilbert's iteration: a simplex of differences of two sets' points that goes towards the origin.
//
// Based on: E. Gilbert, D. Johnson, S. Keerthi. A fast procedure for computing the distance between complex
// objects in three-dimensional space. IEEE J. Robotics and Automation 4(2), 1988.
// Differs from the paper in: only whether the sets meet is asked, so the first plane between them ends it;
// the nearest part of the simplex is found by signed areas and volumes instead of Johnson's recursion, and
// directions are made by cross products.

#include "src/layers/pairs/convex_set.h"
#include "src/layers/pairs/simplex.h"

namespace sightline::layers {

// Two sets in one local space, and what is known of them so far.
struct PairQuestion {
  LocalSet first, second;
  double unit = 1.0;  // times lengths: brings all coordinates below 1

  Vec3d direction;                                    // the last one tried, unit
  std::uint32_t first_vertex = 0, second_vertex = 0;  // the sets' farthest along it
  std::uint32_t first_hull = 0, second_hull = 0;      // the hulls' farthest: where the next search begins
};

// Whether a plane across the direction (unit, from the first to the second set) lies between the sets, with
// more room than all rounding. One is added to steps.
bool separates(PairQuestion& question, const Vec3d& direction, std::uint64_t& steps);
Difference differenceOf(const PairQuestion& question, std::uint32_t first, std::uint32_t second);

// simplex: at least one corner. Afterwards: the tetrahedron that holds the origin, or the last part. steps:
// the directions tried are added.
Meeting gjk(PairQuestion& question, Simplex& simplex, std::uint64_t& steps);
// Where that left it open: other directions that may separate, then the iteration from another beginning.
Meeting gjkAgain(PairQuestion& question, Simplex& simplex, std::uint64_t& steps);

}  // namespace sightline::layers
