#include "src/occluders/shared_edges.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "src/base/parts.h"
#include "src/base/scratch_array.h"
#include "src/base/union_find.h"

namespace sightline::occluders {
namespace {

constexpr std::size_t kSharedEdgesOfPart = 4096;

// The vertices along an edge.
class Chain {
 public:
  Chain() = default;
  Chain(const OutlineMesh& mesh, std::uint32_t edge) {
    const FoundPolygon& polygon = mesh.polygonAt(mesh.placeOf(edge));
    const std::uint32_t corner = mesh.cornerOf(edge);
    loop_ = polygon.loop();
    begin_ = polygon.corners()[corner];
    size_ = OutlineMesh::meshEdgesFrom(polygon, corner) + 1;
  }
  std::uint32_t size() const { return size_; }
  std::uint32_t operator[](std::uint32_t i) const {
    const std::size_t at = std::size_t{begin_} + i;
    return loop_[at < loop_.size() ? at : at - loop_.size()];
  }
  bool runsAgainst(const Chain& other) const {
    bool against = size_ == other.size_;
    for (std::uint32_t i = 0; i < size_ && against; ++i) {
      against = (*this)[i] == other[size_ - 1 - i];
    }
    return against;
  }

 private:
  std::span<const std::uint32_t> loop_;
  std::uint32_t begin_ = 0, size_ = 0;
};

}  // namespace

SharedEdges::SharedEdges(const OutlineMesh& mesh, const ParallelFor& parallel_for) : mesh_(mesh) {
  group(parallel_for);
  base::Parts(shared_edges_.size(), kSharedEdgesOfPart)
      .run(parallel_for, [this](std::size_t, std::size_t begin, std::size_t end) {
        std::vector<std::uint32_t> vertices;
        for (std::size_t number = begin; number < end; ++number) {
          judge(shared_edges_[number], vertices);
          for (std::size_t i = shared_edges_[number].begin; i < shared_edges_[number].end; ++i) {
            number_of_[edgeAt(i)] = static_cast<std::uint32_t>(number);
          }
        }
      });
}

// Finds which edges belong together.
void SharedEdges::group(const ParallelFor& parallel_for) {
  for (std::uint32_t edge = 0; edge < mesh_.edgeCount(); ++edge) {
    if (!mesh_.isOneMeshEdge(edge)) {
      by_shared_edge_.push_back(
          {edge, std::uint64_t{mesh_.rankedAt(mesh_.placeOf(edge)).id.value} << 32 | edge});
    }
  }
  if (by_shared_edge_.empty()) {
    return;
  }
  // By edge, until the edges are grouped: its place among those that are not one mesh edge.
  number_of_ = base::unsetVector<std::uint32_t>(mesh_.edgeCount());
  for (std::uint32_t i = 0; i < by_shared_edge_.size(); ++i) {
    number_of_[by_shared_edge_[i].first] = i;
  }
  base::UnionFind classes(by_shared_edge_.size());
  for (std::uint32_t i = 0; i < by_shared_edge_.size(); ++i) {
    const auto edge = static_cast<std::uint32_t>(by_shared_edge_[i].first);
    const std::uint32_t first = mesh_.firstUseOf(edge);
    for (std::uint32_t use = first; use < first + mesh_.meshEdgeCount(edge); ++use) {
      mesh_.forEachBeyond(use, [&](std::uint32_t other) {
        if (other < use) {
          classes.unite(i, number_of_[mesh_.edgeOf(other)]);
        }
      });
    }
  }
  for (std::uint32_t i = 0; i < by_shared_edge_.size(); ++i) {
    by_shared_edge_[i].first = classes.root(i);
  }
  base::KeySorter().sort(by_shared_edge_, parallel_for);
  for (std::uint32_t i = 0, end = 0; i < by_shared_edge_.size(); i = end) {
    while (end < by_shared_edge_.size() && by_shared_edge_[end].first == by_shared_edge_[i].first) {
      ++end;
    }
    shared_edges_.push_back({i, end, true, 0.0f, {}});
  }
}

// Lists the vertices along all edges: of each edge in the order in which its mesh edges are visited, the
// lower vertex of each first. An edge that runs back along the one before it adds nothing.
void SharedEdges::listVertices(const SharedEdge& shared, std::vector<std::uint32_t>& vertices) const {
  vertices.clear();
  Chain before;
  for (std::size_t i = shared.begin; i < shared.end; ++i) {
    const Chain chain(mesh_, edgeAt(i));
    if (chain.runsAgainst(before)) {
      continue;
    }
    const std::size_t first = vertices.size();
    for (std::uint32_t k = 0; k < chain.size(); ++k) {
      vertices.push_back(chain[k]);
    }
    if (vertices[first] > vertices[first + 1]) {
      std::swap(vertices[first], vertices[first + 1]);
    }
    before = chain;
  }
}

std::array<Vec3f, 2> SharedEdges::ownLine(std::uint32_t edge) const {
  const std::array<std::uint32_t, 2> ends = mesh_.endsOf(edge);
  return {mesh_.position(ends[0]), mesh_.position(ends[1])};
}

// The line for all edges along a shared one: through their outermost mesh vertices, in the direction of the
// longest of them.
std::array<Vec3f, 2> SharedEdges::lineOf(const SharedEdge& shared,
                                         std::span<const std::uint32_t> vertices) const {
  std::array<Vec3f, 2> line = ownLine(edgeAt(shared.begin));
  if (shared.end - shared.begin == 1) {
    return line;
  }
  double longest = 0.0;
  Vec3d along;
  for (std::size_t i = shared.begin; i < shared.end; ++i) {
    const std::array<Vec3f, 2> own = ownLine(edgeAt(i));
    const Vec3d d = Vec3d(own[1]) - Vec3d(own[0]);
    if (length(d) > longest) {
      longest = length(d);
      along = d;
    }
  }
  double low = 0.0, high = 0.0;
  bool first = true;
  for (const std::uint32_t vertex : vertices) {
    const Vec3f& p = mesh_.position(vertex);
    const double t = dot(along, Vec3d(p));
    if (first || t < low) {
      low = t;
      line[0] = p;
    }
    if (first || t > high) {
      high = t;
      line[1] = p;
    }
    first = false;
  }
  return line;
}

// Chooses the line of a shared edge. Where a vertex is farther from it than rounding explains, each occluder
// edge keeps a line of its own, and the shared edge is not watertight. vertices: scratch.
void SharedEdges::judge(SharedEdge& shared, std::vector<std::uint32_t>& vertices) const {
  listVertices(shared, vertices);
  shared.line = lineOf(shared, vertices);
  const Vec3d from(shared.line[0]), along = Vec3d(shared.line[1]) - from;
  const double size = length(along);
  double deviation = 0.0, largest = 0.0;
  for (const std::uint32_t vertex : vertices) {
    const Vec3f& p = mesh_.position(vertex);
    const Vec3d off = size > 0.0 ? cross(along, Vec3d(p) - from) : Vec3d(p) - from;
    deviation = std::max(deviation, dot(off, off));
    largest = std::max(largest, static_cast<double>(maxComponent(abs(p))));
  }
  deviation = size > 0.0 ? std::sqrt(deviation) / size : std::sqrt(deviation);
  shared.one_line = deviation <= 4.0 * roundingTolerance(largest);
  shared.deviation = shared.one_line ? static_cast<float>(deviation * 1.001) : 0.0f;
}

}  // namespace sightline::occluders
