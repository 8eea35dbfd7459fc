#include "src/occluders/surfaces/surface_chains.h"

#include <algorithm>
#include <array>
#include <tuple>
#include <utility>
#include <vector>

#include "src/base/parallel_rows.h"
#include "src/base/part_store.h"
#include "src/base/scratch_array.h"
#include "src/geometry/exact_point.h"

namespace sightline::occluders {
namespace {

constexpr std::size_t kPatchesOfPart = 2048;

// An edge at which clusters end, in the direction in which the first of its uses has a positive value.
struct BoundaryEdge {
  std::uint32_t from, to;
  std::uint32_t first_use, use_count;
};

// What clusters end at the crowded edges of a mesh: the sums are made once for each edge, for each triangle
// at it would ask for them again.
class CrowdedUses {
 public:
  CrowdedUses(const SurfaceMesh& mesh, std::span<const std::uint32_t> cluster_of,
              const ParallelFor& parallel_for)
      : uses_(base::unsetVector<ChainUse>(mesh.crowded.items().size())), edges_(mesh.crowded.count()) {
    base::forEach(parallel_for, edges_.size(), [&](std::uint32_t edge) {
      const std::span<const Side> sides = mesh.crowded[edge];
      edges_[edge].first = static_cast<std::size_t>(sides.data() - mesh.crowded.items().data());
      sumUp(sides, cluster_of, edges_[edge]);
    });
  }

  // The uses of an edge, if a triangle is the first one there of the first cluster that ends at it: all
  // others are told that there are none. They count in the direction in which the first one is positive.
  std::span<const ChainUse> usesFor(std::uint32_t triangle, std::uint32_t edge) const {
    const Edge& of = edges_[edge];
    return triangle == of.triangle ? std::span(uses_).subspan(of.first, of.count)
                                   : std::span<const ChainUse>();
  }
  // Whether that direction is from the edge's higher vertex to its lower one.
  bool isReversed(std::uint32_t edge) const { return edges_[edge].reversed; }

 private:
  struct Edge {
    std::size_t first = 0;    // in uses_, where there is room for one of each side
    std::uint32_t count = 0;  // of uses
    std::uint32_t triangle = SurfaceMesh::kNone;
    bool reversed = false;
  };

  void sumUp(std::span<const Side> sides, std::span<const std::uint32_t> cluster_of, Edge& edge) {
    const std::span<ChainUse> uses = std::span(uses_).subspan(edge.first, sides.size());
    std::transform(sides.begin(), sides.end(), uses.begin(), [&](Side side) {
      return ChainUse{cluster_of[side.triangle()], side.value()};
    });
    std::sort(uses.begin(), uses.end(),
              [](const ChainUse& a, const ChainUse& b) { return a.cluster < b.cluster; });
    for (std::size_t i = 0, next = 0; i < uses.size(); i = next) {
      ChainUse sum{uses[i].cluster, 0};
      for (; next < uses.size() && uses[next].cluster == sum.cluster; ++next) {
        sum.value += uses[next].value;
      }
      if (sum.value != 0) {
        uses[edge.count++] = sum;
      }
    }
    if (edge.count == 0) {
      return;
    }
    edge.triangle = std::find_if(sides.begin(), sides.end(), [&](Side side) {
                      return cluster_of[side.triangle()] == uses[0].cluster;
                    })->triangle();
    edge.reversed = uses[0].value < 0;
    for (ChainUse& use : uses.first(edge.reversed ? edge.count : 0)) {
      use.value = -use.value;
    }
  }

  LargeVector<ChainUse> uses_;
  LargeVector<Edge> edges_;  // by number in SurfaceMesh::crowded
};

// The edges at which one cluster ends, and is the first that does. A use is how the triangles of a cluster
// run along an edge, all in all; uses are ascending by cluster.
class ClusterBoundary {
 public:
  ClusterBoundary(const SurfaceMesh& mesh, std::span<const std::uint32_t> cluster_of,
                  const CrowdedUses& crowded)
      : mesh_(mesh), cluster_of_(cluster_of), crowded_(crowded) {}

  // triangles: all of one cluster.
  void find(std::uint32_t cluster, std::span<const std::uint32_t> triangles) {
    edges_.clear();
    uses_.clear();
    for (const std::uint32_t t : triangles) {
      for (Corner corner = 3 * t; corner < 3 * t + 3; ++corner) {
        const std::uint32_t beyond = mesh_.beyond[corner];
        if (beyond == SurfaceMesh::kNone) {
          uses_.push_back({cluster, 1});
          addEdge(corner, 1);
        } else if (beyond >= SurfaceMesh::kCrowded) {
          addCrowded(corner, beyond - SurfaceMesh::kCrowded);
        } else if (const std::uint32_t other = cluster_of_[beyond / 3]; other > cluster) {
          uses_.push_back({cluster, 1});
          uses_.push_back({other, -1});
          addEdge(corner, 2);
        }
      }
    }
  }

  std::span<BoundaryEdge> edges() { return edges_; }
  std::span<const ChainUse> uses() const { return uses_; }

 private:
  // Adds the edge from a corner on, of which the last uses are.
  void addEdge(Corner corner, std::uint32_t use_count) {
    const std::array<std::uint32_t, 3>& triangle = mesh_.triangles[corner / 3];
    const std::uint32_t k = corner % 3;
    edges_.push_back({triangle[k], triangle[k == 2 ? 0 : k + 1],
                      static_cast<std::uint32_t>(uses_.size()) - use_count, use_count});
  }

  void addCrowded(Corner corner, std::uint32_t edge) {
    const std::span<const ChainUse> uses = crowded_.usesFor(corner / 3, edge);
    if (uses.empty()) {
      return;
    }
    uses_.insert(uses_.end(), uses.begin(), uses.end());
    addEdge(corner, static_cast<std::uint32_t>(uses.size()));
    BoundaryEdge& added = edges_.back();
    if ((added.from > added.to) != crowded_.isReversed(edge)) {
      std::swap(added.from, added.to);
    }
  }

  const SurfaceMesh& mesh_;
  std::span<const std::uint32_t> cluster_of_;
  const CrowdedUses& crowded_;
  std::vector<BoundaryEdge> edges_;
  std::vector<ChainUse> uses_;
};

// Chains, with numbers that count from the first vertex and use here.
struct Chains {
  std::vector<SurfaceChain> chains;
  std::vector<ChainUse> uses;
  std::vector<Vec3f> vertices;

  void clear() {
    chains.clear();
    uses.clear();
    vertices.clear();
  }
};
struct KeptChains {
  base::KeptItems<SurfaceChain> chains;
  base::KeptItems<ChainUse> uses;
  base::KeptItems<Vec3f> vertices;
};

// Joins the edges of one cluster after the other.
class ChainMaker {
 public:
  ChainMaker(std::span<const Vec3f> vertices, Chains& made) : vertices_(vertices), made_(made) {}

  // edges: those of which the cluster is the first one that ends there, with their uses. Sorts them.
  void add(std::span<BoundaryEdge> edges, std::span<const ChainUse> uses) {
    uses_ = uses;
    std::sort(edges.begin(), edges.end(), [this](const BoundaryEdge& a, const BoundaryEdge& b) {
      const int order = compareUses(a, b);
      return order != 0 ? order < 0 : std::tie(a.from, a.to) < std::tie(b.from, b.to);
    });
    for (std::size_t first = 0, last = 0; first < edges.size(); first = last) {
      while (last < edges.size() && compareUses(edges[first], edges[last]) == 0) {
        ++last;
      }
      joinEdges(edges.subspan(first, last - first));
    }
  }

 private:
  std::span<const ChainUse> usesOf(const BoundaryEdge& edge) const {
    return uses_.subspan(edge.first_use, edge.use_count);
  }
  int compareUses(const BoundaryEdge& a, const BoundaryEdge& b) const {
    const std::span<const ChainUse> p = usesOf(a), q = usesOf(b);
    for (std::size_t i = 0; i < std::min(p.size(), q.size()); ++i) {
      if (p[i].cluster != q[i].cluster || p[i].value != q[i].value) {
        return std::tie(p[i].cluster, p[i].value) < std::tie(q[i].cluster, q[i].value) ? -1 : 1;
      }
    }
    return p.size() == q.size() ? 0 : p.size() < q.size() ? -1 : 1;
  }

  // Adds the next vertex of a chain. The one before it goes if it lies on the edge from its own predecessor:
  // the same clusters end on both sides of it, so any others that end at it are a boundary without it.
  void addVertex(const Vec3f& vertex, std::uint32_t first_of_chain) {
    std::vector<Vec3f>& vertices = made_.vertices;
    if (vertices.size() >= first_of_chain + std::size_t{2} &&
        geometry::liesBetween(*(vertices.end() - 2), vertices.back(), vertex)) {
      vertices.pop_back();
    }
    vertices.push_back(vertex);
  }

  // Begins a chain with an edge, and with its uses.
  SurfaceChain chainFrom(const BoundaryEdge& edge) {
    SurfaceChain chain;
    chain.first_vertex = static_cast<std::uint32_t>(made_.vertices.size());
    chain.vertex_count = 2;
    made_.vertices.push_back(vertices_[edge.from]);
    made_.vertices.push_back(vertices_[edge.to]);
    chain.first_use = static_cast<std::uint32_t>(made_.uses.size());
    chain.use_count = edge.use_count;
    const std::span<const ChainUse> uses = usesOf(edge);
    made_.uses.insert(made_.uses.end(), uses.begin(), uses.end());
    return chain;
  }

  // Joins edges with the same uses, ascending by `from`, end to end.
  void joinEdges(std::span<const BoundaryEdge> edges) {
    if (edges.size() == 1) {
      made_.chains.push_back(chainFrom(edges[0]));  // as most of them are
      return;
    }
    taken_.assign(edges.size(), 0);
    const auto startingAt = [&](std::uint32_t vertex) {
      auto at = std::lower_bound(edges.begin(), edges.end(), vertex,
                                 [](const BoundaryEdge& e, std::uint32_t v) { return e.from < v; });
      for (; at != edges.end() && at->from == vertex; ++at) {
        const std::size_t i = static_cast<std::size_t>(at - edges.begin());
        if (taken_[i] == 0) {
          return i;
        }
      }
      return edges.size();
    };
    ends_.clear();
    for (const BoundaryEdge& edge : edges) {
      ends_.push_back(edge.to);
    }
    std::sort(ends_.begin(), ends_.end());
    // Paths that begin somewhere, and then what remains, which are loops.
    for (const bool loops : {false, true}) {
      for (std::size_t i = 0; i < edges.size(); ++i) {
        if (taken_[i] != 0 || (!loops && std::binary_search(ends_.begin(), ends_.end(), edges[i].from))) {
          continue;
        }
        SurfaceChain chain = chainFrom(edges[i]);
        taken_[i] = 1;
        for (std::size_t next = i; (next = startingAt(edges[next].to)) < edges.size();) {
          taken_[next] = 1;
          addVertex(vertices_[edges[next].to], chain.first_vertex);
        }
        chain.vertex_count = static_cast<std::uint32_t>(made_.vertices.size()) - chain.first_vertex;
        made_.chains.push_back(chain);
      }
    }
  }

  std::span<const ChainUse> uses_;
  std::span<const Vec3f> vertices_;
  Chains& made_;
  std::vector<std::uint8_t> taken_;
  std::vector<std::uint32_t> ends_;
};

// Puts the chains of all parts one after the other, and lets go of them.
void putTogether(std::span<KeptChains> parts, const ParallelFor& parallel_for, SurfaceSet& set) {
  std::vector<std::size_t> first_chain(1, 0);
  std::vector<std::uint32_t> first_use(1, 0), first_vertex(1, 0);
  for (const KeptChains& part : parts) {
    first_chain.push_back(first_chain.back() + part.chains.items.size());
    first_use.push_back(first_use.back() + static_cast<std::uint32_t>(part.uses.items.size()));
    first_vertex.push_back(first_vertex.back() + static_cast<std::uint32_t>(part.vertices.items.size()));
  }
  set.chains = base::unsetVector<SurfaceChain>(first_chain.back());
  set.uses = base::unsetVector<ChainUse>(first_use.back());
  set.chain_vertices = base::unsetVector<Vec3f>(first_vertex.back());
  base::forEach(parallel_for, parts.size(), [&](std::uint32_t number) {
    const KeptChains part = std::exchange(parts[number], {});
    std::transform(part.chains.items.begin(), part.chains.items.end(),
                   set.chains.begin() + static_cast<std::ptrdiff_t>(first_chain[number]),
                   [&](SurfaceChain chain) {
                     chain.first_use += first_use[number];
                     chain.first_vertex += first_vertex[number];
                     return chain;
                   });
    std::copy(part.uses.items.begin(), part.uses.items.end(), set.uses.begin() + first_use[number]);
    std::copy(part.vertices.items.begin(), part.vertices.items.end(),
              set.chain_vertices.begin() + first_vertex[number]);
  });
}

// Lists the triangles of a patch by cluster.
void groupTriangles(const SurfaceSet& set, const SurfacePatch& patch, const Gathered& gathered,
                    base::Rows<std::uint32_t>& by_cluster) {
  const SurfaceCluster &first = set.clusters[patch.first_cluster],
                       &last = set.clusters[patch.first_cluster + patch.cluster_count - 1];
  const std::span<const std::uint32_t> triangles =
      std::span(gathered.by_patch)
          .subspan(first.first_triangle, last.first_triangle + last.triangle_count - first.first_triangle);
  by_cluster.group(patch.cluster_count, [&](auto&& pair) {
    for (const std::uint32_t t : triangles) {
      pair(gathered.cluster_of[t] - patch.first_cluster, t);
    }
  });
}

void listByCluster(const ParallelFor& parallel_for, SurfaceSet& set) {
  LargeVector<std::uint32_t> first;
  base::groupIntoRows(parallel_for, set.clusters.size(), set.chains.size(), first, set.cluster_chains,
                      [&](std::size_t begin, std::size_t end, auto&& pair) {
                        for (std::size_t c = begin; c < end; ++c) {
                          for (const ChainUse& use : set.usesOf(set.chains[c])) {
                            pair(use.cluster, static_cast<std::uint32_t>(c));
                          }
                        }
                      });
  base::forEach(parallel_for, set.clusters.size(), [&](std::uint32_t c) {
    set.clusters[c].first_chain = first[c];
    set.clusters[c].chain_count = first[c + 1] - first[c];
  });
}

}  // namespace

void findChains(SurfaceMesh& mesh, Gathered& gathered, const ParallelFor& parallel_for, SurfaceSet& set) {
  const base::Parts parts(set.patches.size(), kPatchesOfPart);
  std::vector<KeptChains> of_part(parts.count());
  {
    base::PartStore store;
    const CrowdedUses crowded(mesh, gathered.cluster_of, parallel_for);
    parallel_for(static_cast<std::uint32_t>(parts.count()), [&](std::uint32_t first, std::uint32_t last) {
      Chains made;
      ClusterBoundary boundary(mesh, gathered.cluster_of, crowded);
      ChainMaker maker(mesh.vertices, made);
      base::Rows<std::uint32_t> by_cluster;
      for (std::uint32_t part = first; part < last; ++part) {
        made.clear();
        for (std::size_t patch = parts.begin(part); patch < parts.end(part); ++patch) {
          groupTriangles(set, set.patches[patch], gathered, by_cluster);
          for (std::uint32_t i = 0; i < by_cluster.count(); ++i) {
            boundary.find(set.patches[patch].first_cluster + i, by_cluster[i]);
            maker.add(boundary.edges(), boundary.uses());
          }
        }
        of_part[part] = {store.keep(made.chains), store.keep(made.uses), store.keep(made.vertices)};
      }
    });
  }
  mesh.forgetTriangles();
  gathered = {};
  putTogether(of_part, parallel_for, set);
  listByCluster(parallel_for, set);
}

}  // namespace sightline::occluders
