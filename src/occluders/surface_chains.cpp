#include "src/occluders/surface_chains.h"

#include <algorithm>
#include <tuple>

namespace sightline::occluders {
namespace {

// An edge at which clusters end, in the direction in which the first of its uses has a positive value.
struct BoundaryEdge {
  std::uint32_t from, to;
  std::uint32_t first_use, use_count;
};

class ChainFinder {
 public:
  ChainFinder(const SurfaceMesh& mesh, std::span<const std::uint32_t> cluster_of, SurfaceSet& set)
      : mesh_(mesh), cluster_of_(cluster_of), set_(set) {}

  void run() {
    collectEdges();
    base::Rows<BoundaryEdge> by_cluster;  // by their first cluster
    by_cluster.group(set_.clusters.size(), [&](auto&& pair) {
      for (const BoundaryEdge& edge : edges_) {
        pair(uses_[edge.first_use].cluster, edge);
      }
    });
    edges_ = {};
    set_.chains.reserve(by_cluster.items().size());
    set_.uses.reserve(uses_.size());
    set_.chain_vertices.reserve(2 * by_cluster.items().size());
    for (std::size_t c = 0; c < by_cluster.count(); ++c) {
      const std::span<BoundaryEdge> edges = by_cluster[c];
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
    listByCluster();
  }

 private:
  std::span<const ChainUse> usesOf(const BoundaryEdge& edge) const {
    return std::span(uses_).subspan(edge.first_use, edge.use_count);
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

  // Sums up, edge by edge, how the triangles of each cluster run.
  void collectEdges() {
    std::vector<ChainUse> sums;
    edges_.reserve(mesh_.edgeCount());
    uses_.reserve(mesh_.beside.items().size());
    for (std::uint32_t e = 0; e < mesh_.edgeCount(); ++e) {
      sums.clear();
      for (const std::uint32_t t : mesh_.beside[e]) {
        const std::uint32_t cluster = cluster_of_[t];
        auto at = std::find_if(sums.begin(), sums.end(),
                               [&](const ChainUse& use) { return use.cluster == cluster; });
        if (at == sums.end()) {
          at = sums.insert(sums.end(), {cluster, 0});
        }
        at->value += mesh_.triangles[t].edges[sideOf(t, e)] % 2 == 0 ? 1 : -1;
      }
      std::erase_if(sums, [](const ChainUse& use) { return use.value == 0; });
      if (sums.empty()) {
        continue;
      }
      std::sort(sums.begin(), sums.end(),
                [](const ChainUse& a, const ChainUse& b) { return a.cluster < b.cluster; });
      BoundaryEdge edge{mesh_.edge_vertices[2 * std::size_t{e}], mesh_.edge_vertices[2 * std::size_t{e} + 1],
                        static_cast<std::uint32_t>(uses_.size()), static_cast<std::uint32_t>(sums.size())};
      if (sums[0].value < 0) {
        std::swap(edge.from, edge.to);
        for (ChainUse& use : sums) {
          use.value = -use.value;
        }
      }
      uses_.insert(uses_.end(), sums.begin(), sums.end());
      edges_.push_back(edge);
    }
  }

  // No triangle has an edge twice.
  std::uint32_t sideOf(std::uint32_t triangle, std::uint32_t edge) const {
    const std::uint32_t(&edges)[3] = mesh_.triangles[triangle].edges;
    return edges[0] / 2 == edge ? 0 : edges[1] / 2 == edge ? 1 : 2;
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
        chain.first_vertex = static_cast<std::uint32_t>(set_.chain_vertices.size());
        chain.first_use = static_cast<std::uint32_t>(set_.uses.size());
        set_.chain_vertices.push_back(set_.vertices[edges[i].from]);
        for (std::size_t next = i; next < edges.size(); next = startingAt(edges[next].to)) {
          taken_[next] = 1;
          set_.chain_vertices.push_back(set_.vertices[edges[next].to]);
        }
        chain.vertex_count = static_cast<std::uint32_t>(set_.chain_vertices.size()) - chain.first_vertex;
        const std::span<const ChainUse> uses = usesOf(edges[i]);
        set_.uses.insert(set_.uses.end(), uses.begin(), uses.end());
        chain.use_count = static_cast<std::uint32_t>(uses.size());
        set_.chains.push_back(chain);
      }
    }
  }

  void listByCluster() {
    LargeVector<std::uint32_t> first;
    base::groupIntoRows(set_.clusters.size(), first, set_.cluster_chains, [&](auto&& pair) {
      for (std::uint32_t c = 0; c < set_.chains.size(); ++c) {
        for (const ChainUse& use : set_.usesOf(set_.chains[c])) {
          pair(use.cluster, c);
        }
      }
    });
    for (std::size_t c = 0; c < set_.clusters.size(); ++c) {
      set_.clusters[c].first_chain = first[c];
      set_.clusters[c].chain_count = first[c + 1] - first[c];
    }
  }

  const SurfaceMesh& mesh_;
  std::span<const std::uint32_t> cluster_of_;
  SurfaceSet& set_;
  LargeVector<BoundaryEdge> edges_;
  LargeVector<ChainUse> uses_;
  std::vector<std::uint8_t> taken_;
  std::vector<std::uint32_t> ends_;
};

}  // namespace

void findChains(const SurfaceMesh& mesh, std::span<const std::uint32_t> cluster_of, SurfaceSet& set) {
  ChainFinder(mesh, cluster_of, set).run();
}

}  // namespace sightline::occluders
