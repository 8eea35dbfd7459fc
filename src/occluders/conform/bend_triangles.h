#pragma once

// Triangles whose edges are led through vertices are divided there.

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "sightline/base/large_vector.h"
#include "src/base/rows.h"
#include "src/occluders/mesh_edge.h"

namespace sightline::occluders {

struct BentTriangles {
  std::vector<std::uint32_t> triangles;  // three vertices of the input each, by source
  std::vector<std::uint32_t> source;     // of each triangle: the one of the input that it comes from
  // What has collapsed to a line or a point, as triangles of which two corners or all are the same. With
  // these, all of a triangle of the input is where it was, but for what its edges are bent.
  std::vector<std::uint32_t> collapsed, collapsed_source;
};

// Divides triangles one at a time. Nothing of this depends on where vertices are.
class TriangleBender {
 public:
  // edges: ascending. through: by edge, the vertices that it is led through, from its lower vertex on. All
  // must outlive this.
  TriangleBender(std::span<const MeshEdge> edges, const base::Rows<std::uint32_t>& through,
                 BentTriangles& bent);

  // Appends the pieces of a triangle: itself, if no edge of it is led through vertices. It is divided as if
  // these lay on the edges: a fan from a corner to the opposite edge, whose first and last triangle are fans
  // to the other edges.
  void add(const std::uint32_t (&corners)[3], std::uint32_t source);

 private:
  void findWay(std::uint32_t a, std::uint32_t b, std::vector<std::uint32_t>& way) const;
  void append(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t source);
  void addFan(std::uint32_t point, std::uint32_t a, std::span<const std::uint32_t> way, std::uint32_t b,
              std::uint32_t source);
  bool isFolded(const std::uint32_t (&corners)[3]);

  std::span<const MeshEdge> edges_;
  const base::Rows<std::uint32_t>& through_;
  BentTriangles& bent_;
  LargeVector<std::uint32_t> first_of_low_;  // by lower vertex, and one more: the first of its edges
  // Scratch for one triangle.
  std::vector<std::uint32_t> ways_[3], loop_;
  std::vector<std::pair<MeshEdge, bool>> steps_;  // along loop_; true: from the lower vertex
};

}  // namespace sightline::occluders
