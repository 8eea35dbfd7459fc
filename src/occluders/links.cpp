// Which occluders share edges of the mesh. Two polygons that have a mesh edge in common leave no gap between
// them. So that the occlusion structures stay watertight there, all occluder edges along one shared edge are
// put on one line, given by two mesh vertices, and each of them knows which polygons lie beyond each of the
// mesh edges that it was merged from.
//
// Polygons are ranked by area, and neighbours are of any rank. So everything is found by place first, in the
// order of the polygons as they are given, where neighbours are close in memory. What the set holds lies by
// rank, anywhere in memory as seen from there, and is written once.

#include "src/occluders/links.h"

#include <hwy/cache_control.h>

#include <algorithm>
#include <array>
#include <new>
#include <tuple>
#include <utility>
#include <vector>

#include "src/base/scratch_array.h"
#include "src/occluders/occluder_limits.h"
#include "src/occluders/outline_mesh.h"
#include "src/occluders/shared_edges.h"

namespace sightline::occluders {
namespace {

constexpr std::size_t kAhead = 8;  // places for which memory is asked for early

// False where a corner is sharper than three degrees: near it, a neighbour's own boundary would be too close
// to the shared edge.
bool hasNoSharpCorner(std::span<const Vec3f> positions, const FoundPolygon& polygon) {
  constexpr double kSine = 0.052;
  const auto at = [&](std::size_t i) { return Vec3d(positions[polygon.loop()[polygon.corners()[i]]]); };
  const std::size_t count = polygon.corners().size();
  const Vec3d start = at(0);
  Vec3d corner = start, before = corner - at(count - 1);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3d next = i + 1 < count ? at(i + 1) : start;
    const Vec3d after = next - corner, across = cross(before, after);
    if (dot(before, after) < 0.0 &&
        dot(across, across) < kSine * kSine * dot(before, before) * dot(after, after)) {
      return false;
    }
    before = after;
    corner = next;
  }
  return true;
}

template <typename T>
void prefetch(const LargeVector<T>& items, std::size_t first, std::size_t count) {
  const char* const begin = reinterpret_cast<const char*>(items.data() + first);
  for (std::size_t line = 0; line < count * sizeof(T); line += 64) {
    hwy::Prefetch(begin + line);
  }
}

// How many of each an occluder has in the lists of the set, and then the first of them.
struct InLists {
  std::uint32_t vertices = 0, lines = 0, edge_vertices = 0, neighbours = 0;
};

class Linker {
 public:
  Linker(std::span<const Vec3f> positions, std::span<const RankedPolygon> polygons,
         const ParallelFor& parallel_for, OccluderSet& set)
      : positions_(positions),
        polygons_(polygons),
        parallel_for_(parallel_for),
        set_(set),
        mesh_(positions, polygons, parallel_for),
        shared_(mesh_, parallel_for) {}

  void run() {
    look();
    placeLists();
    write();
  }

 private:
  // What a polygon is to its neighbours.
  struct AsNeighbour {
    OccluderId id{};     // not valid if none of its edges is watertight
    float slack = 0.0f;  // without that of its own neighbours
  };
  // What is known of an edge that is not one mesh edge.
  struct Several {
    const SharedEdge* shared = nullptr;
    std::uint32_t number = 0;  // of the shared edge
    std::uint32_t mesh_edges = 0;
    bool first = false;  // of the edges of the shared one, that of the largest polygon

    bool few() const { return mesh_edges <= kMaxMeshEdges; }
    bool mayBeWatertight() const { return few() && shared->one_line; }
    // What the edge adds to the lists of its polygon.
    std::uint32_t edgeVertices() const { return few() ? mesh_edges - 1 : 0; }
    std::uint32_t lines() const { return !first ? 0 : shared->one_line ? 1 : shared->end - shared->begin; }
  };
  Several severalOf(std::uint32_t edge) const {
    const std::uint32_t number = shared_.numberOf(edge);
    const SharedEdge& shared = shared_.all()[number];
    return {&shared, number, mesh_.meshEdgeCount(edge), shared_.edgeAt(shared.begin) == edge};
  }
  std::uint32_t linesOf(std::uint32_t edge) const {
    return mesh_.isOneMeshEdge(edge) ? (mesh_.isFirst(edge) ? 1 : 0) : severalOf(edge).lines();
  }

  // Calls visit(neighbour) for the polygons beyond a use that may be neighbours.
  template <typename Visit>
  void forEachNeighbour(std::uint32_t place, std::uint32_t use, const Visit& visit) const {
    mesh_.forEachBeyond(use, [&](std::uint32_t other_use) {
      const std::uint32_t other = mesh_.placeOf(mesh_.edgeOf(other_use));
      if (other != place && as_neighbour_[other].id.valid()) {
        visit(as_neighbour_[other]);
      }
    });
  }

  // Finds what polygons need of their neighbours.
  void look() {
    as_neighbour_ = base::unsetVector<AsNeighbour>(polygons_.size());
    base::forEach(parallel_for_, polygons_.size(), [this](std::uint32_t place) {
      const FoundPolygon& polygon = mesh_.polygonAt(place);
      as_neighbour_[place] = {hasNoSharpCorner(positions_, polygon) ? polygons_[place].id : OccluderId(),
                              polygon.slack};
    });
    for (const SharedEdge& shared : shared_.all()) {
      for (std::size_t i = shared.begin; i < shared.end; ++i) {
        float& slack = as_neighbour_[mesh_.placeOf(shared_.edgeAt(i))].slack;
        slack = std::max(slack, shared.deviation);
      }
    }
  }

  InLists countsAt(std::uint32_t place) const {
    InLists counts;
    counts.vertices = mesh_.endEdge(place) - mesh_.firstEdge(place);
    std::uint32_t use = mesh_.firstUse(place);
    for (std::uint32_t edge = mesh_.firstEdge(place); edge < mesh_.endEdge(place); ++edge) {
      std::uint32_t mesh_edges = 1;
      bool may_have_neighbours = true;
      if (mesh_.isOneMeshEdge(edge)) {
        counts.lines += mesh_.isFirst(edge) ? 1 : 0;
      } else {
        const Several several = severalOf(edge);
        counts.lines += several.lines();
        counts.edge_vertices += several.edgeVertices();
        mesh_edges = several.mesh_edges;
        may_have_neighbours = several.mayBeWatertight();
      }
      for (const std::uint32_t end = use + mesh_edges; use < end; ++use) {
        if (may_have_neighbours) {
          forEachNeighbour(place, use, [&](const AsNeighbour&) { ++counts.neighbours; });
        }
      }
    }
    return counts;
  }

  // Says where the lists of each polygon begin, which lie by rank.
  void placeLists() {
    struct Counts {
      double area;
      InLists in_lists;
    };
    base::ScratchArray<Counts> by_rank(polygons_.size());
    base::forEach(parallel_for_, polygons_.size(), [&](std::uint32_t place) {
      if (place + kAhead < polygons_.size()) {
        hwy::Prefetch(&by_rank[polygons_[place + kAhead].id.value]);
      }
      by_rank[polygons_[place].id.value] = {mesh_.polygonAt(place).area, countsAt(place)};
    });
    InLists sum;
    for (Counts& counts : by_rank) {
      set_.area += counts.area;
      InLists& of_polygon = counts.in_lists;
      sum.vertices += std::exchange(of_polygon.vertices, sum.vertices);
      sum.lines += std::exchange(of_polygon.lines, sum.lines);
      sum.edge_vertices += std::exchange(of_polygon.edge_vertices, sum.edge_vertices);
      sum.neighbours += std::exchange(of_polygon.neighbours, sum.neighbours);
    }
    first_ = base::unsetVector<InLists>(polygons_.size());
    base::forEach(parallel_for_, polygons_.size(), [&](std::uint32_t place) {
      if (place + kAhead < polygons_.size()) {
        hwy::Prefetch(&by_rank[polygons_[place + kAhead].id.value]);
      }
      first_[place] = by_rank[polygons_[place].id.value].in_lists;
    });
    set_.occluders = base::unsetVector<Occluder>(polygons_.size());
    set_.vertices = base::unsetVector<Vec3f>(sum.vertices);
    set_.edges = base::unsetVector<OccluderEdge>(sum.vertices);
    set_.lines = base::unsetVector<std::array<Vec3f, 2>>(sum.lines);
    set_.edge_vertices = base::unsetVector<Vec3f>(sum.edge_vertices);
    set_.neighbours = base::unsetVector<EdgeNeighbour>(sum.neighbours);
  }

  // The first line of an edge that has lines in the list of its polygon.
  std::uint32_t firstLineOf(std::uint32_t edge) const {
    const std::uint32_t place = mesh_.placeOf(edge);
    std::uint32_t line = first_[place].lines;
    for (std::uint32_t before = mesh_.firstEdge(place); before < edge; ++before) {
      line += linesOf(before);
    }
    return line;
  }

  void write() {
    base::Parts(polygons_.size(), kPolygonsOfPart)
        .run(parallel_for_, [this](std::size_t, std::size_t begin, std::size_t end) {
          for (std::size_t place = begin; place < end; ++place) {
            if (place + kAhead < polygons_.size()) {
              prefetchFor(place + kAhead);
            }
            writeOccluder(static_cast<std::uint32_t>(place));
          }
        });
  }

  // Asks for the memory to which a polygon is written. Few have more neighbours than edges.
  void prefetchFor(std::size_t place) const {
    const InLists& first = first_[place];
    const std::size_t edges =
        mesh_.endEdge(static_cast<std::uint32_t>(place)) - mesh_.firstEdge(static_cast<std::uint32_t>(place));
    prefetch(set_.occluders, polygons_[place].id.value, 1);
    prefetch(set_.vertices, first.vertices, edges);
    prefetch(set_.edges, first.vertices, edges);
    prefetch(set_.lines, first.lines, edges / 2);
    prefetch(set_.neighbours, first.neighbours, edges);
  }

  // What the memory of the set holds before does not matter.
  void writeOccluder(std::uint32_t place) {
    const RankedPolygon& ranked = polygons_[place];
    const FoundPolygon& polygon = *ranked.polygon;
    Occluder& occluder = *::new (&set_.occluders[ranked.id.value]) Occluder();
    occluder.first_vertex = first_[place].vertices;
    occluder.vertex_count = static_cast<std::uint16_t>(polygon.corners().size());
    occluder.double_sided = polygon.double_sided;
    occluder.watertight_edges = as_neighbour_[place].id.valid();
    occluder.object = ranked.object;
    occluder.area = static_cast<float>(polygon.area);
    occluder.plane = polygon.plane;
    occluder.centroid = polygon.centroid;
    occluder.slack = writeEdges(place, polygon);
  }

  // Writes vertices and edges of a polygon, with what belongs to them. Returns its slack, which also bounds
  // that of its neighbours: the uncertain outline of a neighbour begins at the end of the edge that both
  // share.
  float writeEdges(std::uint32_t place, const FoundPolygon& polygon) {
    InLists next = first_[place];
    std::uint32_t use = mesh_.firstUse(place);
    float slack = as_neighbour_[place].slack;
    for (std::uint32_t edge = mesh_.firstEdge(place); edge < mesh_.endEdge(place); ++edge) {
      const std::uint32_t corner = edge - mesh_.firstEdge(place);
      set_.vertices[next.vertices] = positions_[polygon.loop()[polygon.corners()[corner]]];
      OccluderEdge written;
      written.first_edge_vertex = next.edge_vertices;
      std::uint32_t mesh_edges = 1;
      if (mesh_.isOneMeshEdge(edge)) {
        written.mesh_edge_count = 1;
        written.line = writeOneMeshEdge(edge, use, next);
      } else {
        const Several several = severalOf(edge);
        mesh_edges = several.mesh_edges;
        written.mesh_edge_count = static_cast<std::uint16_t>(several.mayBeWatertight() ? mesh_edges : 0);
        written.line = writeSeveral(several, edge, next);
        writeEdgeVertices(several, polygon, corner, next);
      }
      const std::uint32_t first_neighbour = next.neighbours;
      float of_neighbours = 0.0f;
      for (std::uint32_t k = 0; k < written.mesh_edge_count; ++k) {
        of_neighbours = std::max(of_neighbours, writeNeighbours(place, use + k, k, next));
      }
      if (const std::uint32_t count = next.neighbours - first_neighbour; count > 0) {
        written.first_neighbour = first_neighbour;
        written.neighbour_count = static_cast<std::uint16_t>(count <= 0xffff ? count : 0);
        slack = count <= 0xffff ? std::max(slack, of_neighbours) : slack;
      }
      set_.edges[next.vertices++] = written;
      use += mesh_edges;
    }
    return slack;
  }

  // These return the line of an edge, and write those that it has in the list of its polygon.
  std::uint32_t writeOneMeshEdge(std::uint32_t edge, std::uint32_t use, InLists& next) {
    if (mesh_.isFirst(edge)) {
      set_.lines[next.lines] = ownLine(edge);
      return next.lines++;
    }
    std::uint32_t first = edge;
    mesh_.forEachBeyond(use, [&](std::uint32_t other) {
      first = mesh_.isFirst(mesh_.edgeOf(other)) ? mesh_.edgeOf(other) : first;
    });
    return firstLineOf(first);
  }
  std::uint32_t writeSeveral(const Several& several, std::uint32_t edge, InLists& next) {
    const SharedEdge& shared = *several.shared;
    const std::uint32_t line = several.first ? next.lines : firstLineOf(shared_.edgeAt(shared.begin));
    next.lines += several.lines();
    if (shared.one_line) {
      if (several.first) {
        set_.lines[line] = shared.line;
      }
      return line;
    }
    std::uint32_t number = 0;
    while (shared_.edgeAt(shared.begin + number) != edge) {
      ++number;
    }
    set_.lines[line + number] = ownLine(edge);
    return line + number;
  }
  std::array<Vec3f, 2> ownLine(std::uint32_t edge) const {
    const std::array<std::uint32_t, 2> ends = mesh_.endsOf(edge);
    return {positions_[ends[0]], positions_[ends[1]]};
  }

  void writeEdgeVertices(const Several& several, const FoundPolygon& polygon, std::uint32_t corner,
                         InLists& next) {
    for (std::uint32_t k = 1; k <= several.edgeVertices(); ++k) {
      const std::size_t at = (polygon.corners()[corner] + k) % polygon.loop().size();
      set_.edge_vertices[next.edge_vertices++] = positions_[polygon.loop()[at]];
    }
  }

  // Writes the neighbours along a mesh edge, of that number in its edge. Returns the greatest slack of these.
  float writeNeighbours(std::uint32_t place, std::uint32_t use, std::uint32_t mesh_edge, InLists& next) {
    float slack = 0.0f;
    const std::uint32_t first = next.neighbours;
    forEachNeighbour(place, use, [&](const AsNeighbour& neighbour) {
      set_.neighbours[next.neighbours++] = {neighbour.id, mesh_edge};
      slack = std::max(slack, neighbour.slack);
    });
    if (next.neighbours - first > 1) {
      std::sort(set_.neighbours.begin() + first, set_.neighbours.begin() + next.neighbours,
                [](const EdgeNeighbour& a, const EdgeNeighbour& b) { return a.occluder < b.occluder; });
    }
    return slack;
  }

  std::span<const Vec3f> positions_;
  std::span<const RankedPolygon> polygons_;
  const ParallelFor& parallel_for_;
  OccluderSet& set_;
  OutlineMesh mesh_;
  SharedEdges shared_;
  // By place.
  LargeVector<AsNeighbour> as_neighbour_;
  LargeVector<InLists> first_;
};

}  // namespace

void linkPolygons(std::span<const Vec3f> positions, std::span<const RankedPolygon> polygons,
                  const ParallelFor& parallel_for, OccluderSet& set) {
  Linker(positions, polygons, parallel_for, set).run();
}

}  // namespace sightline::occluders
