// Which occluders share edges of the mesh. Two polygons that have a mesh edge in common leave no gap between
// them. So that the occlusion structures stay watertight there, all occluder edges along one shared edge are
// put on one line, given by two mesh vertices, and each of them knows which polygons lie beyond each of the
// mesh edges that it was merged from.

#include "src/occluders/links.h"

#include <algorithm>
#include <tuple>

#include "src/base/rows.h"
#include "src/base/union_find.h"
#include "src/occluders/bodies.h"

namespace sightline::occluders {
namespace {

// One mesh edge on one occluder edge.
struct Use {
  std::uint32_t low, high;  // vertex ids
  std::uint32_t edge;       // into OccluderSet::edges
  std::uint32_t mesh_edge;  // number within the occluder edge, from 0
};

// Edges of more mesh edges are never watertight: the open ones are told by 64 bits.
constexpr std::uint32_t kMaxMeshEdges = 64;

double distanceToLine(const Vec3d& point, const Vec3d& p, const Vec3d& q) {
  const Vec3d d = q - p;
  const double l = length(d);
  return l > 0.0 ? length(cross(d, point - p)) / l : length(point - p);
}

class Linker {
 public:
  Linker(std::span<const Vec3f> positions, std::span<const RankedPolygon> polygons, OccluderSet& set)
      : positions_(positions), polygons_(polygons), set_(set), classes_(set.edges.size()) {}

  void run() {
    collectUses();
    uniteSharedEdges();
    chooseLines();
    writeNeighbours();
    shareSlack();
  }

 private:
  void collectUses() {
    for (std::size_t o = 0; o < polygons_.size(); ++o) {
      const FoundPolygon& polygon = polygons_[o].polygon;
      const std::size_t n = polygon.loop.size(), c = polygon.corners.size();
      for (std::size_t e = 0; e < c; ++e) {
        const std::uint32_t edge = set_.occluders[o].first_vertex + static_cast<std::uint32_t>(e);
        owner_.push_back(static_cast<std::uint32_t>(o));
        std::uint32_t count = 0;
        std::size_t i = polygon.corners[e];
        do {
          const std::uint32_t a = polygon.loop[i], b = polygon.loop[(i + 1) % n];
          uses_.push_back({std::min(a, b), std::max(a, b), edge, count++});
          i = (i + 1) % n;
        } while (i != polygon.corners[(e + 1) % c]);
        set_.edges[edge].mesh_edge_count = static_cast<std::uint16_t>(count <= kMaxMeshEdges ? count : 0);
        set_.edges[edge].first_edge_vertex = static_cast<std::uint32_t>(set_.edge_vertices.size());
        for (std::uint32_t k = 1; k < count && count <= kMaxMeshEdges; ++k) {
          set_.edge_vertices.push_back(positions_[polygon.loop[(polygon.corners[e] + k) % n]]);
        }
        first_use_.push_back(static_cast<std::uint32_t>(uses_.size()) - count);
        mesh_edge_count_.push_back(count);
      }
    }
    by_vertex_.group(positions_.size(), [this](auto&& pair) {
      for (const Use& use : uses_) {
        pair(use.low, use);
      }
    });
    for (std::size_t low = 0; low < by_vertex_.count(); ++low) {
      std::sort(by_vertex_[low].begin(), by_vertex_[low].end(), [](const Use& a, const Use& b) {
        return std::tie(a.high, a.edge, a.mesh_edge) < std::tie(b.high, b.edge, b.mesh_edge);
      });
    }
  }

  template <typename Visit>
  void forEachSharedMeshEdge(Visit visit) const {
    const std::span<const Use> uses = by_vertex_.items();
    for (std::size_t i = 0; i < uses.size();) {
      std::size_t end = i + 1;
      while (end < uses.size() && uses[end].low == uses[i].low && uses[end].high == uses[i].high) {
        ++end;
      }
      if (end - i > 1) {
        visit(uses.subspan(i, end - i));
      }
      i = end;
    }
  }

  void uniteSharedEdges() {
    forEachSharedMeshEdge([this](std::span<const Use> users) {
      for (const Use& use : users.subspan(1)) {
        classes_.unite(users[0].edge, use.edge);
      }
    });
  }

  // Visits the ends of each mesh edge of an occluder edge.
  template <typename Visit>
  void forEachVertex(std::uint32_t edge, Visit visit) const {
    for (std::uint32_t k = 0; k < mesh_edge_count_[edge]; ++k) {
      const Use& use = uses_[first_use_[edge] + k];
      visit(positions_[use.low]);
      visit(positions_[use.high]);
    }
  }

  std::array<Vec3f, 2> ownLine(std::uint32_t edge) const {
    const Occluder& occluder = set_.occluders[owner_[edge]];
    const std::uint32_t next =
        edge + 1 == occluder.first_vertex + occluder.vertex_count ? occluder.first_vertex : edge + 1;
    return {set_.vertices[edge], set_.vertices[next]};
  }

  void chooseLines() {
    base::Rows<std::uint32_t> by_class;
    by_class.group(set_.edges.size(), [this](auto&& pair) {
      for (std::uint32_t edge = 0; edge < set_.edges.size(); ++edge) {
        pair(classes_.root(edge), edge);
      }
    });
    for (std::size_t c = 0; c < by_class.count(); ++c) {
      if (!by_class[c].empty()) {
        chooseLine(by_class[c]);
      }
    }
  }

  // Chooses one line for all occluder edges along a shared edge: through their outermost mesh vertices, in
  // the direction of the longest of them. Where a vertex is farther from that line than rounding explains,
  // each occluder edge keeps a line of its own, and the shared edge is not watertight.
  void chooseLine(std::span<const std::uint32_t> shared) {
    std::array<Vec3f, 2> line = ownLine(shared[0]);
    if (shared.size() > 1) {
      double longest = 0.0;
      Vec3d along;
      for (const std::uint32_t edge : shared) {
        const auto own = ownLine(edge);
        const Vec3d d = Vec3d(own[1]) - Vec3d(own[0]);
        if (length(d) > longest) {
          longest = length(d);
          along = d;
        }
      }
      double low = 0.0, high = 0.0;
      bool first = true;
      for (const std::uint32_t edge : shared) {
        forEachVertex(edge, [&](const Vec3f& p) {
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
      }
    }
    double deviation = 0.0, largest = 0.0;
    for (const std::uint32_t edge : shared) {
      forEachVertex(edge, [&](const Vec3f& p) {
        deviation = std::max(deviation, distanceToLine(Vec3d(p), Vec3d(line[0]), Vec3d(line[1])));
        largest = std::max(largest, static_cast<double>(maxComponent(abs(p))));
      });
    }
    if (deviation <= 4.0 * roundingTolerance(largest)) {
      assign(shared, line, deviation);
      return;
    }
    for (const std::uint32_t edge : shared) {
      set_.edges[edge].mesh_edge_count = 0;
      assign(std::span(&edge, 1), ownLine(edge), 0.0);
    }
  }

  void assign(std::span<const std::uint32_t> edges, const std::array<Vec3f, 2>& line, double deviation) {
    for (const std::uint32_t edge : edges) {
      set_.edges[edge].line = static_cast<std::uint32_t>(set_.lines.size());
      Occluder& occluder = set_.occluders[owner_[edge]];
      occluder.slack = std::max(occluder.slack, static_cast<float>(deviation * 1.001));
    }
    set_.lines.push_back(line);
  }

  void writeNeighbours() {
    base::Rows<EdgeNeighbour> by_edge;
    by_edge.group(set_.edges.size(), [this](auto&& pair) {
      forEachSharedMeshEdge([&](std::span<const Use> users) {
        for (const Use& a : users) {
          for (const Use& b : users) {
            if (owner_[a.edge] != owner_[b.edge] && set_.edges[a.edge].mesh_edge_count != 0 &&
                set_.occluders[owner_[b.edge]].watertight_edges) {
              pair(a.edge, EdgeNeighbour{OccluderId(owner_[b.edge]), a.mesh_edge});
            }
          }
        }
      });
    });
    set_.neighbours.reserve(by_edge.items().size());
    for (std::size_t e = 0; e < by_edge.count(); ++e) {
      const std::span<EdgeNeighbour> neighbours = by_edge[e];
      if (neighbours.empty()) {
        continue;
      }
      std::sort(neighbours.begin(), neighbours.end(), [](const EdgeNeighbour& a, const EdgeNeighbour& b) {
        return std::tie(a.mesh_edge, a.occluder) < std::tie(b.mesh_edge, b.occluder);
      });
      OccluderEdge& edge = set_.edges[e];
      edge.first_neighbour = static_cast<std::uint32_t>(set_.neighbours.size());
      edge.neighbour_count = static_cast<std::uint16_t>(neighbours.size() <= 0xffff ? neighbours.size() : 0);
      set_.neighbours.insert(set_.neighbours.end(), neighbours.begin(), neighbours.end());
    }
  }

  // An occluder's slack also bounds that of its neighbours: the uncertain outline of a neighbour begins at
  // the end of the edge that both share.
  void shareSlack() {
    std::vector<float> slack;
    for (const Occluder& occluder : set_.occluders) {
      slack.push_back(occluder.slack);
    }
    for (Occluder& occluder : set_.occluders) {
      for (const OccluderEdge& edge : set_.edgesOf(occluder)) {
        for (const EdgeNeighbour& neighbour : set_.neighboursOf(edge)) {
          occluder.slack = std::max(occluder.slack, slack[neighbour.occluder.value]);
        }
      }
    }
  }

  std::span<const Vec3f> positions_;
  std::span<const RankedPolygon> polygons_;
  OccluderSet& set_;
  base::UnionFind classes_;    // of occluder edges along one shared edge
  LargeVector<Use> uses_;      // in the order of edges
  base::Rows<Use> by_vertex_;  // by their lower vertex, sorted by mesh edge
  LargeVector<std::uint32_t> owner_, first_use_, mesh_edge_count_;  // by edge
};

// False where a corner is sharper than three degrees: near it, a neighbour's own boundary would be too close
// to the shared edge.
bool hasNoSharpCorner(std::span<const Vec3f> corners) {
  constexpr double kSine = 0.052;
  const std::size_t n = corners.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3d at(corners[i]);
    const Vec3d a = normalized(Vec3d(corners[(i + n - 1) % n]) - at);
    const Vec3d b = normalized(Vec3d(corners[(i + 1) % n]) - at);
    if (length(cross(a, b)) < kSine && dot(a, b) > 0.0) {
      return false;
    }
  }
  return true;
}

// Lists, for each object, the occluders for which listed(id) is true, in the order of their ids.
template <typename Listed>
void listByObject(const OccluderSet& set, Listed&& listed, std::vector<std::uint32_t>& first,
                  std::vector<OccluderId>& ids) {
  const auto forEachListed = [&](auto&& visit) {
    for (std::size_t o = 0; o < set.occluders.size(); ++o) {
      const std::size_t place = set.placeOf(set.occluders[o].object);
      if (place < set.objects.size() && listed(OccluderId(o))) {
        visit(place, OccluderId(o));
      }
    }
  };
  base::groupIntoRows(set.objects.size(), first, ids, forEachListed);
}

}  // namespace

void assembleSet(std::span<const Vec3f> positions, std::span<const RankedPolygon> polygons,
                 OccluderSet& set) {
  for (const RankedPolygon& ranked : polygons) {
    const FoundPolygon& polygon = ranked.polygon;
    Occluder occluder;
    occluder.first_vertex = static_cast<std::uint32_t>(set.vertices.size());
    occluder.vertex_count = static_cast<std::uint16_t>(polygon.corners.size());
    occluder.double_sided = polygon.double_sided;
    occluder.object = ranked.object;
    occluder.area = static_cast<float>(polygon.area);
    occluder.slack = static_cast<float>(polygon.slack * 1.001);
    occluder.plane = polygon.plane;
    occluder.centroid = Vec3f(polygon.centroid);
    for (const std::uint32_t corner : polygon.corners) {
      set.vertices.push_back(positions[polygon.loop[corner]]);
    }
    occluder.watertight_edges = hasNoSharpCorner(std::span(set.vertices).subspan(occluder.first_vertex));
    set.area += polygon.area;
    set.report.used += polygon.triangle_count;
    set.occluders.push_back(occluder);
  }
  set.edges.resize(set.vertices.size());
  Linker(positions, polygons, set).run();
  assembleBodies(positions, polygons, set);
  listByObject(
      set, [](OccluderId) { return true; }, set.first_of_object, set.of_object);
  const auto stands_for_all = [&](OccluderId id) {
    const OccluderBody* body = set.bodyOf(id);
    return body == nullptr || set.facesOf(*body).front().occluder == id;
  };
  listByObject(set, stands_for_all, set.first_unit_of_object, set.unit_of_object);
}

}  // namespace sightline::occluders
