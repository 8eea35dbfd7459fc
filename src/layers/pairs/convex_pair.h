#pragma once

// Whether two convex sets meet, from what is known of the same two of a moment before.

#include <array>
#include <cstdint>

#include "sightline/layers/hull.h"
#include "src/layers/hull/hull_envelope.h"
#include "src/layers/pairs/placement.h"

namespace sightline::layers {

// A placed hull; or what is swept on the way from it to the eye: the convex hull of it and the eye, where the
// eye is a point, or all segments from its points along `sweep`, where the eye is far away in that direction.
// That an occluder of the hull must meet this set is what makes occlusion a question of meeting.
struct ConvexSet {
  enum class Kind : std::uint8_t { kHull, kWithEye, kSwept };
  const ConvexHull* hull = nullptr;
  Placement placement;
  Kind kind = Kind::kHull;
  Vec3d eye_or_sweep;  // world space: the eye; or the segment, as long as is needed to pass the other set
  const HullEnvelope* around = nullptr;  // the hull's; none: pairs known to be apart take longer
};

enum class Meeting : std::uint8_t {
  kApart,      // proven: a plane lies between them, with more room than all rounding
  kMeet,       // a tetrahedron of differences of their points holds the origin
  kUndecided,  // neither: they touch, nearly do, or are not finite. Counts as meeting
};

// What is kept of a pair between two questions.
struct PairWitness {
  static constexpr std::uint32_t kEye = 0xffffffffu;       // a vertex number: the eye
  static constexpr std::uint32_t kSweptBit = 0x80000000u;  // on a vertex number: its far end

  bool apart = false;      // at the last question
  std::uint8_t pairs = 0;  // how many of the vertex pairs hold something
  Vec3d direction;         // world space, from the first set to the second
  // Vertices of the two sets. Apart: the farthest along `direction`, then those of the hulls alone; otherwise
  // the corners of the simplex that holds the origin or came nearest to it.
  std::array<std::uint32_t, 4> first{}, second{};
};

struct PairCounts {
  std::uint64_t questions = 0, chung_steps = 0, gjk_steps = 0;
};

// Sets that were apart at the last question are first looked at as their envelopes, which mostly settles it.
// Then Chung's reflections, at most four and only if they were apart at the last question or nothing is
// known; then Gilbert's distance, from the vertex pairs found. The answer does not depend on the witness but
// for pairs that nearly touch; a wrong or strange witness (numbers beyond the hull's) does no harm. Source:
// Snyder, Lengyel. MSR-TR-97-11, appendix B; Chung, Wang. Quick collision detection of polytopes in virtual
// environments. VRST 1996; Gilbert, Johnson, Keerthi. A fast procedure for computing the distance between
// complex objects in three-dimensional space. IEEE J. Robotics and Automation 1988.
Meeting meeting(const ConvexSet& first, const ConvexSet& second, PairWitness& witness, PairCounts& counts);

}  // namespace sightline::layers
