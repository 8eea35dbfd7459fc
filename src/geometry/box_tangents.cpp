#include "src/geometry/box_tangents.h"

#include <bit>
#include <cmath>
#include <cstddef>

// Let a loop of corners turn round the silhouette of a box, and s_i = det(direction, corner i, corner i + 1).
// Where s changes from negative to positive at a corner v, both neighbours of v are on the positive side of
// the plane (direction, v); the silhouette being convex, all of the box is: v is `low`. Likewise `high` from
// positive to negative.
//
// An edge along axis a has corner i + 1 = corner i +- length * unit vector a, so s_i has the sign of
// +- cross(direction, corner i)[a]: two products compared. The length plays no part, and flat boxes are no
// special case: their edges of no length still have a direction.
//
// Rounding is monotone: products that differ after rounding differed so before. For equal products the
// rounding errors are compared.

namespace sightline::geometry {
namespace {

constexpr unsigned kSigns = 6, kAllSigns = (1u << kSigns) - 1;

// Returns the sign of left - right, each a product of two factors.
struct Products {
  double left_a, left_b, right_a, right_b;

  // Where the rounded products are equal: exact unless what rounding took away is out of range.
  int signOfTie() const {
    const double product = left_a * left_b;
    if (product == 0.0) {
      return 0;  // a line parallel to an axis
    }
    const double left_rest = std::fma(left_a, left_b, -product);
    const double right_rest = std::fma(right_a, right_b, -product);
    return (left_rest > right_rest ? 1 : 0) - (left_rest < right_rest ? 1 : 0);
  }
};

// Bit i of a set is set where edge i has that sign; a tie is in neither. products(i): the two products of
// edge i.
struct Signs {
  unsigned positive = 0, negative = 0;

  explicit Signs(const auto& products) {
    for (unsigned i = 0; i < kSigns; ++i) {
      const Products p = products(i);
      const double left = p.left_a * p.left_b, right = p.right_a * p.right_b;
      positive |= (left > right ? 1u : 0u) << i;
      negative |= (left < right ? 1u : 0u) << i;
    }
  }
  unsigned ties() const { return kAllSigns & ~(positive | negative); }
  void resolveTies(const auto& products) {
    for (unsigned left = ties(); left != 0; left &= left - 1) {
      const int i = std::countr_zero(left);
      const int sign = products(static_cast<unsigned>(i)).signOfTie();
      positive |= (sign > 0 ? 1u : 0u) << i;
      negative |= (sign < 0 ? 1u : 0u) << i;
    }
  }
  // The line's one end, or its other end, is outside of no edge. Without ties the table says so too.
  bool lineMeetsBox() const { return positive == 0 || negative == 0; }
};

// ---- First table

constexpr int digitOf(int region, int axis) {
  return axis == 0 ? region % 3 : axis == 1 ? region / 3 % 3 : region / 9;
}
// Whether the face where `axis` is minimal (side 0) or maximal (side 1) is seen.
constexpr bool seen(int region, int axis, int side) {
  return digitOf(region, axis) == 1 + side;
}
constexpr int sideOf(int corner, int axis) {
  return corner >> axis & 1;
}

// Whether the edge that leaves `corner` along `axis` (towards the other side of the box) belongs to the
// silhouette, in this direction. It does when one of its two faces, at `j` and `k`, is seen and the other is
// not. Its direction: let f be +1 on minimal sides and -1 on maximal ones, for the three axes at the corner,
// so that f points into the box, and v the corner's position. The plane's normal is
// cross(v, f_a e_a) = f_a (v_k e_j - v_j e_k). When face j is seen, v_j has the sign of f_j, and stepping
// into the box along k gives -f_a v_j f_k, of the sign of -f_a f_j f_k: the box is on the positive side when
// an odd number of the f are negative. When face k is seen, when an even number are.
constexpr bool isSilhouetteEdge(int region, int corner, int axis) {
  const int j = (axis + 1) % 3, k = (axis + 2) % 3;
  const bool seen_j = seen(region, j, sideOf(corner, j)), seen_k = seen(region, k, sideOf(corner, k));
  const bool odd = ((sideOf(corner, 0) + sideOf(corner, 1) + sideOf(corner, 2)) & 1) != 0;
  return seen_j != seen_k && (seen_j ? odd : !odd);
}

constexpr Silhouette makeSilhouette(int region) {
  Silhouette silhouette;
  // The corner that follows each one; -1: not in the silhouette.
  std::array<int, 8> next{};
  int first = -1;
  for (int corner = 7; corner >= 0; --corner) {
    next[static_cast<std::size_t>(corner)] = -1;
    for (int axis = 0; axis < 3; ++axis) {
      if (isSilhouetteEdge(region, corner, axis)) {
        next[static_cast<std::size_t>(corner)] = corner ^ 1 << axis;
        first = corner;
      }
    }
  }
  for (int corner = first; corner >= 0 && (silhouette.count == 0 || corner != first);
       corner = next[static_cast<std::size_t>(corner)]) {
    silhouette.corners[static_cast<std::size_t>(silhouette.count++)] = static_cast<BoxCorner>(corner);
  }
  return silhouette;
}

constexpr std::array<Silhouette, kRegions> kSilhouettes = [] {
  std::array<Silhouette, kRegions> table{};
  for (int region = 0; region < kRegions; ++region) {
    table[static_cast<std::size_t>(region)] = makeSilhouette(region);
  }
  return table;
}();

// The two products whose difference has the sign of det(direction, from, to), as indices into the direction
// and into the six bounds of the box (minimal x, y, z, maximal x, y, z).
struct EdgeProducts {
  std::uint8_t left_direction = 0, left_bound = 0, right_direction = 0, right_bound = 0;
};

constexpr EdgeProducts edgeProducts(int from, int to) {
  const int axis = (from ^ to) >> 1;  // 1, 2, 4 to 0, 1, 2
  const int j = (axis + 1) % 3, k = (axis + 2) % 3;
  const auto bound = [&](int at) { return static_cast<std::uint8_t>(at + 3 * sideOf(from, at)); };
  // cross(direction, from)[axis] = direction[j] from[k] - direction[k] from[j]
  const EdgeProducts forth{static_cast<std::uint8_t>(j), bound(k), static_cast<std::uint8_t>(k), bound(j)};
  const EdgeProducts back{forth.right_direction, forth.right_bound, forth.left_direction, forth.left_bound};
  return to > from ? forth : back;
}

using LoopProducts = std::array<EdgeProducts, kSigns>;

constexpr std::array<LoopProducts, kRegions> kLoopProducts = [] {
  std::array<LoopProducts, kRegions> table{};
  for (std::size_t region = 1; region < kRegions; ++region) {
    const Silhouette& loop = kSilhouettes[region];
    const std::size_t count = static_cast<std::size_t>(loop.count);
    for (std::size_t i = 0; i < kSigns; ++i) {
      const std::size_t from = i < count ? i : count - 1;
      table[region][i] = edgeProducts(loop.corners[from], loop.corners[(from + 1) % count]);
    }
  }
  return table;
}();

// ---- Second table

constexpr TangentPositions makeTangentPositions(unsigned positive) {
  TangentPositions row;
  int rises = 0;
  for (unsigned i = 0; i < kSigns; ++i) {
    const bool before = (positive >> (i + kSigns - 1) % kSigns & 1u) != 0, after = (positive >> i & 1u) != 0;
    if (!before && after) {
      row.low = static_cast<std::uint8_t>(i);
      ++rises;
    } else if (before && !after) {
      row.high = static_cast<std::uint8_t>(i);
    }
  }
  row.exist = rises == 1;
  return row;
}

constexpr std::array<TangentPositions, kAllSigns + 1> kTangentPositions = [] {
  std::array<TangentPositions, kAllSigns + 1> table{};
  for (unsigned positive = 0; positive <= kAllSigns; ++positive) {
    table[positive] = makeTangentPositions(positive);
  }
  return table;
}();

constexpr BoxTangents tangentsIn(const std::array<BoxCorner, 6>& loop, unsigned positive) {
  const TangentPositions& at = kTangentPositions[positive];
  return {loop[at.low], loop[at.high], at.exist};
}

}  // namespace

const Silhouette& silhouetteFrom(int region) {
  return kSilhouettes[static_cast<std::size_t>(region)];
}

const TangentPositions& tangentPositions(unsigned positive) {
  return kTangentPositions[positive];
}

// Where s_i = 0 the edge counts as not positive. That names a valid corner: at a change one of the two signs
// is strict, and the plane (direction, v) is a combination, with factors of one sign, of the two edges'
// planes.
BoxTangents tangentsByTables(const Vec3d& box_min, const Vec3d& box_max, const Vec3d& direction) {
  const std::size_t region = static_cast<std::size_t>(regionOfOrigin(box_min, box_max));
  if (region == 0) {
    return {};
  }
  const double bounds[6] = {box_min.x, box_min.y, box_min.z, box_max.x, box_max.y, box_max.z};
  const double along[3] = {direction.x, direction.y, direction.z};
  const auto products = [&](unsigned i) {
    const EdgeProducts& edge = kLoopProducts[region][i];
    return Products{along[edge.left_direction], bounds[edge.left_bound], along[edge.right_direction],
                    bounds[edge.right_bound]};
  };
  Signs signs(products);
  if (signs.ties() != 0) {
    signs.resolveTies(products);
    if (signs.lineMeetsBox()) {
      return {};
    }
  }
  return tangentsIn(kSilhouettes[region].corners, signs.positive);
}

BoxTangents tangentsOfAllVertices(const Vec3d& box_min, const Vec3d& box_max, const Vec3d& direction) {
  bool found_low = false, found_high = false;
  BoxTangents tangents;
  for (BoxCorner corner = 0; corner < 8; ++corner) {
    const Vec3d normal = cross(direction, cornerOf(box_min, box_max, corner));
    bool above = false, below = false;
    for (BoxCorner other = 0; other < 8 && !(above && below); ++other) {
      const Vec3d x = cornerOf(box_min, box_max, other);
      const double side = other == corner ? 0.0 : dot(normal, x);
      above = above || side > 0.0;
      below = below || side < 0.0;
      // Two corners in one plane with the line, on different sides of it or on it: the line intersects the
      // box.
      if (side == 0.0 && !(dot(normal, cross(direction, x)) > 0.0)) {
        return {};
      }
    }
    if (!below && !found_low) {
      tangents.low = corner;
      found_low = true;
    }
    if (!above && !found_high) {
      tangents.high = corner;
      found_high = true;
    }
  }
  tangents.exist = found_low && found_high;
  return tangents;
}

}  // namespace sightline::geometry
