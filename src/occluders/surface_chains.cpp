#include "src/occluders/surface_chains.h"

#include <algorithm>
#include <array>
#include <tuple>
#include <vector>

#include "src/base/parallel_rows.h"
#include "src/base/part_store.h"
#include "src/base/scratch_array.h"
#include "src/geometry/exact_point.h"
#include "src/geometry/whole.h"

namespace sightline::occluders {
namespace {

using geometry::Lattice;

constexpr std::size_t kEdgesOfPart = 32768, kClustersOfPart = 2048;

// An edge at which clusters end, in the direction in which the first of its uses has a positive value.
struct BoundaryEdge {
  std::uint32_t from, to;
  std::uint32_t first_use, use_count;
};

// Boundary edges with their uses, ascending by cluster.
struct BoundaryEdges {
  LargeVector<BoundaryEdge> edges;
  LargeVector<ChainUse> uses;
};

// Those of a part of the mesh. Their uses count from the first one here.
struct FoundEdges {
  std::vector<BoundaryEdge> edges;
  std::vector<ChainUse> uses;
};
struct KeptEdges {
  std::span<BoundaryEdge> edges;
  std::span<const ChainUse> uses;
};

// Sums up, edge by edge, how the triangles of each cluster run.
class EdgeCollector {
 public:
  EdgeCollector(const SurfaceMesh& mesh, std::span<const std::uint32_t> cluster_of, FoundEdges& found)
      : mesh_(mesh), cluster_of_(cluster_of), found_(found) {}

  void add(std::span<const Side> sides) {
    if (sides.size() == 2 && sides[0].value() != sides[1].value() &&
        cluster_of_[sides[0].triangle()] == cluster_of_[sides[1].triangle()]) {
      return;  // most edges lie within one cluster, where both sides cancel
    }
    sums_.clear();
    for (const Side side : sides) {
      const std::uint32_t cluster = cluster_of_[side.triangle()];
      auto at = std::find_if(sums_.begin(), sums_.end(),
                             [&](const ChainUse& use) { return use.cluster == cluster; });
      if (at == sums_.end()) {
        at = sums_.insert(sums_.end(), {cluster, 0});
      }
      at->value += side.value();
    }
    std::erase_if(sums_, [](const ChainUse& use) { return use.value == 0; });
    if (sums_.empty()) {
      return;
    }
    std::sort(sums_.begin(), sums_.end(),
              [](const ChainUse& a, const ChainUse& b) { return a.cluster < b.cluster; });
    const auto [low, high] = mesh_.endsOf(sides[0]);
    BoundaryEdge edge{low, high, static_cast<std::uint32_t>(found_.uses.size()),
                      static_cast<std::uint32_t>(sums_.size())};
    if (sums_[0].value < 0) {
      std::swap(edge.from, edge.to);
      for (ChainUse& use : sums_) {
        use.value = -use.value;
      }
    }
    found_.uses.insert(found_.uses.end(), sums_.begin(), sums_.end());
    found_.edges.push_back(edge);
  }

 private:
  const SurfaceMesh& mesh_;
  std::span<const std::uint32_t> cluster_of_;
  FoundEdges& found_;
  std::vector<ChainUse> sums_;
};

BoundaryEdges collectEdges(const SurfaceMesh& mesh, std::span<const std::uint32_t> cluster_of,
                           const ParallelFor& parallel_for) {
  const base::Parts parts(mesh.sides.count(), kEdgesOfPart);
  base::PartStore store;
  std::vector<KeptEdges> of_part(parts.count());
  parallel_for(static_cast<std::uint32_t>(parts.count()), [&](std::uint32_t first, std::uint32_t last) {
    FoundEdges found;
    EdgeCollector collector(mesh, cluster_of, found);
    for (std::uint32_t part = first; part < last; ++part) {
      found.edges.clear();
      found.uses.clear();
      for (std::size_t edge = parts.begin(part); edge < parts.end(part); ++edge) {
        collector.add(mesh.sides[edge]);
      }
      of_part[part] = {store.keep(found.edges), store.keep(found.uses)};
    }
  });
  std::vector<std::uint32_t> first_edge(1, 0), first_use(1, 0);
  for (const KeptEdges& part : of_part) {
    first_edge.push_back(first_edge.back() + static_cast<std::uint32_t>(part.edges.size()));
    first_use.push_back(first_use.back() + static_cast<std::uint32_t>(part.uses.size()));
  }
  BoundaryEdges all{base::unsetVector<BoundaryEdge>(first_edge.back()),
                    base::unsetVector<ChainUse>(first_use.back())};
  base::forEach(parallel_for, of_part.size(), [&](std::uint32_t part) {
    for (BoundaryEdge& edge : of_part[part].edges) {
      edge.first_use += first_use[part];
    }
    std::copy(of_part[part].edges.begin(), of_part[part].edges.end(), all.edges.begin() + first_edge[part]);
    std::copy(of_part[part].uses.begin(), of_part[part].uses.end(), all.uses.begin() + first_use[part]);
  });
  return all;
}

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
  std::span<SurfaceChain> chains;
  std::span<const ChainUse> uses;
  std::span<const Vec3f> vertices;
};

// Whether p lies exactly on the edge from a to b, between its ends.
bool liesBetween(const Vec3f& a, const Vec3f& p, const Vec3f& b) {
  for (int axis = 0; axis < 3; ++axis) {
    if (p[axis] < std::min(a[axis], b[axis]) || p[axis] > std::max(a[axis], b[axis])) {
      return false;
    }
  }
  const std::array points{Vec3d(a), Vec3d(p), Vec3d(b)};
  const Vec3d to_point = points[1] - points[0], to_end = points[2] - points[0];
  // Most vertices are told apart by far more than rounding, which is below 1e-15 here.
  if (length(cross(to_point, to_end)) > 1e-12 * length(to_point) * length(to_end) ||
      !std::all_of(points.begin(), points.end(), [](const Vec3d& at) { return Lattice::allowed(at); })) {
    return false;
  }
  const Lattice lattice = Lattice::of(points);
  return geometry::orientation(lattice, 0, points[0], points[1], points[2]) == 0 &&
         geometry::orientation(lattice, 1, points[0], points[1], points[2]) == 0 &&
         geometry::orientation(lattice, 2, points[0], points[1], points[2]) == 0;
}

// Joins the edges of one cluster after the other.
class ChainMaker {
 public:
  ChainMaker(std::span<const ChainUse> uses, std::span<const Vec3f> vertices, Chains& made)
      : uses_(uses), vertices_(vertices), made_(made) {}

  // edges: those of which the cluster is the first one that ends there. Sorts them.
  void add(std::span<BoundaryEdge> edges) {
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
        liesBetween(*(vertices.end() - 2), vertices.back(), vertex)) {
      vertices.pop_back();
    }
    vertices.push_back(vertex);
  }

  // Joins edges with the same uses, ascending by `from`, end to end.
  void joinEdges(std::span<const BoundaryEdge> edges) {
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
        SurfaceChain chain;
        chain.first_vertex = static_cast<std::uint32_t>(made_.vertices.size());
        chain.first_use = static_cast<std::uint32_t>(made_.uses.size());
        made_.vertices.push_back(vertices_[edges[i].from]);
        for (std::size_t next = i; next < edges.size(); next = startingAt(edges[next].to)) {
          taken_[next] = 1;
          addVertex(vertices_[edges[next].to], chain.first_vertex);
        }
        chain.vertex_count = static_cast<std::uint32_t>(made_.vertices.size()) - chain.first_vertex;
        const std::span<const ChainUse> uses = usesOf(edges[i]);
        made_.uses.insert(made_.uses.end(), uses.begin(), uses.end());
        chain.use_count = static_cast<std::uint32_t>(uses.size());
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

// Puts the chains of all parts one after the other.
void putTogether(std::span<const KeptChains> parts, const ParallelFor& parallel_for, SurfaceSet& set) {
  std::vector<std::size_t> first_chain(1, 0);
  std::vector<std::uint32_t> first_use(1, 0), first_vertex(1, 0);
  for (const KeptChains& part : parts) {
    first_chain.push_back(first_chain.back() + part.chains.size());
    first_use.push_back(first_use.back() + static_cast<std::uint32_t>(part.uses.size()));
    first_vertex.push_back(first_vertex.back() + static_cast<std::uint32_t>(part.vertices.size()));
  }
  set.chains = base::unsetVector<SurfaceChain>(first_chain.back());
  set.uses = base::unsetVector<ChainUse>(first_use.back());
  set.chain_vertices = base::unsetVector<Vec3f>(first_vertex.back());
  base::forEach(parallel_for, parts.size(), [&](std::uint32_t number) {
    const KeptChains& part = parts[number];
    for (SurfaceChain& chain : part.chains) {
      chain.first_use += first_use[number];
      chain.first_vertex += first_vertex[number];
    }
    std::copy(part.chains.begin(), part.chains.end(),
              set.chains.begin() + static_cast<std::ptrdiff_t>(first_chain[number]));
    std::copy(part.uses.begin(), part.uses.end(), set.uses.begin() + first_use[number]);
    std::copy(part.vertices.begin(), part.vertices.end(), set.chain_vertices.begin() + first_vertex[number]);
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

void findChains(SurfaceMesh& mesh, std::span<const std::uint32_t> cluster_of, const ParallelFor& parallel_for,
                SurfaceSet& set) {
  BoundaryEdges boundary = collectEdges(mesh, cluster_of, parallel_for);
  mesh.forgetTriangles();
  base::Rows<BoundaryEdge> by_cluster;  // by their first cluster
  base::groupIntoRows(parallel_for, set.clusters.size(), boundary.edges.size(), by_cluster.first(),
                      by_cluster.all(), [&](std::size_t begin, std::size_t end, auto&& pair) {
                        for (std::size_t i = begin; i < end; ++i) {
                          pair(boundary.uses[boundary.edges[i].first_use].cluster, boundary.edges[i]);
                        }
                      });
  base::freeVector(boundary.edges);
  const base::Parts parts(set.clusters.size(), kClustersOfPart);
  base::PartStore store;
  std::vector<KeptChains> of_part(parts.count());
  parallel_for(static_cast<std::uint32_t>(parts.count()), [&](std::uint32_t first, std::uint32_t last) {
    Chains made;
    ChainMaker maker(boundary.uses, mesh.vertices, made);
    for (std::uint32_t part = first; part < last; ++part) {
      made.clear();
      for (std::size_t cluster = parts.begin(part); cluster < parts.end(part); ++cluster) {
        maker.add(by_cluster[cluster]);
      }
      of_part[part] = {store.keep(made.chains), store.keep(made.uses), store.keep(made.vertices)};
    }
  });
  by_cluster = {};
  boundary = {};
  putTogether(of_part, parallel_for, set);
  listByCluster(parallel_for, set);
}

}  // namespace sightline::occluders
