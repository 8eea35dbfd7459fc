#pragma once

// Triangles of the polygons that files give as faces, so that they cover nothing beyond the polygon: what
// they cover hides what is behind it.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sightline/math/vec3.h"
#include "src/geometry/whole.h"

namespace sightline::io {

struct PolygonTriangles {
  // Numbers of corners; valid until the next call. Two fewer than corners at most, and at least one. All
  // together they reach as far as the corners, along each axis of the space that these are in.
  std::span<const std::array<std::uint32_t, 3>> triangles{};
  // Whether they cover just the polygon, each point once. Where they do not, they are a fan around the first
  // corner, which may cover anything and must hide nothing.
  bool exact = true;
};

// Cuts polygons into triangles of the polygon's own corners, which keep its orientation.
//
// A polygon may be concave, have straight corners and repeated ones, touch itself, and have holes that two
// coinciding edges join to its outline. It counts as seen along the longest axis of its normal, and all signs
// are exact there. Corners that do not lie in one plane make triangles all the same, and these are what the
// scene shows: whoever draws other triangles of such a polygon draws something else.
//
// Not exact are polygons that cross or overlap themselves, also as seen along that axis; that have more than
// kMostCorners corners, or coordinates of 2^64 and above; and all that come when the work is spent. The work
// is counted in steps, so that it depends on nothing but the polygons.
class PolygonTriangulator {
 public:
  static constexpr std::size_t kMostCorners = 1 << 14;
  // Steps: comparisons of a corner or a triangle with a triangle, some nanoseconds each, and up to some
  // hundred where coordinates differ so much in size that signs take whole numbers of many words. All
  // polygons together have kSteps, and kStepsOfCorner more for each of their corners.
  static constexpr std::uint64_t kSteps = std::uint64_t{1} << 29, kStepsOfCorner = 64;

  explicit PolygonTriangulator(std::uint64_t steps = kSteps) : steps_left_(steps) {}

  // corners: at least 3, finite.
  PolygonTriangles triangulate(std::span<const Vec3d> corners);

 private:
  // Along which axis the polygon is seen, and from where it runs counter-clockwise.
  struct Projection {
    int axis = 2;
    int side = 1;  // -1: from below
  };
  struct Ear {
    std::uint32_t before, tip, after;
  };

  PolygonTriangles fan(std::size_t corners, bool exact);
  bool takeCorners(std::span<const Vec3d> corners);
  bool allOnOneLine() const;
  bool cutQuad();
  void makeRing();
  bool cutEars();
  bool isEar(const Ear& ear, bool may_touch);
  bool entersAt(const Ear& ear, std::uint32_t corner) const;
  bool foldsBack(const Ear& corner) const;
  std::uint32_t dropFolds(std::uint32_t first);
  void unlink(std::uint32_t corner);
  void setConvex(std::uint32_t corner);
  bool overlap();
  bool disjoint(const std::array<std::uint32_t, 3>& a, const std::array<std::uint32_t, 3>& b) const;
  bool reachesAllCorners() const;

  int turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const;
  bool same(std::uint32_t a, std::uint32_t b) const;
  Ear at(std::uint32_t corner) const { return {before_[corner], corner, after_[corner]}; }
  bool take(std::uint64_t steps);

  std::uint64_t steps_left_;
  geometry::Lattice lattice_;
  Projection seen_;
  std::vector<Vec3d> at_;  // the corners
  std::vector<std::array<std::uint32_t, 3>> triangles_;

  // The polygon that is left is a ring of corners.
  std::vector<std::uint32_t> before_, after_;
  std::uint32_t left_ = 0, current_ = 0;  // how many there are, and one of them
  std::vector<std::uint8_t> convex_;      // as the ring turns there
  std::vector<std::uint8_t> repeated_;    // another corner has the same place
  std::vector<std::uint32_t> order_;      // scratch
};

}  // namespace sightline::io
