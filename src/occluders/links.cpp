// Which occluders share edges of the mesh. Two polygons that have a mesh edge in common leave no gap between
// them. So that the occlusion structures stay watertight there, all occluder edges along one shared edge are
// put on one line, given by two mesh vertices, and each of them knows which polygons lie beyond each of the
// mesh edges that it was merged from.
//
// Polygons are ranked by area, and neighbours are of any rank. So everything is numbered by place first, in
// the order of the polygons as they are given, where neighbours are close in memory; and what the set holds
// by rank is written from there.

#include "src/occluders/links.h"

#include <hwy/cache_control.h>

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include "src/base/parallel_rows.h"
#include "src/base/union_find.h"
#include "src/occluders/occluder_limits.h"

namespace sightline::occluders {
namespace {

constexpr std::size_t kPolygonsOfPart = 4096, kLowVerticesOfPart = 16384;

double distanceToLine(const Vec3d& point, const Vec3d& p, const Vec3d& q) {
  const Vec3d d = q - p;
  const double l = length(d);
  return l > 0.0 ? length(cross(d, point - p)) / l : length(point - p);
}

// Links the edges of a set. "Place" is the number of a polygon among the given ones, "edge" that of an
// occluder edge in their order, "use" that of a mesh edge on an occluder edge; "rank" is the number of an
// occluder edge in the set.
class Linker {
 public:
  // first_vertex: by place, in the set.
  Linker(std::span<const Vec3f> positions, std::span<const RankedPolygon> polygons,
         LargeVector<std::uint32_t> first_vertex, const ParallelFor& parallel_for, OccluderSet& set)
      : positions_(positions),
        polygons_(polygons),
        parallel_for_(parallel_for),
        set_(set),
        first_vertex_(std::move(first_vertex)) {}

  // Fills edges, lines and neighbours, and adds to the slack of occluders.
  void run() {
    numberEdges();

    groupUses();

    findSharedEdges();

    countLists();

    placeLists();

    writeLines();

    writeNeighbours();

    shareSlack();
  }

 private:
  enum class EdgeKind : std::uint8_t {
    kOneMeshEdge,     // and so is each edge that shares it
    kFirstOnLine,     // the same, and of the edges that share it the one with the lowest rank
    kSeveral,         // it, or one that shares a mesh edge with it, has several mesh edges
    kNeverWatertight  // of those
  };
  struct Use {
    std::uint32_t high = 0, use = 0;  // the mesh edge's higher vertex
    friend auto operator<=>(const Use&, const Use&) = default;
  };
  // Edges that share mesh edges, directly or by others. Some of them have several mesh edges.
  struct SharedEdge {
    std::uint32_t begin = 0, end = 0;  // in by_shared_edge_
    bool one_line = true;              // false: each edge has a line of its own, and none is watertight
    float deviation = 0.0f;            // of mesh vertices from the line, rounded up
    std::array<Vec3f, 2> line{};       // of all, if they have one
  };

  const FoundPolygon& polygonOf(std::uint32_t edge) const { return *polygons_[place_of_edge_[edge]].polygon; }
  std::uint32_t cornerOf(std::uint32_t edge) const { return edge - first_edge_[place_of_edge_[edge]]; }
  std::uint32_t rankOf(std::uint32_t edge) const {
    return first_vertex_[place_of_edge_[edge]] + cornerOf(edge);
  }
  // Mesh edges from a corner to another one.
  static std::uint32_t meshEdges(const FoundPolygon& polygon, std::uint32_t from, std::uint32_t to) {
    return polygon.corners()[to] >= polygon.corners()[from]
               ? polygon.corners()[to] - polygon.corners()[from]
               : polygon.corners()[to] + static_cast<std::uint32_t>(polygon.loop().size()) -
                     polygon.corners()[from];
  }
  static std::uint32_t nextCorner(const FoundPolygon& polygon, std::uint32_t corner) {
    return corner + 1 < polygon.corners().size() ? corner + 1 : 0;
  }
  std::uint32_t meshEdgeCount(std::uint32_t edge) const {
    const FoundPolygon& polygon = polygonOf(edge);
    return meshEdges(polygon, cornerOf(edge), nextCorner(polygon, cornerOf(edge)));
  }
  std::uint32_t firstUse(std::uint32_t edge) const {
    return first_use_[place_of_edge_[edge]] + meshEdges(polygonOf(edge), 0, cornerOf(edge));
  }
  std::array<Vec3f, 2> ownLine(std::uint32_t edge) const {
    const FoundPolygon& polygon = polygonOf(edge);
    const std::uint32_t corner = cornerOf(edge), next = nextCorner(polygon, corner);
    return {positions_[polygon.loop()[polygon.corners()[corner]]],
            positions_[polygon.loop()[polygon.corners()[next]]]};
  }
  // Visits both ends of each mesh edge of an edge, the lower vertex first.
  template <typename Visit>
  void forEachMeshEdgeEnd(std::uint32_t edge, Visit visit) const {
    const FoundPolygon& polygon = polygonOf(edge);
    std::size_t at = polygon.corners()[cornerOf(edge)];
    for (std::uint32_t left = meshEdgeCount(edge); left > 0; --left) {
      const std::uint32_t from = polygon.loop()[at];
      at = at + 1 < polygon.loop().size() ? at + 1 : 0;
      visit(positions_[std::min(from, polygon.loop()[at])]);
      visit(positions_[std::max(from, polygon.loop()[at])]);
    }
  }

  void numberEdges() {
    first_edge_.resize(polygons_.size() + 1);
    first_use_.resize(polygons_.size() + 1);
    const base::Parts parts(polygons_.size(), kPolygonsOfPart);
    parts.run(parallel_for_, [this](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const FoundPolygon& polygon = *polygons_[i].polygon;
        first_edge_[i + 1] = static_cast<std::uint32_t>(polygon.corners().size());
        first_use_[i + 1] = static_cast<std::uint32_t>(polygon.loop().size());
      }
    });
    std::partial_sum(first_edge_.begin(), first_edge_.end(), first_edge_.begin());
    std::partial_sum(first_use_.begin(), first_use_.end(), first_use_.begin());
    place_of_edge_ = base::unsetVector<std::uint32_t>(first_edge_.back());
    kind_ = base::unsetVector<EdgeKind>(first_edge_.back());
    edge_of_use_ = base::unsetVector<std::uint32_t>(first_use_.back());
    set_.edges.resize(first_edge_.back());
    parts.run(parallel_for_, [this](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        std::uint32_t use = first_use_[i];
        for (std::uint32_t edge = first_edge_[i]; edge < first_edge_[i + 1]; ++edge) {
          place_of_edge_[edge] = static_cast<std::uint32_t>(i);
          const std::uint32_t count = meshEdgeCount(edge);
          kind_[edge] = count == 1 ? EdgeKind::kOneMeshEdge : EdgeKind::kSeveral;
          std::fill_n(edge_of_use_.begin() + use, count, edge);
          use += count;
        }
      }
    });
  }

  void groupUses() {
    base::groupIntoRows(parallel_for_, positions_.size(), polygons_.size(), by_vertex_.first(),
                        by_vertex_.all(), [this](std::size_t begin, std::size_t end, auto&& pair) {
                          for (std::size_t i = begin; i < end; ++i) {
                            const std::span<const std::uint32_t> loop = polygons_[i].polygon->loop();
                            std::size_t at = polygons_[i].polygon->corners()[0];
                            for (std::uint32_t use = first_use_[i]; use < first_use_[i + 1]; ++use) {
                              const std::uint32_t from = loop[at];
                              at = at + 1 < loop.size() ? at + 1 : 0;
                              pair(std::min(from, loop[at]), Use{std::max(from, loop[at]), use});
                            }
                          }
                        });
    base::Parts(by_vertex_.count(), kLowVerticesOfPart)
        .run(parallel_for_, [this](std::size_t, std::size_t begin, std::size_t end) {
          for (std::size_t low = begin; low < end; ++low) {
            std::sort(by_vertex_[low].begin(), by_vertex_[low].end());
          }
        });
  }

  // Visits the uses of each mesh edge of the lower vertices `begin` to `end`.
  template <typename Visit>
  void forEachMeshEdge(std::size_t begin, std::size_t end, Visit visit) const {
    for (std::size_t low = begin; low < end; ++low) {
      const std::span<const Use> uses = by_vertex_[low];
      for (std::size_t i = 0, next = 0; i < uses.size(); i = next) {
        while (next < uses.size() && uses[next].high == uses[i].high) {
          ++next;
        }
        visit(uses.subspan(i, next - i));
      }
    }
  }
  template <typename Visit>
  void forEachMeshEdge(Visit visit) const {
    base::Parts(by_vertex_.count(), kLowVerticesOfPart)
        .run(parallel_for_,
             [&](std::size_t, std::size_t begin, std::size_t end) { forEachMeshEdge(begin, end, visit); });
  }
  // Calls visit(edge, edge of the set) for all edges. Those of the set lie anywhere in memory, by rank, so
  // they are asked for early.
  template <typename Visit>
  void forEachEdgeOfSet(Visit visit) const {
    constexpr std::size_t kAhead = 8;
    base::Parts(polygons_.size(), kPolygonsOfPart)
        .run(parallel_for_, [&](std::size_t, std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i) {
            if (i + kAhead < end) {
              hwy::Prefetch(&set_.edges[first_vertex_[i + kAhead]]);
            }
            for (std::uint32_t edge = first_edge_[i]; edge < first_edge_[i + 1]; ++edge) {
              visit(edge, set_.edges[first_vertex_[i] + edge - first_edge_[i]]);
            }
          }
        });
  }
  bool isOneMeshEdge(std::uint32_t edge) const {
    return kind_[edge] == EdgeKind::kOneMeshEdge || kind_[edge] == EdgeKind::kFirstOnLine;
  }
  bool isOneMeshEdge(std::span<const Use> users) const { return isOneMeshEdge(edge_of_use_[users[0].use]); }

  // Finds the edges that are not just one mesh edge, and which of them belong together.
  void findSharedEdges() {
    forEachMeshEdge([this](std::span<const Use> users) {
      const auto isOne = [this](const Use& use) {
        return kind_[edge_of_use_[use.use]] == EdgeKind::kOneMeshEdge;
      };
      if (!std::all_of(users.begin(), users.end(), isOne)) {
        for (const Use& use : users) {
          if (isOne(use)) {  // so no other thread looks at this edge
            kind_[edge_of_use_[use.use]] = EdgeKind::kSeveral;
          }
        }
      }
    });
    for (std::uint32_t edge = 0; edge < kind_.size(); ++edge) {
      if (kind_[edge] == EdgeKind::kSeveral) {
        by_shared_edge_.push_back({edge, rankOf(edge)});
      }
    }
    if (by_shared_edge_.empty()) {
      return;
    }
    base::UnionFind classes(kind_.size());
    forEachMeshEdge(0, by_vertex_.count(), [&](std::span<const Use> users) {
      for (const Use& use : users.subspan(isOneMeshEdge(users) ? users.size() : 1)) {
        classes.unite(edge_of_use_[users[0].use], edge_of_use_[use.use]);
      }
    });
    for (base::SortKey& key : by_shared_edge_) {
      const auto edge = static_cast<std::uint32_t>(key.first);
      key = {std::uint64_t{classes.root(edge)}, key.second << 32 | edge};
    }
    base::KeySorter().sort(by_shared_edge_, parallel_for_);
    for (std::uint32_t i = 0, end = 0; i < by_shared_edge_.size(); i = end) {
      while (end < by_shared_edge_.size() && by_shared_edge_[end].first == by_shared_edge_[i].first) {
        ++end;
      }
      shared_edges_.push_back({i, end, true, 0.0f, {}});
    }
  }

  // The edges of a shared one, by rank.
  std::uint32_t edgeAt(std::size_t i) const {
    return static_cast<std::uint32_t>(by_shared_edge_[i].second & 0xffffffffu);
  }
  template <typename Visit>
  void forEachEdge(const SharedEdge& shared, Visit visit) const {
    for (std::size_t i = shared.begin; i < shared.end; ++i) {
      visit(edgeAt(i));
    }
  }

  // The line for all edges along a shared one: through their outermost mesh vertices, in the direction of the
  // longest of them.
  std::array<Vec3f, 2> lineOf(const SharedEdge& shared) const {
    std::array<Vec3f, 2> line = ownLine(edgeAt(shared.begin));
    if (shared.end - shared.begin == 1) {
      return line;
    }
    double longest = 0.0;
    Vec3d along;
    forEachEdge(shared, [&](std::uint32_t edge) {
      const auto own = ownLine(edge);
      const Vec3d d = Vec3d(own[1]) - Vec3d(own[0]);
      if (length(d) > longest) {
        longest = length(d);
        along = d;
      }
    });
    double low = 0.0, high = 0.0;
    bool first = true;
    forEachEdge(shared, [&](std::uint32_t edge) {
      forEachMeshEdgeEnd(edge, [&](const Vec3f& p) {
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
      });
    });
    return line;
  }

  // Chooses the line of a shared edge. Where a vertex is farther from it than rounding explains, each
  // occluder edge keeps a line of its own, and the shared edge is not watertight.
  void judge(SharedEdge& shared) const {
    shared.line = lineOf(shared);
    const Vec3d from(shared.line[0]), to(shared.line[1]);
    double deviation = 0.0, largest = 0.0;
    forEachEdge(shared, [&](std::uint32_t edge) {
      forEachMeshEdgeEnd(edge, [&](const Vec3f& p) {
        deviation = std::max(deviation, distanceToLine(Vec3d(p), from, to));
        largest = std::max(largest, static_cast<double>(maxComponent(abs(p))));
      });
    });
    shared.one_line = deviation <= 4.0 * roundingTolerance(largest);
    shared.deviation = shared.one_line ? static_cast<float>(deviation * 1.001) : 0.0f;
  }

  // The users have a mesh edge that is all of each of their edges. Returns the edge with the lowest rank.
  std::uint32_t firstByRank(std::span<const Use> users) const {
    std::uint32_t first = edge_of_use_[users[0].use];
    for (const Use& use : users.subspan(1)) {
      const std::uint32_t edge = edge_of_use_[use.use];
      first = rankOf(edge) < rankOf(first) ? edge : first;
    }
    return first;
  }

  // Lines are numbered by the first edge on each of them, and vertices along edges by edge: until
  // placeLists(), an edge of the set has its counts of both in place of the first numbers.
  void countLists() {
    forEachMeshEdge([this](std::span<const Use> users) {
      if (isOneMeshEdge(users)) {
        kind_[firstByRank(users)] = EdgeKind::kFirstOnLine;
      }
    });
    forEachEdgeOfSet([this](std::uint32_t edge, OccluderEdge& counts) {
      if (isOneMeshEdge(edge)) {
        counts.mesh_edge_count = 1;
        counts.line = kind_[edge] == EdgeKind::kFirstOnLine ? 1 : 0;
      }
    });
    base::forEach(parallel_for_, shared_edges_.size(), [this](std::uint32_t number) {
      SharedEdge& shared = shared_edges_[number];
      judge(shared);
      forEachEdge(shared, [&](std::uint32_t edge) {
        OccluderEdge& counts = set_.edges[rankOf(edge)];
        const std::uint32_t count = meshEdgeCount(edge);
        const bool few = count <= kMaxMeshEdges;
        counts.mesh_edge_count = static_cast<std::uint16_t>(few && shared.one_line ? count : 0);
        counts.first_edge_vertex = few ? count - 1 : 0;
        kind_[edge] = counts.mesh_edge_count == 0 ? EdgeKind::kNeverWatertight : EdgeKind::kSeveral;
      });
      set_.edges[rankOf(edgeAt(shared.begin))].line =
          shared.one_line ? 1 : static_cast<std::uint32_t>(shared.end - shared.begin);
    });
    for (const SharedEdge& shared : shared_edges_) {
      forEachEdge(shared, [&](std::uint32_t edge) {
        Occluder& occluder = set_.occluders[polygons_[place_of_edge_[edge]].id.value];
        occluder.slack = std::max(occluder.slack, shared.deviation);
      });
    }
  }

  void placeLists() {
    std::uint32_t lines = 0, vertices = 0;
    for (OccluderEdge& edge : set_.edges) {
      lines += std::exchange(edge.line, lines);
      vertices += std::exchange(edge.first_edge_vertex, vertices);
    }
    set_.lines = base::unsetVector<std::array<Vec3f, 2>>(lines);  // each edge's line is written
    set_.edge_vertices.resize(vertices);
  }

  void writeLines() {
    LargeVector<std::uint32_t> line_of = base::unsetVector<std::uint32_t>(kind_.size());  // by edge
    forEachEdgeOfSet([&](std::uint32_t edge, const OccluderEdge& counted) {
      if (kind_[edge] == EdgeKind::kFirstOnLine) {
        line_of[edge] = counted.line;
        set_.lines[counted.line] = ownLine(edge);
      }
    });
    forEachMeshEdge([&](std::span<const Use> users) {
      if (isOneMeshEdge(users)) {
        const auto first = std::find_if(users.begin(), users.end(), [this](const Use& use) {
          return kind_[edge_of_use_[use.use]] == EdgeKind::kFirstOnLine;
        });
        for (const Use& use : users) {
          line_of[edge_of_use_[use.use]] = line_of[edge_of_use_[first->use]];
        }
      }
    });
    forEachEdgeOfSet([&](std::uint32_t edge, OccluderEdge& written) {
      if (kind_[edge] == EdgeKind::kOneMeshEdge) {
        written.line = line_of[edge];
      }
    });
    base::forEach(parallel_for_, shared_edges_.size(), [this](std::uint32_t number) {
      const SharedEdge& shared = shared_edges_[number];
      std::uint32_t line = set_.edges[rankOf(edgeAt(shared.begin))].line;
      if (shared.one_line) {
        set_.lines[line] = shared.line;
      }
      forEachEdge(shared, [&](std::uint32_t edge) {
        OccluderEdge& written = set_.edges[rankOf(edge)];
        written.line = line;
        if (!shared.one_line) {
          set_.lines[line++] = ownLine(edge);
        }
        writeEdgeVertices(edge, written.first_edge_vertex);
      });
    });
  }

  void writeEdgeVertices(std::uint32_t edge, std::uint32_t first) {
    const FoundPolygon& polygon = polygonOf(edge);
    const std::uint32_t count = meshEdgeCount(edge);
    for (std::uint32_t k = 1; k < count && count <= kMaxMeshEdges; ++k) {
      const std::size_t at = (polygon.corners()[cornerOf(edge)] + k) % polygon.loop().size();
      set_.edge_vertices[first + k - 1] = positions_[polygon.loop()[at]];
    }
  }

  // At a mesh edge of too many polygons none has neighbours, so that there are no more of them in all than a
  // multiple of the mesh edges. This is as safe as if the polygons had edges of their own there, which do not
  // quite coincide: each of them is open and inset (docs/conservative.md).
  void writeNeighbours() {
    static_assert(kMaxMeshEdges * (kMaxPolygonsAtEdge - 1) <=
                  std::numeric_limits<decltype(OccluderEdge::neighbour_count)>::max());
    LargeVector<std::uint8_t> joins(polygons_.size());  // by place
    constexpr std::uint32_t kAhead = 16;                // occluders lie by rank, too
    base::forEach(parallel_for_, polygons_.size(), [&](std::uint32_t i) {
      if (i + kAhead < polygons_.size()) {
        hwy::Prefetch(&set_.occluders[polygons_[i + kAhead].id.value].watertight_edges);
      }
      joins[i] = set_.occluders[polygons_[i].id.value].watertight_edges ? 1 : 0;
    });
    LargeVector<std::uint32_t> first;
    base::groupIntoRows(parallel_for_, set_.edges.size(), by_vertex_.count(), first, set_.neighbours,
                        [&](std::size_t begin, std::size_t end, auto&& pair) {
                          forEachMeshEdge(begin, end, [&](std::span<const Use> users) {
                            if (users.size() > kMaxPolygonsAtEdge) {
                              return;
                            }
                            for (const Use& a : users) {
                              const std::uint32_t edge = edge_of_use_[a.use], place = place_of_edge_[edge];
                              if (kind_[edge] == EdgeKind::kNeverWatertight) {
                                continue;
                              }
                              const std::uint32_t mesh_edge =
                                  isOneMeshEdge(edge) ? 0 : a.use - firstUse(edge);
                              for (const Use& b : users) {
                                const std::uint32_t other = place_of_edge_[edge_of_use_[b.use]];
                                if (other != place && joins[other] != 0) {
                                  pair(rankOf(edge), EdgeNeighbour{polygons_[other].id, mesh_edge});
                                }
                              }
                            }
                          });
                        });
    base::forEach(parallel_for_, set_.edges.size(), [&](std::uint32_t e) {
      const std::uint32_t count = first[e + 1] - first[e];
      if (count > 0) {
        set_.edges[e].first_neighbour = first[e];
        set_.edges[e].neighbour_count = static_cast<std::uint16_t>(count);
        std::sort(set_.neighbours.begin() + first[e], set_.neighbours.begin() + first[e + 1],
                  [](const EdgeNeighbour& a, const EdgeNeighbour& b) {
                    return std::tie(a.mesh_edge, a.occluder) < std::tie(b.mesh_edge, b.occluder);
                  });
      }
    });
  }

  // An occluder's slack also bounds that of its neighbours: the uncertain outline of a neighbour begins at
  // the end of the edge that both share.
  void shareSlack() {
    LargeVector<float> slack;
    slack.reserve(set_.occluders.size());
    for (const Occluder& occluder : set_.occluders) {
      slack.push_back(occluder.slack);
    }
    base::forEach(parallel_for_, set_.occluders.size(), [&](std::uint32_t id) {
      Occluder& occluder = set_.occluders[id];
      for (const OccluderEdge& edge : set_.edgesOf(occluder)) {
        for (const EdgeNeighbour& neighbour : set_.neighboursOf(edge)) {
          occluder.slack = std::max(occluder.slack, slack[neighbour.occluder.value]);
        }
      }
    });
  }

  std::span<const Vec3f> positions_;
  std::span<const RankedPolygon> polygons_;
  const ParallelFor& parallel_for_;
  OccluderSet& set_;
  LargeVector<std::uint32_t> first_vertex_, first_edge_, first_use_;  // by place; the first is in the set
  LargeVector<std::uint32_t> place_of_edge_;
  LargeVector<EdgeKind> kind_;  // by edge
  LargeVector<std::uint32_t> edge_of_use_;
  base::Rows<Use> by_vertex_;  // by their lower vertex, sorted by mesh edge
  // This lists the edges of the kind kSeveral, by the first edge that each is joined with, by rank and by
  // edge.
  LargeVector<base::SortKey> by_shared_edge_;
  std::vector<SharedEdge> shared_edges_;
};

}  // namespace

void linkEdges(std::span<const Vec3f> positions, std::span<const RankedPolygon> polygons,
               LargeVector<std::uint32_t> first_vertex, const ParallelFor& parallel_for, OccluderSet& set) {
  Linker(positions, polygons, std::move(first_vertex), parallel_for, set).run();
}

}  // namespace sightline::occluders
