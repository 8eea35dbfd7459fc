#include "src/occluders/divide_outlines.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "src/base/parallel_rows.h"
#include "src/occluders/edge_vertices.h"
#include "src/occluders/occluder_limits.h"

namespace sightline::occluders {
namespace {

constexpr std::size_t kLowEndsOfPart = 16384;

std::uint32_t nextIn(std::span<const std::uint32_t> loop, std::size_t at) {
  return loop[at + 1 < loop.size() ? at + 1 : 0];
}

// The mesh edges of outlines that run one way more often than the other, ascending. Bodies, the edges of
// which cancel each other, are left out.
std::vector<MeshEdge> openEdges(std::size_t position_count, std::span<const RankedPolygon> polygons,
                                const ParallelFor& parallel_for) {
  // Half an edge: the higher vertex, doubled, plus 1 if it runs from there to the lower one.
  base::Rows<std::uint64_t> by_low;
  base::groupIntoRows(parallel_for, position_count, polygons.size(), by_low.first(), by_low.all(),
                      [&](std::size_t begin, std::size_t end, auto&& pair) {
                        for (std::size_t p = begin; p < end; ++p) {
                          const FoundPolygon& polygon = *polygons[p].polygon;
                          if (polygon.body != FoundPolygon::kNoBody) {
                            continue;
                          }
                          std::uint32_t from = polygon.loop().back();
                          for (const std::uint32_t to : polygon.loop()) {
                            pair(std::min(from, to),
                                 std::uint64_t{std::max(from, to)} << 1 | (from < to ? 0u : 1u));
                            from = to;
                          }
                        }
                      });
  const base::Parts parts(position_count, kLowEndsOfPart);
  std::vector<std::vector<MeshEdge>> of_part(parts.count());
  parts.run(parallel_for, [&](std::size_t part, std::size_t begin, std::size_t end) {
    for (std::size_t low = begin; low < end; ++low) {
      const std::span<std::uint64_t> halves = by_low[low];
      std::sort(halves.begin(), halves.end());
      for (std::size_t i = 0; i < halves.size();) {
        const std::uint64_t high = halves[i] >> 1;
        int value = 0;
        for (; i < halves.size() && halves[i] >> 1 == high; ++i) {
          value += (halves[i] & 1) == 0 ? 1 : -1;
        }
        if (value != 0) {
          of_part[part].push_back({static_cast<std::uint32_t>(low), static_cast<std::uint32_t>(high)});
        }
      }
    }
  });
  std::vector<MeshEdge> open;
  for (const std::vector<MeshEdge>& part : of_part) {
    open.insert(open.end(), part.begin(), part.end());
  }
  return open;
}

// Edges that others end on, ascending, and where.
struct DividedEdges {
  std::vector<std::uint32_t> first_of_low;  // by lower vertex, and one more: the first of its edges
  std::vector<std::uint32_t> high;          // by edge
  base::Rows<std::uint32_t> vertices;       // by edge, from its lower vertex on
  std::vector<bool> left_whole;             // by edge

  std::size_t count() const { return high.size(); }
  // The number of an edge; as many as there are if it is not among them.
  std::size_t find(const MeshEdge& edge) const {
    for (std::uint32_t i = first_of_low[edge.low]; i < first_of_low[edge.low + 1]; ++i) {
      if (high[i] == edge.high) {
        return i;
      }
    }
    return count();
  }
  // The vertices that divide an edge.
  std::span<const std::uint32_t> on(const MeshEdge& edge) const {
    const std::size_t number = find(edge);
    return number < count() && !left_whole[number] ? vertices[number] : std::span<const std::uint32_t>();
  }
};

DividedEdges dividedEdges(std::span<const Vec3f> positions, std::span<const MeshEdge> open,
                          const ParallelFor& parallel_for) {
  const base::Rows<std::uint32_t> on_edges = verticesOnEdges(positions, open, parallel_for);
  DividedEdges divided;
  divided.first_of_low.resize(positions.size() + 1);
  for (std::size_t i = 0; i < open.size(); ++i) {
    if (on_edges[i].empty()) {
      continue;
    }
    ++divided.first_of_low[open[i].low + 1];
    divided.high.push_back(open[i].high);
    for (const std::uint32_t vertex : on_edges[i]) {
      divided.vertices.add(vertex);
    }
    divided.vertices.endRow();
  }
  std::partial_sum(divided.first_of_low.begin(), divided.first_of_low.end(), divided.first_of_low.begin());
  divided.left_whole.resize(divided.count());
  return divided;
}

// An edge of a polygon that has too many mesh edges joins nothing at all, so those of such an edge are left
// whole, for all polygons.
void leaveLongEdgesWhole(std::span<const RankedPolygon> polygons, DividedEdges& edges) {
  std::vector<bool> left_whole(edges.count());
  std::vector<std::size_t> along;  // divided edges of a polygon's edge
  for (const RankedPolygon& ranked : polygons) {
    const std::span<const std::uint32_t> loop = ranked.polygon->loop(), corners = ranked.polygon->corners();
    for (std::size_t c = 0; c < corners.size(); ++c) {
      std::size_t pieces = 0;
      along.clear();
      for (std::size_t i = corners[c]; pieces == 0 || i != nextIn(corners, c);) {
        const std::size_t number = edges.find(meshEdge(loop[i], nextIn(loop, i)));
        pieces += 1;
        if (number < edges.count()) {
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
  DividedEdges edges =
      dividedEdges(positions, openEdges(positions.size(), polygons, parallel_for), parallel_for);
  if (edges.count() == 0) {
    return;
  }
  leaveLongEdgesWhole(polygons, edges);
  std::vector<std::uint32_t> loop, corners, place;  // place: in the new loop, by place in the old one
  for (RankedPolygon& ranked : polygons) {
    const FoundPolygon& polygon = *ranked.polygon;
    loop.clear();
    place.clear();
    for (std::size_t i = 0; i < polygon.loop().size(); ++i) {
      const MeshEdge edge = meshEdge(polygon.loop()[i], nextIn(polygon.loop(), i));
      place.push_back(static_cast<std::uint32_t>(loop.size()));
      loop.push_back(polygon.loop()[i]);
      const std::span<const std::uint32_t> on_edge = edges.on(edge);
      if (polygon.loop()[i] == edge.low) {
        loop.insert(loop.end(), on_edge.begin(), on_edge.end());
      } else {
        loop.insert(loop.end(), on_edge.rbegin(), on_edge.rend());
      }
    }
    if (loop.size() == polygon.loop().size()) {
      continue;
    }
    corners.clear();
    for (const std::uint32_t corner : polygon.corners()) {
      corners.push_back(place[corner]);
    }
    FoundPolygon& changed = divided.polygons.emplace_back(polygon);
    changed.setOutline(divided.ids.copy(loop, corners), corners.size());
    ranked.polygon = &changed;
  }
}

}  // namespace sightline::occluders
