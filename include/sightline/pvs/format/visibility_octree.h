#pragma once

// The visibility octree as plain data: cells of space, each with the set of objects that may be seen from it.
// Source: Saona-Vazquez, Navazo, Brunet. The Visibility Octree. Computers & Graphics 1999.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sightline/base/inline.h"
#include "sightline/math/vec3.h"

namespace sightline {

inline constexpr std::uint32_t kMaxOctreeDepth = 20;

// Why a cell was not divided (section 3.2, and later, by merging).
enum class StopReason : std::uint8_t {
  kBudgetMet,      // few enough triangles
  kNothingGained,  // neither smaller cells nor a larger search box would hide more
  kMaxDepth,
  kMerged,   // eight cells with similar sets became one
  kOutside,  // outside the viewing region
};
inline constexpr std::uint32_t kStopReasons = 5;

// A plane that divides a cell, with the solid that it stands for. Eyes with dot(normal, eye) >= front are in
// front of it and those with dot(normal, eye) <= back behind it. The others are inside the solid or so close
// to it that they may look through it. back <= front.
//
// The look-up computes the dot product in double precision, x, then y, then z, with an error below 2^-50 of
// the coordinates' magnitude (the largest absolute value in the octree's box). To allow for this, the sets of
// both sides hold for sides enlarged by m = 2^-40 of that magnitude: front_set for all eyes of the cell with
// dot(normal, eye) >= front - m, back_set for those with dot(normal, eye) <= back + m. Whoever creates planes
// must ensure this.
struct CellPlane {
  Vec3d normal{};  // unit length
  double front = 0.0, back = 0.0;

  friend bool operator==(const CellPlane&, const CellPlane&) = default;
};

enum class CellSide : std::uint8_t { kFront, kBetween, kBack };

// The side of the plane that the eye is on; `between` if the dot product is not a number.
SIGHTLINE_INLINE CellSide sideOf(const CellPlane& plane, const Vec3d& eye) {
  const double distance = dot(plane.normal, eye);
  return distance >= plane.front  ? CellSide::kFront
         : distance <= plane.back ? CellSide::kBack
                                  : CellSide::kBetween;
}

// One leaf of the octree, 16 bytes. Each belongs to exactly one node.
struct OctreeLeaf {
  static constexpr std::uint32_t kNoPlane = 0xffffffffu;

  std::uint32_t set = 0;           // seen from anywhere in the cell; with a plane, from between its sides
  std::uint32_t plane = kNoPlane;  // into planes
  std::uint32_t front_set = 0, back_set = 0;  // only with a plane

  friend bool operator==(const OctreeLeaf&, const OctreeLeaf&) = default;
};
static_assert(sizeof(OctreeLeaf) == 16);

// The part of a leaf's cell where viewers are expected: a box of steps, of which a cell has 256 along each
// axis. Both ends belong to it. The leaf's sets hold there; an eye elsewhere in the cell gets all objects.
struct ViewerBounds {
  std::array<std::uint8_t, 3> first{};              // the first step along each axis
  std::array<std::uint8_t, 3> last{255, 255, 255};  // the last one, no less than the first

  friend bool operator==(const ViewerBounds&, const ViewerBounds&) = default;
};
inline constexpr std::uint32_t kViewerLevels = 8;  // a step is a cell's edge, halved so often
static_assert(sizeof(ViewerBounds) == 6);

// The part of the cell that they take, from 0 to 1.
inline double volumeOf(const ViewerBounds& viewers) {
  double steps = 1.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    steps *= viewers.last[axis] - viewers.first[axis] + 1;
  }
  return steps * 0x1p-24;
}

// An inner node has the index of the first of its eight children, which are consecutive. Child i is in the
// upper half in x, y, z if bit 0, 1, 2 of i is set. A leaf has kOctreeLeaf plus the index of the leaf.
using OctreeLink = std::uint32_t;
inline constexpr OctreeLink kOctreeLeaf = 0x80000000u;

struct OctreeView {
  Vec3d min{}, max{};                   // box of the root, scene space
  std::span<const OctreeLink> nodes{};  // [0] is the root; children have greater indices than their parent
  std::span<const OctreeLeaf> leaves{};
  std::span<const std::uint8_t> depths{};   // level of each leaf
  std::span<const std::uint8_t> reasons{};  // StopReason of each leaf
  std::span<const CellPlane> planes{};
  std::span<const ViewerBounds> viewers{};  // of each leaf; none: viewers are expected in all of each cell

  ViewerBounds viewersOf(std::uint32_t leaf) const {
    return viewers.empty() ? ViewerBounds{} : viewers[leaf];
  }
};

struct VisibilityOctree {
  Vec3d min{}, max{};
  std::vector<OctreeLink> nodes{};
  std::vector<OctreeLeaf> leaves{};
  std::vector<std::uint8_t> depths{}, reasons{};
  std::vector<CellPlane> planes{};
  std::vector<ViewerBounds> viewers{};

  OctreeView view() const { return {min, max, nodes, leaves, depths, reasons, planes, viewers}; }
};

// One cell of a level's grid, which has 2^level cells along each axis.
struct OctreeCell {
  std::uint32_t level = 0;
  std::array<std::uint32_t, 3> at{};

  OctreeCell child(std::uint32_t i) const {
    return {level + 1, {at[0] * 2 + (i & 1), at[1] * 2 + (i >> 1 & 1), at[2] * 2 + (i >> 2 & 1)}};
  }
  friend bool operator==(const OctreeCell&, const OctreeCell&) = default;
};

// The coordinate at which grid line `at` of a level crosses an axis. The same place has the same bits on
// every level, because the baker and the look-up both use this function.
SIGHTLINE_INLINE double gridLine(double min, double max, std::uint32_t level, std::uint32_t at) {
  return min + (max - min) * (static_cast<double>(at) / static_cast<double>(1u << level));
}
SIGHTLINE_INLINE Vec3d cellMin(const Vec3d& min, const Vec3d& max, const OctreeCell& c) {
  return {gridLine(min.x, max.x, c.level, c.at[0]), gridLine(min.y, max.y, c.level, c.at[1]),
          gridLine(min.z, max.z, c.level, c.at[2])};
}
SIGHTLINE_INLINE Vec3d cellMax(const Vec3d& min, const Vec3d& max, const OctreeCell& c) {
  return {gridLine(min.x, max.x, c.level, c.at[0] + 1), gridLine(min.y, max.y, c.level, c.at[1] + 1),
          gridLine(min.z, max.z, c.level, c.at[2] + 1)};
}

// The coordinate of a step of ViewerBounds in a cell, of an octree of this extent.
SIGHTLINE_INLINE double viewersLine(double min, double max, const OctreeCell& c, std::size_t axis,
                                    std::uint32_t step) {
  return gridLine(min, max, c.level + kViewerLevels, (c.at[axis] << kViewerLevels) + step);
}
// The box in a cell, of the octree with this box, where viewers are expected.
SIGHTLINE_INLINE Vec3d viewersMin(const Vec3d& min, const Vec3d& max, const OctreeCell& c,
                                  const ViewerBounds& v) {
  return {viewersLine(min.x, max.x, c, 0, v.first[0]), viewersLine(min.y, max.y, c, 1, v.first[1]),
          viewersLine(min.z, max.z, c, 2, v.first[2])};
}
SIGHTLINE_INLINE Vec3d viewersMax(const Vec3d& min, const Vec3d& max, const OctreeCell& c,
                                  const ViewerBounds& v) {
  return {viewersLine(min.x, max.x, c, 0, v.last[0] + 1u), viewersLine(min.y, max.y, c, 1, v.last[1] + 1u),
          viewersLine(min.z, max.z, c, 2, v.last[2] + 1u)};
}

// Calls visit(leaf index, cell) for all leaves, depth first, children in order.
template <typename Visit>
void forEachLeaf(const OctreeView& octree, Visit&& visit) {
  struct Entry {
    std::uint32_t node{};
    OctreeCell cell{};
  };
  std::vector<Entry> stack;
  if (!octree.nodes.empty()) {
    stack.push_back({0, {}});
  }
  while (!stack.empty()) {
    const Entry entry = stack.back();
    stack.pop_back();
    const OctreeLink link = octree.nodes[entry.node];
    if ((link & kOctreeLeaf) != 0) {
      visit(link & ~kOctreeLeaf, entry.cell);
      continue;
    }
    for (std::uint32_t i = 8; i-- > 0;) {
      stack.push_back({link + i, entry.cell.child(i)});
    }
  }
}

}  // namespace sightline
