#pragma once

// Edges of several polygons along the same mesh edges, of which some have several of these: whether all of
// them may lie on one line.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sightline/base/large_vector.h"
#include "sightline/base/parallel_for.h"
#include "src/base/sort_keys.h"
#include "src/occluders/outline_mesh.h"

namespace sightline::occluders {

// Edges that share mesh edges, directly or by others.
struct SharedEdge {
  std::uint32_t begin = 0, end = 0;  // in SharedEdges::edgeAt()
  bool one_line = true;              // false: each edge has a line of its own, and none is watertight
  float deviation = 0.0f;            // of mesh vertices from the line, rounded up
  std::array<Vec3f, 2> line{};       // of all, if they have one
};

class SharedEdges {
 public:
  // The mesh must outlive this.
  SharedEdges(const OutlineMesh& mesh, const ParallelFor& parallel_for);

  std::span<const SharedEdge> all() const { return shared_edges_; }
  // The edges of a shared one lie one after the other, those of the largest polygons first.
  std::uint32_t edgeAt(std::size_t i) const {
    return static_cast<std::uint32_t>(by_shared_edge_[i].second & 0xffffffffu);
  }
  // The number of the shared edge to which an edge belongs. Precondition: !mesh.isOneMeshEdge(edge).
  std::uint32_t numberOf(std::uint32_t edge) const { return number_of_[edge]; }

 private:
  void group(const ParallelFor& parallel_for);
  void judge(SharedEdge& shared, std::vector<std::uint32_t>& vertices) const;
  void listVertices(const SharedEdge& shared, std::vector<std::uint32_t>& vertices) const;
  std::array<Vec3f, 2> ownLine(std::uint32_t edge) const;
  std::array<Vec3f, 2> lineOf(const SharedEdge& shared, std::span<const std::uint32_t> vertices) const;

  const OutlineMesh& mesh_;
  LargeVector<base::SortKey>
      by_shared_edge_;  // the shared edge's first edge, then a polygon's id and an edge
  std::vector<SharedEdge> shared_edges_;
  LargeVector<std::uint32_t> number_of_;  // by edge that belongs to one
};

}  // namespace sightline::occluders
