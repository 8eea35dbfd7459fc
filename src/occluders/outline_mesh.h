#pragma once

// The outlines of found polygons as one mesh: which of them run along each edge of the mesh.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "sightline/base/large_vector.h"
#include "sightline/base/parallel_for.h"
#include "sightline/math/vec3.h"
#include "src/base/parts.h"
#include "src/base/rows.h"
#include "src/occluders/assemble_set.h"

namespace sightline::occluders {

inline constexpr std::size_t kPolygonsOfPart = 4096;  // for which one thread does the work of a step

// Numbers what the outlines have, in the order of the given polygons, where neighbours are close in memory.
// "Place" is the number of a polygon among them, "edge" that of an edge from one corner to the next, "use"
// that of a mesh edge on such an edge, counted from the first corner on.
class OutlineMesh {
 public:
  // Both must outlive this.
  OutlineMesh(std::span<const Vec3f> positions, std::span<const RankedPolygon> polygons,
              const ParallelFor& parallel_for);

  std::size_t placeCount() const { return polygons_.size(); }
  std::size_t useCount() const { return first_use_.back(); }
  std::size_t edgeCount() const { return place_of_edge_.size(); }
  const RankedPolygon& rankedAt(std::uint32_t place) const { return polygons_[place]; }
  const FoundPolygon& polygonAt(std::uint32_t place) const { return *polygons_[place].polygon; }
  const Vec3f& position(std::uint32_t vertex) const { return positions_[vertex]; }

  std::uint32_t firstEdge(std::uint32_t place) const { return first_edge_[place]; }
  std::uint32_t endEdge(std::uint32_t place) const { return first_edge_[place + std::size_t{1}]; }
  std::uint32_t firstUse(std::uint32_t place) const { return first_use_[place]; }
  std::uint32_t placeOf(std::uint32_t edge) const { return place_of_edge_[edge]; }
  std::uint32_t edgeOf(std::uint32_t use) const { return edge_of_use_.empty() ? use : edge_of_use_[use]; }
  std::uint32_t cornerOf(std::uint32_t edge) const { return edge - first_edge_[placeOf(edge)]; }
  std::uint32_t firstUseOf(std::uint32_t edge) const {
    return firstUse(placeOf(edge)) + meshEdges(polygonAt(placeOf(edge)), 0, cornerOf(edge));
  }
  // How many mesh edges an edge has.
  std::uint32_t meshEdgeCount(std::uint32_t edge) const {
    const FoundPolygon& polygon = polygonAt(placeOf(edge));
    return meshEdgesFrom(polygon, cornerOf(edge));
  }
  static std::uint32_t meshEdgesFrom(const FoundPolygon& polygon, std::uint32_t corner) {
    return meshEdges(polygon, corner, corner + 1 < polygon.corners().size() ? corner + 1 : 0);
  }
  // The vertices at which an edge begins and ends.
  std::array<std::uint32_t, 2> endsOf(std::uint32_t edge) const {
    const FoundPolygon& polygon = polygonAt(placeOf(edge));
    const std::uint32_t corner = cornerOf(edge);
    return {polygon.loop()[polygon.corners()[corner]],
            polygon.loop()[polygon.corners()[corner + 1 < polygon.corners().size() ? corner + 1 : 0]]};
  }

  // Whether an edge of the polygons is one mesh edge, and so is each edge that shares it.
  bool isOneMeshEdge(std::uint32_t edge) const { return kind_[edge] != Kind::kSeveral; }
  // Whether it is, of the edges on its mesh edge, the one of the largest polygon. Precondition:
  // isOneMeshEdge(edge).
  bool isFirst(std::uint32_t edge) const { return kind_[edge] == Kind::kFirst; }

  // Calls visit(use) for the other uses of a use's mesh edge, and maybe for the use itself.
  template <typename Visit>
  void forEachBeyond(std::uint32_t use, Visit&& visit) const {
    const std::uint32_t other = beyond_[use];
    if (other < kCrowded) {
      visit(other);
    } else if (other != kNone) {
      for (const std::uint32_t user : crowded_[other - kCrowded]) {
        visit(user);
      }
    }
  }

 private:
  enum class Kind : std::uint8_t { kOne, kFirst, kSeveral };
  struct Use {
    std::uint32_t high = 0, use = 0;  // the mesh edge's higher vertex
    friend bool operator<(const Use& a, const Use& b) { return a.key() < b.key(); }

   private:
    std::uint64_t key() const { return std::uint64_t{high} << 32 | use; }
  };
  static constexpr std::uint32_t kNone = 0xffffffffu, kCrowded = 0x80000000u;

  // Mesh edges from a corner to another one.
  static std::uint32_t meshEdges(const FoundPolygon& polygon, std::uint32_t from, std::uint32_t to) {
    return polygon.corners()[to] >= polygon.corners()[from]
               ? polygon.corners()[to] - polygon.corners()[from]
               : polygon.corners()[to] + static_cast<std::uint32_t>(polygon.loop().size()) -
                     polygon.corners()[from];
  }
  void number(const ParallelFor& parallel_for);
  base::Rows<Use> usesByVertex(const ParallelFor& parallel_for) const;
  void findBeyond(base::Rows<Use> by_vertex, const ParallelFor& parallel_for);
  void join(std::span<const Use> users, base::Rows<std::uint32_t>& crowded);
  bool isBefore(std::uint32_t a, std::uint32_t b) const;

  std::span<const Vec3f> positions_;
  std::span<const RankedPolygon> polygons_;
  LargeVector<std::uint32_t> first_edge_, first_use_;  // by place, and one more
  LargeVector<std::uint32_t> place_of_edge_;
  LargeVector<Kind> kind_;                  // by edge
  LargeVector<std::uint32_t> edge_of_use_;  // empty if each edge is one mesh edge, and so has its number
  // By use: the other use of its mesh edge. Where there is no other: kNone; where there are several, kCrowded
  // and the number of the mesh edge in crowded_.
  LargeVector<std::uint32_t> beyond_;
  base::Rows<std::uint32_t> crowded_;  // all uses of mesh edges that have more than two
};

}  // namespace sightline::occluders
