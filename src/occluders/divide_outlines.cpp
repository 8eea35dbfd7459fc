#include "src/occluders/divide_outlines.h"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "src/base/rows.h"
#include "src/base/scratch_array.h"
#include "src/base/sort_keys.h"
#include "src/occluders/edge_vertices.h"
#include "src/occluders/occluder_limits.h"

namespace sightline::occluders {
namespace {

std::uint32_t nextIn(std::span<const std::uint32_t> loop, std::size_t at) {
  return loop[at + 1 < loop.size() ? at + 1 : 0];
}

// The mesh edges of outlines that run one way more often than the other, ascending. Bodies, the edges of
// which cancel each other, are left out.
std::vector<MeshEdge> openEdges(std::span<const RankedPolygon> polygons, const ParallelFor& parallel_for) {
  const auto isOpen = [](const RankedPolygon& ranked) {
    return ranked.polygon->body == FoundPolygon::kNoBody;
  };
  std::size_t count = 0;
  for (const RankedPolygon& ranked : polygons) {
    count += isOpen(ranked) ? ranked.polygon->loop.size() : 0;
  }
  // Halves of edges, and whether they run from the lower vertex to the higher one.
  LargeVector<base::SortKey> halves = base::unsetVector<base::SortKey>(count);
  std::size_t next = 0;
  for (const RankedPolygon& ranked : polygons) {
    const std::span<const std::uint32_t> loop = ranked.polygon->loop;
    for (std::size_t i = 0; i < loop.size() && isOpen(ranked); ++i) {
      const MeshEdge edge = meshEdge(loop[i], nextIn(loop, i));
      halves[next++] = {std::uint64_t{edge.low} << 32 | edge.high, loop[i] == edge.low ? 1u : 0u};
    }
  }
  base::KeySorter().sort(halves, parallel_for);
  std::vector<MeshEdge> open;
  for (std::size_t i = 0; i < halves.size();) {
    const std::uint64_t edge = halves[i].first;
    int value = 0;
    for (; i < halves.size() && halves[i].first == edge; ++i) {
      value += halves[i].second == 1 ? 1 : -1;
    }
    if (value != 0) {
      open.push_back({static_cast<std::uint32_t>(edge >> 32), static_cast<std::uint32_t>(edge)});
    }
  }
  return open;
}

// Edges that others end on, ascending, and where.
struct DividedEdges {
  std::vector<MeshEdge> edges;
  base::Rows<std::uint32_t> vertices;  // by edge, from its lower vertex on
  std::vector<bool> begins;            // by vertex: it is the lower one of an edge
  std::vector<bool> left_whole;        // by edge

  // The number of an edge; as many as there are if it is not among them.
  std::size_t find(const MeshEdge& edge) const {
    if (!begins[edge.low]) {
      return edges.size();
    }
    const auto found = std::lower_bound(edges.begin(), edges.end(), edge);
    return found != edges.end() && *found == edge ? static_cast<std::size_t>(found - edges.begin())
                                                  : edges.size();
  }
  // The vertices that divide an edge.
  std::span<const std::uint32_t> on(const MeshEdge& edge) const {
    const std::size_t number = find(edge);
    return number < edges.size() && !left_whole[number] ? vertices[number] : std::span<const std::uint32_t>();
  }
};

DividedEdges dividedEdges(std::span<const Vec3f> positions, std::span<const MeshEdge> open,
                          const ParallelFor& parallel_for) {
  const base::Rows<std::uint32_t> on_edges = verticesOnEdges(positions, open, parallel_for);
  DividedEdges divided;
  divided.begins.resize(positions.size());
  for (std::size_t i = 0; i < open.size(); ++i) {
    if (on_edges[i].empty()) {
      continue;
    }
    divided.edges.push_back(open[i]);
    divided.begins[open[i].low] = true;
    for (const std::uint32_t vertex : on_edges[i]) {
      divided.vertices.add(vertex);
    }
    divided.vertices.endRow();
  }
  divided.left_whole.resize(divided.edges.size());
  return divided;
}

// An edge of a polygon that has too many mesh edges joins nothing at all, so those of such an edge are left
// whole, for all polygons.
void leaveLongEdgesWhole(std::span<const RankedPolygon> polygons, DividedEdges& edges) {
  std::vector<bool> left_whole(edges.edges.size());
  std::vector<std::size_t> along;  // divided edges of a polygon's edge
  for (const RankedPolygon& ranked : polygons) {
    const std::span<const std::uint32_t> loop = ranked.polygon->loop, corners = ranked.polygon->corners;
    for (std::size_t c = 0; c < corners.size(); ++c) {
      std::size_t pieces = 0;
      along.clear();
      for (std::size_t i = corners[c]; pieces == 0 || i != nextIn(corners, c);) {
        const std::size_t number = edges.find(meshEdge(loop[i], nextIn(loop, i)));
        pieces += 1;
        if (number < edges.edges.size()) {
          pieces += edges.vertices[number].size();
          along.push_back(number);
        }
        i = i + 1 < loop.size() ? i + 1 : 0;
      }
      for (std::size_t k = 0; k < along.size() && pieces > kMaxMeshEdges; ++k) {
        left_whole[along[k]] = true;
      }
    }
  }
  edges.left_whole = std::move(left_whole);
}

}  // namespace

void divideOutlines(std::span<const Vec3f> positions, const ParallelFor& parallel_for,
                    std::span<RankedPolygon> polygons, DividedOutlines& divided) {
  DividedEdges edges = dividedEdges(positions, openEdges(polygons, parallel_for), parallel_for);
  if (edges.edges.empty()) {
    return;
  }
  leaveLongEdgesWhole(polygons, edges);
  std::vector<std::uint32_t> loop, corners, place;  // place: in the new loop, by place in the old one
  for (RankedPolygon& ranked : polygons) {
    const FoundPolygon& polygon = *ranked.polygon;
    loop.clear();
    place.clear();
    for (std::size_t i = 0; i < polygon.loop.size(); ++i) {
      const MeshEdge edge = meshEdge(polygon.loop[i], nextIn(polygon.loop, i));
      place.push_back(static_cast<std::uint32_t>(loop.size()));
      loop.push_back(polygon.loop[i]);
      const std::span<const std::uint32_t> on_edge = edges.on(edge);
      if (polygon.loop[i] == edge.low) {
        loop.insert(loop.end(), on_edge.begin(), on_edge.end());
      } else {
        loop.insert(loop.end(), on_edge.rbegin(), on_edge.rend());
      }
    }
    if (loop.size() == polygon.loop.size()) {
      continue;
    }
    corners.clear();
    for (const std::uint32_t corner : polygon.corners) {
      corners.push_back(place[corner]);
    }
    FoundPolygon& changed = divided.polygons.emplace_back(polygon);
    changed.loop = divided.ids.copy(loop);
    changed.corners = divided.ids.copy(corners);
    ranked.polygon = &changed;
  }
}

}  // namespace sightline::occluders
