#include "src/layers/pairs/simplex.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace sightline::layers {
namespace {

// Directions are cross products of edges. The nearest point itself would not do: near the origin it is a
// difference of large numbers, and along a direction made of it the part's own corners differ in height. A
// cross product is perpendicular to the edges however near the origin is.

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Times the sum of the corners' squared lengths: a bound of the error of the determinant of three corners.
constexpr double kVolumeRounding = 0x1p-47;
// Square of the error of an edge; triangles narrower than this count as lines.
constexpr double kFlatSquare = 0x1p-96;
// Square of the height below which the origin's side of a plane is not known.
constexpr double kLevelSquare = 0x1p-90;

// A part of the simplex that may be the nearest.
struct Candidate {
  std::uint32_t corners = 0;
  double square = kInfinity;
  Vec3d direction;  // any length
};

void takeNearer(Candidate& best, const Candidate& other) {
  if (other.square < best.square) {
    best = other;
  }
}

Candidate ofCorner(const Simplex& simplex, int i) {
  const Vec3d& p = simplex.corners[static_cast<std::size_t>(i)].point;
  return {1u << i, dot(p, p), p};
}

Candidate ofEdge(const Simplex& simplex, int i, int j) {
  const Vec3d& p = simplex.corners[static_cast<std::size_t>(i)].point;
  const Vec3d& q = simplex.corners[static_cast<std::size_t>(j)].point;
  const Vec3d edge = q - p;
  if (!(dot(p, edge) < 0.0)) {
    return ofCorner(simplex, i);
  }
  if (!(dot(q, edge) > 0.0)) {
    return ofCorner(simplex, j);
  }
  const Vec3d turn = cross(edge, dot(p, p) < dot(q, q) ? p : q);
  return {1u << i | 1u << j, dot(turn, turn) / dot(edge, edge), cross(turn, edge)};
}

// Whether no corner of the triangle is lower than the part found nearest. This fails only if the direction to
// an edge near the origin is mostly rounding error.
bool isLowest(const Simplex& simplex, const Candidate& part, const std::array<int, 3>& triangle) {
  double highest_of_part = -kInfinity, lowest = kInfinity;
  for (const int i : triangle) {
    const double height = dot(part.direction, simplex.corners[static_cast<std::size_t>(i)].point);
    if ((part.corners >> i & 1u) != 0) {
      highest_of_part = std::max(highest_of_part, height);
    } else {
      lowest = std::min(lowest, height);
    }
  }
  return lowest >= highest_of_part;
}

// far: the simplex's fourth corner, or null. It decides the side if the origin is too near to the plane to
// tell.
Candidate ofTriangle(const Simplex& simplex, const std::array<int, 3>& triangle, const Vec3d* far) {
  const auto [i, j, k] = triangle;
  const Vec3d& a = simplex.corners[static_cast<std::size_t>(i)].point;
  const Vec3d& b = simplex.corners[static_cast<std::size_t>(j)].point;
  const Vec3d& c = simplex.corners[static_cast<std::size_t>(k)].point;
  const Vec3d normal = normalOf(a, b, c);
  const double square = dot(normal, normal);
  const double longest = std::max({dot(b - a, b - a), dot(c - b, c - b), dot(a - c, a - c)});
  const bool flat = square <= kFlatSquare * longest;
  // Whether the foot of the perpendicular from the origin lies outside each edge.
  const std::array<bool, 3> past{flat || !(dot(normal, cross(a, b)) > 0.0),
                                 flat || !(dot(normal, cross(b, c)) > 0.0),
                                 flat || !(dot(normal, cross(c, a)) > 0.0)};
  Candidate best;
  for (std::size_t edge = 0; edge < 3; ++edge) {
    if (past[edge]) {
      takeNearer(best, ofEdge(simplex, triangle[edge], triangle[(edge + 1) % 3]));
    }
  }
  if (best.corners != 0 && (flat || isLowest(simplex, best, triangle))) {
    return best;
  }
  const double aa = dot(a, a), bb = dot(b, b), cc = dot(c, c);
  const Vec3d& nearest = aa <= bb && aa <= cc ? a : bb <= cc ? b : c;
  const double height = dot(normal, nearest);
  bool turned = height < 0.0;
  if (far != nullptr && height * height <= kLevelSquare * square) {
    turned = dot(normal, *far - nearest) < 0.0;
  }
  return {1u << i | 1u << j | 1u << k, height * height / square, turned ? -normal : normal};
}

Candidate ofTetrahedron(const Simplex& simplex, bool& holds_origin) {
  const Vec3d& a = simplex.corners[0].point;
  const Vec3d& b = simplex.corners[1].point;
  const Vec3d& c = simplex.corners[2].point;
  const Vec3d& d = simplex.corners[3].point;
  // Six times the volumes of the tetrahedra in which the origin replaces one corner.
  const Vec3d cd = cross(c, d), ab = cross(a, b);
  const std::array<double, 4> volumes{dot(b, cd), -dot(a, cd), dot(d, ab), -dot(c, ab)};
  const double aa = dot(a, a), bb = dot(b, b), cc = dot(c, c), dd = dot(d, d);
  const std::array<double, 4> rounding{kVolumeRounding * (bb + cc + dd), kVolumeRounding * (aa + cc + dd),
                                       kVolumeRounding * (aa + bb + dd), kVolumeRounding * (aa + bb + cc)};
  const double volume = volumes[0] + volumes[1] + volumes[2] + volumes[3];
  const bool flat = std::abs(volume) <= rounding[0] + rounding[1] + rounding[2] + rounding[3];
  const double sign = volume < 0.0 ? -1.0 : 1.0;
  constexpr std::array<std::array<int, 3>, 4> kFaces{{{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {0, 1, 2}}};
  Candidate best;
  holds_origin = true;
  for (std::size_t i = 0; i < 4; ++i) {
    if (flat || !(volumes[i] * sign > rounding[i])) {
      holds_origin = false;
      takeNearer(best, ofTriangle(simplex, kFaces[i], &simplex.corners[i].point));
    }
  }
  return best;
}

}  // namespace

bool Simplex::has(std::uint32_t first, std::uint32_t second) const {
  return std::any_of(corners.begin(), corners.begin() + size, [&](const Difference& corner) {
    return corner.first == first && corner.second == second;
  });
}

NearestPart nearestPart(const Simplex& simplex) {
  NearestPart part;
  Candidate best;
  switch (simplex.size) {
    case 1:
      best = ofCorner(simplex, 0);
      break;
    case 2:
      best = ofEdge(simplex, 0, 1);
      break;
    case 3:
      best = ofTriangle(simplex, {0, 1, 2}, nullptr);
      break;
    default:
      best = ofTetrahedron(simplex, part.holds_origin);
      break;
  }
  part.corners = best.corners;
  part.square = best.square;
  part.direction = unitOrZero(best.direction);
  return part;
}

void keepCorners(Simplex& simplex, std::uint32_t corners) {
  int kept = 0;
  for (int i = 0; i < simplex.size; ++i) {
    if ((corners >> i & 1u) != 0) {
      simplex.corners[static_cast<std::size_t>(kept++)] = simplex.corners[static_cast<std::size_t>(i)];
    }
  }
  simplex.size = kept;
}

// Uses the two shortest edges, which keep the most digits.
Vec3d normalOf(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const Vec3d ab = b - a, bc = c - b, ca = a - c;
  const double ab2 = dot(ab, ab), bc2 = dot(bc, bc), ca2 = dot(ca, ca);
  if (bc2 >= ab2 && bc2 >= ca2) {
    return cross(ca, ab);
  }
  return ca2 >= ab2 ? cross(ab, bc) : cross(bc, ca);
}

Vec3d unitOrZero(const Vec3d& v) {
  const double largest = maxComponent(abs(v));
  return largest > 0.0 && isFinite(v) ? normalized(v / largest) : Vec3d();
}

}  // namespace sightline::layers
