#pragma once

// Whether two convex sets intersect, starting from the result of the last frame.

#include <array>
#include <cstdint>
#include <span>

#include "sightline/layers/hull.h"
#include "src/layers/hull/hull_envelope.h"
#include "src/layers/pairs/placement.h"

namespace sightline::layers {

// A placed hull, or the set that it sweeps towards the eye: the convex hull of it and the eye (perspective),
// or all segments from its points along the sweep (orthographic). An occluder of the hull intersects this
// set, which makes occlusion a question of intersection. For several eyes the set is the convex hull of it
// and all eyes: it is the union of those of all eyes in the eyes' convex hull.
struct ConvexSet {
  enum class Kind : std::uint8_t { kHull, kWithEye, kSwept };
  const ConvexHull* hull = nullptr;
  Placement placement;
  Kind kind = Kind::kHull;
  Vec3d eye_or_sweep;  // world space: the eye, or a segment long enough to pass the other set
  const HullEnvelope* around = nullptr;  // the hull's envelope; null: disjoint pairs take longer
  std::span<const Vec3d> more_eyes{};    // of kWithEye, world space; at most kMaxMoreEyes
};

enum class Intersection : std::uint8_t {
  kDisjoint,      // proven: a plane separates them with more room than the rounding error
  kIntersecting,  // a tetrahedron of differences of their points contains the origin
  kUndecided,     // they touch, nearly touch, or are not finite; counts as intersecting
};

inline constexpr std::size_t kMaxMoreEyes = 0xffff;

// What is kept of a pair from one test to the next.
struct PairWitness {
  // The vertex number of the eye; that of more_eyes[i] is kEye - 1 - i.
  static constexpr std::uint32_t kEye = 0xffffffffu;
  // In a vertex number, this bit stands for the far end of the vertex's segment.
  static constexpr std::uint32_t kSweptBit = 0x80000000u;

  static constexpr bool isEye(std::uint32_t vertex) { return vertex >= kEye - kMaxMoreEyes; }

  bool disjoint = false;   // result of the last test
  bool near = false;       // whether the envelopes were not found disjoint then, so that vertices decided
  std::uint8_t pairs = 0;  // number of vertex pairs in use
  Vec3d direction;         // world space, from the first set to the second
  // Vertices of the two sets. Disjoint: the farthest along `direction`, then the farthest of the hulls alone.
  // Otherwise: the corners of the simplex that contains the origin or came nearest to it.
  std::array<std::uint32_t, 4> first{}, second{};
};

struct PairCounts {
  std::uint64_t questions = 0, chung_steps = 0, gjk_steps = 0;
};

// Tests two sets for intersection and updates the witness. Sets that were disjoint or are new are first
// tested by their envelopes, which mostly suffices, and then take up to four of Chung's reflections. GJK
// decides the rest, starting from the vertex pairs found. The witness changes the result only for pairs that
// nearly touch; any witness is valid, also with numbers that the hulls do not have. Source: Snyder, Lengyel.
// MSR-TR-97-11, appendix B; Chung, Wang. Quick collision detection of polytopes in virtual environments. VRST
// 1996; Gilbert, Johnson, Keerthi. A fast procedure for computing the distance between complex objects in
// three-dimensional space. IEEE J. Robotics and Automation 1988.
Intersection testIntersection(const ConvexSet& first, const ConvexSet& second, PairWitness& witness,
                              PairCounts& counts);

}  // namespace sightline::layers
