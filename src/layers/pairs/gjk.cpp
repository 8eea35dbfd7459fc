#include "src/layers/pairs/gjk.h"

#include <algorithm>
#include <array>

namespace sightline::layers {
namespace {

constexpr int kMaxSteps = 64;
// Steps with the origin on the simplex up to rounding, which may make no progress.
constexpr int kMaxLevelSteps = 6;
constexpr double kLevelSquare = 0x1p-96;
constexpr int kMaxRounds = 4;  // of gjkAgain(): trying normals and iterating from where they lead

// Directions that are unlikely to be along edges or normals of man-made shapes.
constexpr std::array<Vec3d, 4> kOddDirections{{{0.5709, 0.6173, 0.5413},
                                               {-0.6131, -0.5303, 0.5857},
                                               {0.4987, -0.6029, -0.6229},
                                               {-0.5501, 0.5783, -0.6029}}};

// Whether all corners lie beyond the origin along a direction, up to rounding.
bool maySeparate(const Simplex& simplex, const Vec3d& direction) {
  return direction != Vec3d() &&
         std::all_of(simplex.corners.begin(), simplex.corners.begin() + simplex.size,
                     [&](const Difference& corner) { return dot(corner.point, direction) > -0x1p-46; });
}

// Tries the normals of the simplex's faces that may separate, also of a face so near to the origin that the
// side is not known. Returns true if one separates (result becomes kDisjoint) or leads to a new corner (the
// simplex becomes that face and the corner).
bool tryNormals(PairQuestion& question, Simplex& simplex, Intersection& result, std::uint64_t& steps) {
  constexpr std::array<std::array<std::size_t, 3>, 4> kFaces{{{0, 1, 2}, {1, 2, 3}, {0, 2, 3}, {0, 1, 3}}};
  const std::size_t faces = simplex.size == 3 ? 1 : simplex.size == 4 ? 4 : 0;
  for (std::size_t i = 0; i < faces; ++i) {
    const auto [a, b, c] = kFaces[i];
    const Vec3d unit =
        unitOrZero(normalOf(simplex.corners[a].point, simplex.corners[b].point, simplex.corners[c].point));
    for (const Vec3d& direction : {unit, -unit}) {
      if (!maySeparate(simplex, direction)) {
        continue;
      }
      if (separates(question, direction, steps)) {
        result = Intersection::kDisjoint;
        return true;
      }
      if (!simplex.has(question.first_vertex, question.second_vertex)) {
        keepCorners(simplex, 1u << a | 1u << b | 1u << c);
        simplex.add(differenceOf(question, question.first_vertex, question.second_vertex));
        return true;
      }
    }
  }
  return false;
}

}  // namespace

bool separates(PairQuestion& question, const Vec3d& direction, std::uint64_t& steps) {
  ++steps;
  const Reach first = reach(question.first, direction, question.first_hull);
  const Reach second = reach(question.second, -direction, question.second_hull);
  question.direction = direction;
  question.first_vertex = first.vertex;
  question.second_vertex = second.vertex;
  question.first_hull = first.hull_vertex;
  question.second_hull = second.hull_vertex;
  return first.upper + second.upper < 0.0;
}

Difference differenceOf(const PairQuestion& question, std::uint32_t first, std::uint32_t second) {
  const Vec3d between = pointOf(question.second, second) - pointOf(question.first, first);
  return {between * question.unit, first, second};
}

Intersection gjk(PairQuestion& question, Simplex& simplex, std::uint64_t& steps) {
  int level_steps = 0;
  for (int step = 0; step < kMaxSteps && level_steps < kMaxLevelSteps; ++step) {
    const NearestPart part = nearestPart(simplex);
    if (part.holds_origin) {
      return Intersection::kIntersecting;
    }
    if (part.direction == Vec3d()) {
      return Intersection::kUndecided;
    }
    level_steps += part.square <= kLevelSquare ? 1 : 0;
    if (separates(question, part.direction, steps)) {
      return Intersection::kDisjoint;
    }
    // A corner found again, even one about to be dropped, means that rounding prevents progress.
    const bool again = simplex.has(question.first_vertex, question.second_vertex);
    keepCorners(simplex, part.corners);
    if (!simplex.has(question.first_vertex, question.second_vertex)) {
      simplex.add(differenceOf(question, question.first_vertex, question.second_vertex));
    }
    if (again) {
      return Intersection::kUndecided;
    }
  }
  return Intersection::kUndecided;
}

Intersection gjkAgain(PairQuestion& question, Simplex& simplex, std::uint64_t& steps) {
  Intersection result = Intersection::kUndecided;
  for (int round = 0; round < kMaxRounds && tryNormals(question, simplex, result, steps); ++round) {
    if (result != Intersection::kDisjoint) {
      result = gjk(question, simplex, steps);
    }
    if (result != Intersection::kUndecided) {
      return result;
    }
  }
  Simplex other;
  for (const Vec3d& direction : kOddDirections) {
    if (separates(question, direction, steps)) {
      return Intersection::kDisjoint;
    }
    if (!other.has(question.first_vertex, question.second_vertex)) {
      other.add(differenceOf(question, question.first_vertex, question.second_vertex));
    }
  }
  result = gjk(question, other, steps);
  if (result == Intersection::kIntersecting) {
    simplex = other;
  }
  return result;
}

}  // namespace sightline::layers
