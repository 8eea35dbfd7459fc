// Based on: John Snyder, Jed Lengyel. Visibility Sorting and Compositing for Image-Based Rendering.
// Microsoft Research MSR-TR-97-11, 1997, appendix B; Kelvin Chung, Wenping Wang. Quick collision detection of
// polytopes in virtual environments. VRST 1996.
// Differs from the papers in: sets are disjoint only if a plane separates them by more than the rounding
// error, and intersecting only if a tetrahedron contains the origin by more than that; the rest is undecided.

#include "src/layers/pairs/convex_pair.h"

#include <algorithm>
#include <cmath>

#include "src/layers/pairs/envelope_pair.h"
#include "src/layers/pairs/gjk.h"

namespace sightline::layers {
namespace {

constexpr int kChungSteps = 4;

// The direction from a point inside the first set to one inside the second.
Vec3d directionBetween(const PairQuestion& question) {
  const Vec3d inner = innerPoint(question.second, innerPoint(question.first, Vec3d()));
  const Vec3d unit = unitOrZero(inner - innerPoint(question.first, inner));
  return unit == Vec3d() ? Vec3d{1, 0, 0} : unit;
}

// Starts from the witness's direction and vertices.
void recall(const PairWitness& witness, PairQuestion& question) {
  for (std::size_t i = std::min<std::size_t>(witness.pairs, witness.first.size()); i-- > 0;) {
    const std::uint32_t first = knownVertex(question.first, witness.first[i]);
    const std::uint32_t second = knownVertex(question.second, witness.second[i]);
    question.first_hull = PairWitness::isEye(first) ? question.first_hull : first;
    question.second_hull = PairWitness::isEye(second) ? question.second_hull : second;
  }
  if (witness.pairs > 0 && isUnit(witness.direction)) {
    question.direction = witness.direction;
    return;
  }
  question.direction = witness.pairs > 0 ? unitOrZero(witness.direction) : Vec3d();
  if (question.direction == Vec3d()) {
    question.direction = directionBetween(question);
  }
}

// The witness's vertex pairs as a simplex.
Simplex recallSimplex(const PairWitness& witness, const PairQuestion& question) {
  Simplex simplex;
  for (std::size_t i = 0; i < std::min<std::size_t>(witness.pairs, witness.first.size()); ++i) {
    const std::uint32_t first = knownVertex(question.first, witness.first[i]);
    const std::uint32_t second = knownVertex(question.second, witness.second[i]);
    if (!simplex.has(first, second)) {
      simplex.add(differenceOf(question, first, second));
    }
  }
  return simplex;
}

// Keeps the farthest vertices of the hulls beside those of the sets, since a search cannot start at the eye.
void keepDisjoint(const PairQuestion& question, PairWitness& witness) {
  witness.disjoint = true;
  witness.pairs = 2;
  witness.direction = question.direction;
  witness.first[0] = question.first_vertex;
  witness.second[0] = question.second_vertex;
  witness.first[1] = question.first_hull;
  witness.second[1] = question.second_hull;
}

void keepSimplex(const PairQuestion& question, const Simplex& simplex, PairWitness& witness) {
  witness.disjoint = false;
  witness.pairs = static_cast<std::uint8_t>(simplex.size);
  witness.direction = question.direction;
  for (std::size_t i = 0; i < static_cast<std::size_t>(simplex.size); ++i) {
    witness.first[i] = simplex.corners[i].first;
    witness.second[i] = simplex.corners[i].second;
  }
}

// Chung's reflections: D' = D - 2 (R . D) R, with the unit vector R from the first set's farthest vertex
// along D to the second's. Two vertices that are in the wrong order along D are in the right order along D'.
// Chung shows that this ends at a separating direction if there is one. The vertex pairs are added to the
// simplex.
Intersection chung(PairQuestion& question, Simplex& simplex, std::uint64_t& steps) {
  for (int step = 0; step < kChungSteps; ++step) {
    if (separates(question, question.direction, steps)) {
      return Intersection::kDisjoint;
    }
    if (simplex.has(question.first_vertex, question.second_vertex)) {
      return Intersection::kUndecided;
    }
    const Difference pair = differenceOf(question, question.first_vertex, question.second_vertex);
    simplex.add(pair);
    const double square = dot(pair.point, pair.point);
    const double along = dot(pair.point, question.direction);
    const Vec3d next = unitOrZero(question.direction - pair.point * (2.0 * along / square));
    if (next == Vec3d()) {
      return Intersection::kUndecided;
    }
    question.direction = next;
  }
  return Intersection::kUndecided;
}

// Whether the envelopes prove that the sets are disjoint; false: not known. The search begins at the
// direction that separated them last.
bool envelopesDisjoint(const ConvexSet& first, const ConvexSet& second, PairWitness& witness,
                       PairCounts& counts) {
  if (first.around == nullptr || second.around == nullptr || (witness.pairs > 0 && !witness.disjoint)) {
    return false;
  }
  Vec3d direction =
      witness.pairs > 0 && isUnit(witness.direction) ? witness.direction : directionBetween(first, second);
  ++counts.chung_steps;
  witness.near = !separates(first, second, direction) &&
                 (witness.near || !separateEnvelopes(first, second, direction, counts.chung_steps));
  if (witness.near) {
    return false;
  }
  if (!witness.disjoint) {
    witness = {.disjoint = true, .pairs = 2};
  }
  witness.direction = direction;
  return true;
}

bool hasPoints(const ConvexSet& set) {
  return set.hull != nullptr && !set.hull->vertices.empty();
}

PairQuestion questionOf(const ConvexSet& first, const ConvexSet& second) {
  PairQuestion question{localSet(first, first.placement.origin), localSet(second, first.placement.origin)};
  question.unit = 1.0 / std::max({question.first.size, question.second.size, 1e-200});
  return question;
}

bool isFinite(const LocalSet& set) {
  return std::isfinite(set.size + set.hull_error + set.far_error);
}

}  // namespace

Intersection testIntersection(const ConvexSet& first, const ConvexSet& second, PairWitness& witness,
                              PairCounts& counts) {
  ++counts.questions;
  if (!hasPoints(first) || !hasPoints(second)) {
    witness = PairWitness();
    return Intersection::kUndecided;
  }
  if (envelopesDisjoint(first, second, witness, counts)) {
    return Intersection::kDisjoint;
  }
  PairQuestion question = questionOf(first, second);
  if (!isFinite(question.first) || !isFinite(question.second)) {
    witness = PairWitness();
    return Intersection::kUndecided;
  }
  recall(witness, question);
  Simplex simplex;
  Intersection result = Intersection::kUndecided;
  if (witness.disjoint || witness.pairs == 0) {
    result = chung(question, simplex, counts.chung_steps);
  } else {
    simplex = recallSimplex(witness, question);
  }
  if (result == Intersection::kUndecided) {
    result = gjk(question, simplex, counts.gjk_steps);
  }
  if (result == Intersection::kUndecided) {
    result = gjkAgain(question, simplex, counts.gjk_steps);
  }
  if (result == Intersection::kDisjoint) {
    keepDisjoint(question, witness);
  } else {
    keepSimplex(question, simplex, witness);
  }
  return result;
}

}  // namespace sightline::layers
