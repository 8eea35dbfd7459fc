#pragma once

// Convex bodies among the polygons of an object. Polygons that enclose a convex solid hide as a whole, so
// that structures in image space need only its outline.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/base/large_vector.h"
#include "sightline/base/parallel_for.h"
#include "sightline/occluders/occluder_set.h"
#include "src/base/rows.h"
#include "src/base/sort_keys.h"
#include "src/base/union_find.h"
#include "src/occluders/assemble_set.h"
#include "src/occluders/polygon_merge.h"

namespace sightline::occluders {

// The mesh vertices from one corner of a polygon to the next.
struct CornerChain {
  std::uint64_t key = 0;  // equal for chains between the same two corners
  std::uint32_t polygon = 0;
  std::uint32_t begin = 0, edge_count = 0;  // of its mesh edges: place in the polygon's loop, and number
};

// Pairs of chains that run against each other.
class ChainMates {
 public:
  void find(std::span<const FoundPolygon* const> polygons);

  // By key, of equal ones by polygon and along its boundary.
  std::span<const CornerChain> chains() const { return chains_; }
  // Whether each chain of a polygon has one partner, and runs against it.
  bool allMated(std::uint32_t polygon) const { return mated_[polygon] != 0; }

 private:
  base::KeySorter sorter_;
  LargeVector<base::SortKey> keys_;  // of chains: their key, polygon and first corner
  std::vector<CornerChain> chains_;
  std::vector<std::uint8_t> mated_;  // by polygon
};

// Finds bodies, in one object after the other.
class BodyFinder {
 public:
  explicit BodyFinder(std::span<const Vec3f> positions) : positions_(positions) {}

  // Numbers the bodies among polygons of one object from 0, and fills FoundPolygon::body and body_size.
  // Polygons make a body where each edge is, mesh edge by mesh edge, an edge of one other of those given, and
  // no vertex lies before any of the planes by more than the tolerance, and some clearly behind it.
  void find(std::span<FoundPolygon* const> polygons, double tolerance);

 private:
  bool isBody(std::span<const FoundPolygon* const> faces, double tolerance);

  std::span<const Vec3f> positions_;
  ChainMates mates_;
  base::UnionFind components_;        // of polygons that share edges
  std::vector<std::uint8_t> closed_;  // by component
  base::Rows<std::uint32_t> by_component_;
  std::vector<const FoundPolygon*> read_, faces_;
  std::vector<std::uint32_t> vertices_;  // of the body that isBody() looks at
  std::vector<Vec3d> corners_;           // these vertices
};

// Fills the bodies of a set whose occluders are these polygons. Bodies of which a polygon is missing are left
// out.
void assembleBodies(std::span<const Vec3f> positions, std::span<const RankedPolygon> polygons,
                    const ParallelFor& parallel_for, OccluderSet& set);

}  // namespace sightline::occluders
