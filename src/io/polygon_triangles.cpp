// Ear clipping with exact signs.
//
// Based on: G. H. Meisters. Polygons have ears. American Mathematical Monthly 82, 1975. Differs from it in
// what counts as an ear where the polygon touches itself, and in a check of the result, which does not rely
// on the polygon being simple:
//
// A triangle that is cut off is bounded by two edges of the ring and by the edge that replaces them. So the
// boundaries of all triangles sum to that of the polygon, whatever the polygon is, and every point lies in as
// many triangles, clockwise ones counted negative, as the polygon winds around it. No triangle here is
// clockwise. If, besides, no two of them overlap, then the polygon winds around each point once or not at
// all, and the triangles cover just the points that it winds around.

#include "src/io/polygon_triangles.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "src/geometry/exact_point.h"

namespace sightline::io {
namespace {

using geometry::Lattice;

// Bits below those of single precision are rounded away, as they are in the scene: the lattice has none.
double withoutLowestBits(double coordinate) {
  constexpr double kUnit = 0x1p-149;
  return std::abs(coordinate) < 0x1p-96 ? std::nearbyint(coordinate / kUnit) * kUnit : coordinate;
}

// Twice the area of the polygon as seen along each axis, from the first corner, so that large coordinates do
// not cancel each other out.
Vec3d normalOf(std::span<const Vec3d> corners) {
  Vec3d normal;
  for (std::size_t i = 2; i < corners.size(); ++i) {
    normal = normal + cross(corners[i - 1] - corners[0], corners[i] - corners[0]);
  }
  return normal;
}

}  // namespace

PolygonTriangles PolygonTriangulator::triangulate(std::span<const Vec3d> corners) {
  if (corners.size() == 3) {
    return fan(3, true);
  }
  steps_left_ += kStepsOfCorner * corners.size();
  if (corners.size() > kMostCorners || !takeCorners(corners)) {
    return fan(corners.size(), false);
  }
  const Vec3d normal = normalOf(at_);
  const Vec3d size = abs(normal);
  if (maxComponent(size) == 0.0) {
    return fan(corners.size(), allOnOneLine());
  }
  seen_.axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  seen_.side = normal[seen_.axis] > 0.0 ? 1 : -1;
  triangles_.clear();
  if (at_.size() == 4 && cutQuad()) {
    return {triangles_, true};
  }
  makeRing();
  if (!cutEars() || overlap() || !reachesAllCorners()) {
    return fan(corners.size(), false);
  }
  return {triangles_, true};
}

PolygonTriangles PolygonTriangulator::fan(std::size_t corners, bool exact) {
  triangles_.clear();
  for (std::uint32_t i = 2; i < corners; ++i) {
    triangles_.push_back({0, i - 1, i});
  }
  return {triangles_, exact};
}

// False if signs of them cannot be decided.
bool PolygonTriangulator::takeCorners(std::span<const Vec3d> corners) {
  at_.clear();
  for (const Vec3d& corner : corners) {
    at_.push_back({withoutLowestBits(corner.x), withoutLowestBits(corner.y), withoutLowestBits(corner.z)});
    if (!Lattice::allowed(at_.back())) {
      return false;
    }
  }
  lattice_ = Lattice::of(at_);
  return true;
}

bool PolygonTriangulator::allOnOneLine() const {
  const auto other = std::find_if(at_.begin(), at_.end(), [&](const Vec3d& p) { return p != at_[0]; });
  return other == at_.end() || std::all_of(at_.begin(), at_.end(), [&](const Vec3d& p) {
           return geometry::orientation(lattice_, 0, at_[0], *other, p) == 0 &&
                  geometry::orientation(lattice_, 1, at_[0], *other, p) == 0 &&
                  geometry::orientation(lattice_, 2, at_[0], *other, p) == 0;
         });
}

// 1 where the ring turns left from a through b to c, as the polygon does; 0 on one line.
int PolygonTriangulator::turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
  return seen_.side * geometry::orientation(lattice_, seen_.axis, at_[a], at_[b], at_[c]);
}

// Whether two corners have the same place as seen along the axis.
bool PolygonTriangulator::same(std::uint32_t a, std::uint32_t b) const {
  const int u = (seen_.axis + 1) % 3, v = (seen_.axis + 2) % 3;
  return at_[a][u] == at_[b][u] && at_[a][v] == at_[b][v];
}

// Two triangles on both sides of a diagonal do not overlap.
bool PolygonTriangulator::cutQuad() {
  for (std::uint32_t first = 0; first < 2; ++first) {
    const std::uint32_t second = first + 1, third = first + 2, fourth = (first + 3) % 4;
    if (turn(first, second, third) > 0 && turn(first, third, fourth) > 0) {
      triangles_ = {{first, second, third}, {first, third, fourth}};
      return true;
    }
  }
  return false;
}

void PolygonTriangulator::makeRing() {
  const auto count = static_cast<std::uint32_t>(at_.size());
  before_.resize(count);
  after_.resize(count);
  convex_.resize(count);
  repeated_.assign(count, 0);
  for (std::uint32_t i = 0; i < count; ++i) {
    before_[i] = i == 0 ? count - 1 : i - 1;
    after_[i] = i + 1 == count ? 0 : i + 1;
  }
  left_ = count;
  current_ = 1;
  for (std::uint32_t i = 0; i < count; ++i) {
    setConvex(i);
  }
  order_.resize(count);
  std::iota(order_.begin(), order_.end(), 0u);
  const int u = (seen_.axis + 1) % 3, v = (seen_.axis + 2) % 3;
  std::sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) {
    return at_[a][u] != at_[b][u] ? at_[a][u] < at_[b][u] : at_[a][v] < at_[b][v];
  });
  for (std::uint32_t i = 1; i < count; ++i) {
    if (same(order_[i - 1], order_[i])) {
      repeated_[order_[i - 1]] = repeated_[order_[i]] = 1;
    }
  }
}

void PolygonTriangulator::setConvex(std::uint32_t corner) {
  convex_[corner] = turn(before_[corner], corner, after_[corner]) > 0 ? 1 : 0;
}

void PolygonTriangulator::unlink(std::uint32_t corner) {
  const Ear old = at(corner);
  after_[old.before] = old.after;
  before_[old.after] = old.before;
  --left_;
  setConvex(old.before);
  setConvex(old.after);
}

// False once the work is spent.
bool PolygonTriangulator::take(std::uint64_t steps) {
  if (steps > steps_left_) {
    steps_left_ = 0;
    return false;
  }
  steps_left_ -= steps;
  return true;
}

// Whether the ring returns at a corner the way it came, or stays there: the triangle has no area, and without
// the corner the ring winds around everything as before.
bool PolygonTriangulator::foldsBack(const Ear& corner) const {
  if (turn(corner.before, corner.tip, corner.after) != 0) {
    return false;
  }
  // On one line, the tip lies between the two others or does not, along every axis.
  for (int i = 1; i <= 2; ++i) {
    const int axis = (seen_.axis + i) % 3;
    const double from = at_[corner.before][axis], to = at_[corner.after][axis], tip = at_[corner.tip][axis];
    if (tip < std::min(from, to) || tip > std::max(from, to)) {
      return true;
    }
  }
  return same(corner.before, corner.tip) || same(corner.tip, corner.after);
}

// Drops the corners where the ring folds back: `first` and the one after it, and what folds back then.
// Returns the corner before them. What the ring only runs along, there and back, would pass for an ear.
std::uint32_t PolygonTriangulator::dropFolds(std::uint32_t first) {
  for (bool dropped = true; dropped && left_ > 2;) {
    dropped = foldsBack(at(first));
    if (dropped) {
      const std::uint32_t before = before_[first];
      unlink(first);
      first = before;
    } else if (foldsBack(at(after_[first]))) {
      unlink(after_[first]);
      dropped = true;
    }
  }
  return first;
}

// Cuts off ears until nothing is left. Those whose new edge passes through a corner are left for when there
// are no others: the corner might be left over, without a triangle of its own.
bool PolygonTriangulator::cutEars() {
  for (std::uint32_t looked = 0; looked < left_ && left_ > 2; ++looked) {
    current_ = after_[dropFolds(current_)];
  }
  bool may_touch = false;
  for (std::uint32_t without = 0; left_ > 2;) {
    const Ear ear = at(current_);
    if (!take(1)) {
      return false;
    }
    if (convex_[current_] != 0 && isEar(ear, may_touch)) {
      triangles_.push_back({ear.before, ear.tip, ear.after});
      unlink(ear.tip);
      // The next tip is not the next corner: all ears at one corner would be slivers.
      current_ = after_[after_[dropFolds(ear.before)]];
      without = 0;
      may_touch = false;
      continue;
    }
    current_ = ear.after;
    if (++without >= left_) {
      if (may_touch) {
        return false;
      }
      may_touch = true;
      without = 0;
    }
  }
  return !triangles_.empty();
}

// Whether no edge of the ring passes through the inside of the triangle. An edge that does has a corner in
// it, or on its outline and goes inwards from there, unless the polygon crosses itself.
bool PolygonTriangulator::isEar(const Ear& ear, bool may_touch) {
  const int u = (seen_.axis + 1) % 3, v = (seen_.axis + 2) % 3;
  const Vec3d &a = at_[ear.before], &b = at_[ear.tip], &c = at_[ear.after];
  const double min_u = std::min({a[u], b[u], c[u]}), max_u = std::max({a[u], b[u], c[u]});
  const double min_v = std::min({a[v], b[v], c[v]}), max_v = std::max({a[v], b[v], c[v]});
  if (!take(left_)) {
    return false;
  }
  for (std::uint32_t corner = after_[ear.after]; corner != ear.before; corner = after_[corner]) {
    // If a chain of edges enters the triangle, its corner nearest to the tip is not convex, unless another
    // edge begins there too.
    if (convex_[corner] != 0 && repeated_[corner] == 0) {
      continue;
    }
    const Vec3d& p = at_[corner];
    if (p[u] < min_u || p[u] > max_u || p[v] < min_v || p[v] > max_v) {
      continue;
    }
    const int before = turn(ear.before, ear.tip, corner), after = turn(ear.tip, ear.after, corner);
    const int across = turn(ear.after, ear.before, corner);
    if (before < 0 || after < 0 || across < 0) {
      continue;
    }
    const bool touches = across == 0 && before > 0 && after > 0;
    if ((touches && !may_touch) || entersAt(ear, corner)) {
      return false;
    }
  }
  return true;
}

// Whether the ring goes into the triangle from a corner in it or on its outline.
bool PolygonTriangulator::entersAt(const Ear& ear, std::uint32_t corner) const {
  const std::array<std::array<std::uint32_t, 2>, 3> sides{
      {{ear.before, ear.tip}, {ear.tip, ear.after}, {ear.after, ear.before}}};
  for (const std::uint32_t other : {before_[corner], after_[corner]}) {
    if (std::all_of(sides.begin(), sides.end(), [&](const std::array<std::uint32_t, 2>& side) {
          return turn(side[0], side[1], corner) > 0 || turn(side[0], side[1], other) > 0;
        })) {
      return true;
    }
  }
  return false;
}

// Whether two of the triangles overlap; also once the work is spent.
bool PolygonTriangulator::overlap() {
  const int u = (seen_.axis + 1) % 3, v = (seen_.axis + 2) % 3;
  const auto least = [&](std::uint32_t triangle, int axis) {
    const auto& [a, b, c] = triangles_[triangle];
    return std::min({at_[a][axis], at_[b][axis], at_[c][axis]});
  };
  const auto most = [&](std::uint32_t triangle, int axis) {
    const auto& [a, b, c] = triangles_[triangle];
    return std::max({at_[a][axis], at_[b][axis], at_[c][axis]});
  };
  order_.resize(triangles_.size());
  std::iota(order_.begin(), order_.end(), 0u);
  std::sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) {
    const double least_a = least(a, u), least_b = least(b, u);
    return least_a != least_b ? least_a < least_b : a < b;
  });
  for (std::size_t i = 0; i < order_.size(); ++i) {
    const std::uint32_t one = order_[i];
    const double end = most(one, u), min_v = least(one, v), max_v = most(one, v);
    for (std::size_t j = i + 1; j < order_.size() && least(order_[j], u) < end; ++j) {
      const std::uint32_t other = order_[j];
      if (!take(1)) {
        return true;
      }
      if (least(other, v) < max_v && most(other, v) > min_v &&
          !disjoint(triangles_[one], triangles_[other]) && !disjoint(triangles_[other], triangles_[one])) {
        return true;
      }
    }
  }
  return false;
}

// Whether a side of one triangle separates the two. Of two triangles whose insides are disjoint, one has such
// a side.
bool PolygonTriangulator::disjoint(const std::array<std::uint32_t, 3>& a,
                                   const std::array<std::uint32_t, 3>& b) const {
  for (std::size_t i = 0; i < 3; ++i) {
    const std::uint32_t from = a[i], to = a[(i + 1) % 3];
    if (std::all_of(b.begin(), b.end(), [&](std::uint32_t corner) { return turn(from, to, corner) <= 0; })) {
      return true;
    }
  }
  return false;
}

// Corners where the ring folds back are in no triangle. The object's box must hold them, and it is made of
// the triangles.
bool PolygonTriangulator::reachesAllCorners() const {
  Vec3d min_used = at_[triangles_[0][0]], max_used = min_used, min_all = min_used, max_all = min_used;
  for (const auto& triangle : triangles_) {
    for (const std::uint32_t corner : triangle) {
      min_used = min(min_used, at_[corner]);
      max_used = max(max_used, at_[corner]);
    }
  }
  for (const Vec3d& corner : at_) {
    min_all = min(min_all, corner);
    max_all = max(max_all, corner);
  }
  return min_used == min_all && max_used == max_all;
}

}  // namespace sightline::io
