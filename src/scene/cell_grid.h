#pragma once

// A coarse picture of one object: which cells of a grid over its box hold parts of its triangles. Divisions
// of the box are compared by it. It is not conservative, so nothing may rely on a cell that is empty: with
// rounding, a sliver may be in none.

#include <array>
#include <cstdint>
#include <span>

#include "sightline/math/box.h"
#include "sightline/math/vec3.h"

namespace sightline::scene {

inline constexpr std::uint32_t kMaxSlabs = 32;  // along each axis

// A mesh of so many triangles is worth more time: it is of a shape of which a coarse grid says less, and what
// takes as long for every mesh matters less.
inline constexpr std::uint32_t kManyTriangles = 64;

// By slab along one axis: a bit for each slab along another.
using SlabMasks = std::array<std::uint32_t, kMaxSlabs>;

// The slabs along one axis of a box, and the planes that divide them.
struct Slabs {
  std::uint32_t count = 1;
  // By slab, the plane below it: the first one is the side of the box.
  std::array<float, kMaxSlabs> plane{};
  // The same, and the plane above each, as distances from the box's least corner, of which the box's longest
  // side is 1.
  alignas(64) std::array<float, kMaxSlabs> low{}, high{};
  alignas(64) std::array<float, kMaxSlabs> end{};  // as high; infinite for the last slab and all that are not
};

class CellGrid {
 public:
  // A grid over the box, in which the triangles are marked. The planes along an axis are the coordinates of
  // the corners within the box, if those are few, and some at equal distances. Otherwise all lie at equal
  // distances, each moved to the nearest coordinate of a corner if one lies within half a slab.
  // corners: three for each triangle. Precondition: the box is well formed and holds them.
  CellGrid(const Box& box, std::span<const Vec3f> corners);

  const Slabs& slabs(int axis) const { return slabs_[axis]; }
  // By slab along y: the slabs along z of cells that hold parts of triangles. A triangle in a plane between
  // two cells is in the one behind it, as that is where the solid lies that it bounds; one that touches a
  // plane from one side is not in the cells on the other.
  const SlabMasks& marked(std::uint32_t x) const { return marked_[x]; }

 private:
  std::array<Slabs, 3> slabs_;
  std::array<SlabMasks, kMaxSlabs> marked_{};  // by slab along x
};

}  // namespace sightline::scene
