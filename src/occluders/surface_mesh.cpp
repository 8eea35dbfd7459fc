#include "src/occluders/surface_mesh.h"

#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>
#include <vector>

#include "src/base/parallel_rows.h"
#include "src/occluders/bend_triangles.h"
#include "src/occluders/edge_vertices.h"
#include "src/occluders/weld_vertices.h"

namespace sightline::occluders {

namespace {

constexpr std::size_t kVerticesOfPart = 16384, kOpenEdgesOfPart = 32768;

// A side before edges have numbers.
struct LooseSide {
  std::uint32_t high = 0;  // the edge's higher vertex
  Side side;
};

// What lies beyond the sides of an edge: see SurfaceMesh::beyond.
void setBeyond(std::span<const Side> sides, std::uint32_t edge, LargeVector<std::uint32_t>& beyond) {
  if (sides.size() == 1) {
    beyond[sides[0].corner()] = SurfaceMesh::kNone;
  } else if (sides.size() == 2 && sides[0].value() != sides[1].value()) {
    beyond[sides[0].corner()] = sides[1].corner();
    beyond[sides[1].corner()] = sides[0].corner();
  } else {
    for (const Side side : sides) {
      beyond[side.corner()] = SurfaceMesh::kOther + edge;
    }
  }
}

// Numbers the edges, and finds the triangles beside them.
void connect(SurfaceMesh& mesh, const ParallelFor& parallel_for) {
  base::Rows<LooseSide> by_low;
  base::groupIntoRows(parallel_for, mesh.vertices.size(), mesh.triangleCount(), by_low.first(), by_low.all(),
                      [&](std::size_t begin, std::size_t end, auto&& pair) {
                        for (std::size_t t = begin; t < end; ++t) {
                          for (std::uint32_t k = 0; k < 3; ++k) {
                            const std::uint32_t a = mesh.triangles[t][k],
                                                b = mesh.triangles[t][k == 2 ? 0 : k + 1];
                            const auto code = static_cast<std::uint32_t>(2 * (3 * t + k));
                            pair(std::min(a, b), LooseSide{std::max(a, b), {code + (a < b ? 0 : 1)}});
                          }
                        }
                      });
  const base::Parts parts(mesh.vertices.size(), kVerticesOfPart);
  std::vector<std::uint32_t> first_edge(parts.count() + 1, 0);
  parts.run(parallel_for, [&](std::size_t part, std::size_t begin, std::size_t end) {
    std::uint32_t edges = 0;
    for (std::size_t low = begin; low < end; ++low) {
      const std::span<LooseSide> sides = by_low[low];
      std::sort(sides.begin(), sides.end(), [](const LooseSide& a, const LooseSide& b) {
        return std::tie(a.high, a.side.code) < std::tie(b.high, b.side.code);
      });
      for (std::size_t i = 0; i < sides.size(); ++i) {
        edges += i == 0 || sides[i].high != sides[i - 1].high ? 1 : 0;
      }
    }
    first_edge[part + 1] = edges;
  });
  std::partial_sum(first_edge.begin(), first_edge.end(), first_edge.begin());

  // Sides stay where they are: rows of edges divide those of vertices.
  LargeVector<Side>& sides = mesh.sides.all();
  LargeVector<std::uint32_t>& first = mesh.sides.first();
  sides = base::unsetVector<Side>(by_low.items().size());
  first = base::unsetVector<std::uint32_t>(std::size_t{first_edge.back()} + 1);
  first.back() = static_cast<std::uint32_t>(sides.size());
  mesh.beyond = base::unsetVector<std::uint32_t>(sides.size());
  parts.run(parallel_for, [&](std::size_t part, std::size_t begin, std::size_t end) {
    std::uint32_t edge = first_edge[part];
    for (std::size_t low = begin; low < end; ++low) {
      const std::span<const LooseSide> loose = by_low[low];
      const auto offset = static_cast<std::size_t>(loose.data() - by_low.items().data());
      for (std::size_t i = 0, next = 0; i < loose.size(); i = next) {
        for (; next < loose.size() && loose[next].high == loose[i].high; ++next) {
          sides[offset + next] = loose[next].side;
        }
        first[edge] = static_cast<std::uint32_t>(offset + i);
        setBeyond(std::span(sides).subspan(offset + i, next - i), edge, mesh.beyond);
        ++edge;
      }
    }
  });
}

// Edges at which triangles do not cancel.
struct OpenEdges {
  std::vector<std::uint32_t> numbers;  // ascending
  std::vector<MeshEdge> edges;         // ascending
};

OpenEdges openMeshEdges(const SurfaceMesh& mesh, const ParallelFor& parallel_for) {
  const base::Parts parts(mesh.sides.count(), kOpenEdgesOfPart);
  std::vector<OpenEdges> of_part(parts.count());
  parts.run(parallel_for, [&](std::size_t part, std::size_t begin, std::size_t end) {
    for (std::size_t edge = begin; edge < end; ++edge) {
      const std::span<const Side> sides = mesh.sides[edge];
      std::int32_t sum = 0;
      for (const Side side : sides) {
        sum += side.value();
      }
      if (sum != 0) {
        const auto [low, high] = mesh.endsOf(sides[0]);
        of_part[part].numbers.push_back(static_cast<std::uint32_t>(edge));
        of_part[part].edges.push_back({low, high});
      }
    }
  });
  OpenEdges open;
  for (const OpenEdges& part : of_part) {
    open.numbers.insert(open.numbers.end(), part.numbers.begin(), part.numbers.end());
    open.edges.insert(open.edges.end(), part.edges.begin(), part.edges.end());
  }
  return open;
}

// The pieces of triangles whose edges have vertices on them.
struct DividedTriangles {
  std::vector<std::uint32_t> numbers;  // of the triangles, ascending
  BentTriangles pieces;                // the source is a place in `numbers`
};

DividedTriangles divideTriangles(const SurfaceMesh& mesh, const ParallelFor& parallel_for) {
  const OpenEdges open = openMeshEdges(mesh, parallel_for);
  const base::Rows<std::uint32_t> on_edges = verticesOnEdges(mesh.vertices, open.edges, parallel_for);
  DividedTriangles divided;
  std::vector<MeshEdge> edges;
  base::Rows<std::uint32_t> through;
  for (std::size_t i = 0; i < open.edges.size(); ++i) {
    if (on_edges[i].empty()) {
      continue;
    }
    edges.push_back(open.edges[i]);
    for (const std::uint32_t vertex : on_edges[i]) {
      through.add(vertex);
    }
    through.endRow();
    for (const Side side : mesh.sides[open.numbers[i]]) {
      divided.numbers.push_back(side.triangle());
    }
  }
  std::sort(divided.numbers.begin(), divided.numbers.end());
  divided.numbers.erase(std::unique(divided.numbers.begin(), divided.numbers.end()), divided.numbers.end());
  TriangleBender bender(edges, through, divided.pieces);
  for (std::uint32_t place = 0; place < divided.numbers.size(); ++place) {
    const std::array<std::uint32_t, 3>& corners = mesh.triangles[divided.numbers[place]];
    bender.add({corners[0], corners[1], corners[2]}, place);
  }
  return divided;
}

}  // namespace

bool mayOcclude(const SceneView& scene, const Object& object) {
  return scene.materialOf(object).opaque() && object.mark != OccluderMark::kNever;
}

bool isFiniteTriangle(const SceneView& scene, std::span<const std::uint32_t> corners) {
  return isFinite(scene.positions[corners[0]]) && isFinite(scene.positions[corners[1]]) &&
         isFinite(scene.positions[corners[2]]);
}

OpaqueTriangles opaqueTriangles(const SceneView& scene, const ParallelFor& parallel_for) {
  const OpaqueParts parts(scene);
  WeldedVertices welded = weldVertices(scene, parts, parallel_for);
  OpaqueTriangles opaque;
  for (std::size_t part = 0; part < parts.count(); ++part) {
    parts.forEachTriangle(part,
                          [&](std::uint32_t, std::span<const std::uint32_t> corners, std::uint32_t object) {
                            for (const std::uint32_t corner : corners) {
                              opaque.corners.push_back(welded.vertex_of[corner]);
                            }
                            opaque.objects.push_back(object);
                          });
  }
  opaque.vertices = std::move(welded.vertices);
  opaque.position_of = std::move(welded.position_of);
  return opaque;
}

SurfaceMesh weld(const SceneView& scene, const ParallelFor& parallel_for) {
  const OpaqueParts parts(scene);
  WeldedVertices welded = weldVertices(scene, parts, parallel_for);
  // Calls use(vertices, object) for the triangles of a part that have three different vertices.
  const auto forEachTriangle = [&](std::size_t part, const auto& use) {
    parts.forEachTriangle(
        part, [&](std::uint32_t, std::span<const std::uint32_t> corners, std::uint32_t object) {
          const std::array vertices{welded.vertex_of[corners[0]], welded.vertex_of[corners[1]],
                                    welded.vertex_of[corners[2]]};
          if (vertices[0] != vertices[1] && vertices[1] != vertices[2] && vertices[2] != vertices[0]) {
            use(vertices, object);
          }
        });
  };
  std::vector<std::uint32_t> first(parts.count() + 1, 0);
  parts.run(parallel_for, [&](std::uint32_t part) {
    std::uint32_t count = 0;
    forEachTriangle(part, [&](const std::array<std::uint32_t, 3>&, std::uint32_t) { ++count; });
    first[part + 1] = count;
  });
  std::partial_sum(first.begin(), first.end(), first.begin());
  SurfaceMesh mesh;
  mesh.triangles = base::unsetVector<std::array<std::uint32_t, 3>>(first.back());
  mesh.objects = base::unsetVector<std::uint32_t>(first.back());
  parts.run(parallel_for, [&](std::uint32_t part) {
    std::uint32_t t = first[part];
    forEachTriangle(part, [&](const std::array<std::uint32_t, 3>& vertices, std::uint32_t object) {
      mesh.triangles[t] = vertices;
      mesh.objects[t++] = object;
    });
  });
  mesh.vertices = std::move(welded.vertices);
  connect(mesh, parallel_for);
  return mesh;
}

void divideEdges(SurfaceMesh& mesh, const ParallelFor& parallel_for) {
  const DividedTriangles divided = divideTriangles(mesh, parallel_for);
  if (divided.numbers.empty()) {
    return;
  }
  const BentTriangles& made = divided.pieces;
  SurfaceMesh pieces;
  pieces.triangles.reserve(mesh.triangles.size());
  pieces.objects.reserve(mesh.triangles.size());
  std::size_t next = 0, piece = 0;
  for (std::uint32_t t = 0; t < mesh.triangleCount(); ++t) {
    const std::size_t before = pieces.triangles.size();
    if (next < divided.numbers.size() && divided.numbers[next] == t) {
      for (; piece < made.source.size() && made.source[piece] == next; ++piece) {
        const std::uint32_t* of = &made.triangles[3 * piece];
        pieces.triangles.push_back({of[0], of[1], of[2]});
      }
      ++next;
    }
    if (pieces.triangles.size() == before) {
      pieces.triangles.push_back(mesh.triangles[t]);
    }
    pieces.objects.resize(pieces.triangles.size(), mesh.objects[t]);
    pieces.source.resize(pieces.triangles.size(), t);
  }
  pieces.vertices = std::move(mesh.vertices);
  pieces.given = std::move(mesh.triangles);
  mesh = std::move(pieces);
  connect(mesh, parallel_for);
}

}  // namespace sightline::occluders
