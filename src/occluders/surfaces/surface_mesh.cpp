#include "src/occluders/surfaces/surface_mesh.h"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "src/base/parallel_rows.h"
#include "src/base/part_store.h"
#include "src/occluders/conform/bend_triangles.h"
#include "src/occluders/edge_vertices.h"
#include "src/occluders/surfaces/weld_vertices.h"

namespace sightline::occluders {

namespace {

constexpr std::size_t kVerticesOfPart = 16384;

// A side in the row of its edge's lower vertex.
struct LooseSide {
  std::uint32_t high = 0;  // the edge's higher vertex
  Side side;

  // By edge, then ascending.
  friend bool operator<(const LooseSide& a, const LooseSide& b) { return a.key() < b.key(); }

 private:
  std::uint64_t key() const { return std::uint64_t{high} << 32 | side.code; }
};

// Lists the sides of some triangles by their lower vertices, sorted. number_of(i): the number of triangle i
// of `count` in the mesh.
template <typename NumberOf>
base::Rows<LooseSide> sidesByVertex(const SurfaceMesh& mesh, std::size_t count, const NumberOf& number_of,
                                    const ParallelFor& parallel_for) {
  base::Rows<LooseSide> by_low;
  base::groupIntoRows(parallel_for, mesh.vertices.size(), count, by_low.first(), by_low.all(),
                      [&](std::size_t begin, std::size_t end, auto&& pair) {
                        for (std::size_t i = begin; i < end; ++i) {
                          const std::uint32_t t = number_of(i);
                          for (std::uint32_t k = 0; k < 3; ++k) {
                            const std::uint32_t a = mesh.triangles[t][k],
                                                b = mesh.triangles[t][k == 2 ? 0 : k + 1];
                            const std::uint32_t code = 2 * (3 * t + k);
                            pair(std::min(a, b), LooseSide{std::max(a, b), {code + (a < b ? 0 : 1)}});
                          }
                        }
                      });
  base::Parts(by_low.count(), kVerticesOfPart)
      .run(parallel_for, [&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t low = begin; low < end; ++low) {
          std::sort(by_low[low].begin(), by_low[low].end());
        }
      });
  return by_low;
}

// Calls visit(sides) for each edge of a row.
template <typename Visit>
void forEachEdge(std::span<const LooseSide> row, const Visit& visit) {
  for (std::size_t i = 0, next = 0; i < row.size(); i = next) {
    while (next < row.size() && row[next].high == row[i].high) {
      ++next;
    }
    visit(row.subspan(i, next - i));
  }
}

// Edges at which triangles do not cancel, ascending.
LargeVector<MeshEdge> openMeshEdges(const base::Rows<LooseSide>& sides, const ParallelFor& parallel_for) {
  const base::Parts parts(sides.count(), kVerticesOfPart);
  base::PartStore store;
  std::vector<base::KeptItems<MeshEdge>> of_part(parts.count());
  parallel_for(static_cast<std::uint32_t>(parts.count()), [&](std::uint32_t first, std::uint32_t last) {
    std::vector<MeshEdge> open;
    for (std::uint32_t part = first; part < last; ++part) {
      open.clear();
      for (std::size_t low = parts.begin(part); low < parts.end(part); ++low) {
        forEachEdge(sides[low], [&](std::span<const LooseSide> of_edge) {
          std::int32_t sum = 0;
          for (const LooseSide& side : of_edge) {
            sum += side.side.value();
          }
          if (sum != 0) {
            open.push_back({static_cast<std::uint32_t>(low), of_edge[0].high});
          }
        });
      }
      of_part[part] = store.keep(open);
    }
  });
  LargeVector<MeshEdge> all;
  all.reserve(std::accumulate(of_part.begin(), of_part.end(), std::size_t{0},
                              [](std::size_t sum, const auto& part) { return sum + part.items.size(); }));
  for (const base::KeptItems<MeshEdge>& part : of_part) {
    all.insert(all.end(), part.items.begin(), part.items.end());
  }
  return all;
}

// The pieces of triangles whose edges have vertices on them.
struct DividedTriangles {
  std::vector<std::uint32_t> divided;  // triangles of the mesh, ascending
  BentTriangles triangles;             // the source is a place in `divided`
};

DividedTriangles divideTriangles(const SurfaceMesh& mesh, const base::Rows<LooseSide>& sides,
                                 const ParallelFor& parallel_for) {
  const LargeVector<MeshEdge> open = openMeshEdges(sides, parallel_for);
  const base::Rows<std::uint32_t> on_edges = verticesOnEdges(mesh.vertices, open, parallel_for);
  DividedTriangles pieces;
  std::vector<MeshEdge> edges;
  base::Rows<std::uint32_t> through;
  for (std::size_t i = 0; i < open.size(); ++i) {
    if (on_edges[i].empty()) {
      continue;
    }
    edges.push_back(open[i]);
    for (const std::uint32_t vertex : on_edges[i]) {
      through.add(vertex);
    }
    through.endRow();
    const std::span<const LooseSide> row = sides[open[i].low];
    for (auto side = std::lower_bound(row.begin(), row.end(), LooseSide{open[i].high, {}});
         side != row.end() && side->high == open[i].high; ++side) {
      pieces.divided.push_back(side->side.triangle());
    }
  }
  std::sort(pieces.divided.begin(), pieces.divided.end());
  pieces.divided.erase(std::unique(pieces.divided.begin(), pieces.divided.end()), pieces.divided.end());
  TriangleBender bender(edges, through, pieces.triangles);
  for (std::uint32_t place = 0; place < pieces.divided.size(); ++place) {
    const std::array<std::uint32_t, 3>& corners = mesh.triangles[pieces.divided[place]];
    bender.add({corners[0], corners[1], corners[2]}, place);
  }
  return pieces;
}

// What numbers triangles have after some of them were divided.
struct Renumbering {
  static constexpr std::uint32_t kDivided = 0xffffffffu;
  LargeVector<std::uint32_t> number_of;  // by given triangle, ascending but for kDivided
  std::vector<std::uint32_t> pieces;     // the numbers of pieces, ascending
};

// Puts pieces in the place of their triangles. A triangle all of whose pieces have collapsed stays.
Renumbering replaceDivided(SurfaceMesh& mesh, const DividedTriangles& pieces) {
  const BentTriangles& made = pieces.triangles;
  Renumbering numbers{base::unsetVector<std::uint32_t>(mesh.triangleCount()), {}};
  numbers.pieces.reserve(made.source.size());
  std::size_t replaced = 0;
  for (std::size_t piece = 0; piece < made.source.size(); ++piece) {
    replaced += piece == 0 || made.source[piece] != made.source[piece - 1] ? 1 : 0;
  }
  const std::size_t count = mesh.triangleCount() - replaced + made.source.size();
  LargeVector<std::array<std::uint32_t, 3>> triangles =
      base::unsetVector<std::array<std::uint32_t, 3>>(count);
  LargeVector<std::uint32_t> objects = base::unsetVector<std::uint32_t>(count);
  mesh.source = base::unsetVector<std::uint32_t>(count);
  std::uint32_t number = 0;
  std::size_t piece = 0;
  const auto add = [&](const std::array<std::uint32_t, 3>& corners, std::uint32_t given) {
    triangles[number] = corners;
    objects[number] = mesh.objects[given];
    mesh.source[number++] = given;
  };
  for (std::uint32_t given = 0; given < mesh.triangleCount(); ++given) {
    if (piece == made.source.size() || pieces.divided[made.source[piece]] != given) {
      numbers.number_of[given] = number;
      add(mesh.triangles[given], given);
      continue;
    }
    numbers.number_of[given] = Renumbering::kDivided;
    for (; piece < made.source.size() && pieces.divided[made.source[piece]] == given; ++piece) {
      const std::uint32_t* const corners = &made.triangles[3 * piece];
      numbers.pieces.push_back(number);
      add({corners[0], corners[1], corners[2]}, given);
    }
  }
  mesh.given = std::exchange(mesh.triangles, std::move(triangles));
  mesh.objects = std::move(objects);
  return numbers;
}

// Takes the sides of divided triangles out of a row, and gives the others their new numbers. Returns what is
// left of it.
std::span<LooseSide> renumbered(const Renumbering& numbers, std::span<LooseSide> row) {
  std::size_t kept = 0;
  for (const LooseSide& side : row) {
    const std::uint32_t number = numbers.number_of[side.side.triangle()];
    if (number != Renumbering::kDivided) {
      row[kept++] = {side.high, {6 * number + side.side.code % 6}};
    }
  }
  return row.first(kept);
}

// Fills SurfaceMesh::beyond and SurfaceMesh::crowded. row_of(low, scratch): all sides at the edges of a lower
// vertex, sorted.
template <typename RowOf>
void findBeyond(SurfaceMesh& mesh, const RowOf& row_of, const ParallelFor& parallel_for) {
  mesh.beyond = base::unsetVector<std::uint32_t>(3 * mesh.triangleCount());
  const base::Parts parts(mesh.vertices.size(), kVerticesOfPart);
  std::vector<base::Rows<Side>> crowded(parts.count());
  parts.run(parallel_for, [&](std::size_t part, std::size_t begin, std::size_t end) {
    std::vector<LooseSide> scratch;
    for (std::size_t low = begin; low < end; ++low) {
      forEachEdge(row_of(low, scratch), [&](std::span<const LooseSide> sides) {
        const Side first = sides.front().side, last = sides.back().side;
        if (sides.size() == 1) {
          mesh.beyond[first.corner()] = SurfaceMesh::kNone;
        } else if (sides.size() == 2 && first.value() != last.value()) {
          mesh.beyond[first.corner()] = last.corner();
          mesh.beyond[last.corner()] = first.corner();
        } else {
          for (const LooseSide& side : sides) {
            crowded[part].add(side.side);
          }
          crowded[part].endRow();
        }
      });
    }
  });
  for (const base::Rows<Side>& of_part : crowded) {
    for (std::size_t edge = 0; edge < of_part.count(); ++edge) {
      for (const Side side : of_part[edge]) {
        mesh.beyond[side.corner()] = SurfaceMesh::kCrowded + static_cast<std::uint32_t>(mesh.crowded.count());
        mesh.crowded.add(side);
      }
      mesh.crowded.endRow();
    }
  }
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
  return mesh;
}

void connect(SurfaceMesh& mesh, bool divide_edges, const ParallelFor& parallel_for) {
  base::Rows<LooseSide> sides = sidesByVertex(
      mesh, mesh.triangleCount(), [](std::size_t i) { return static_cast<std::uint32_t>(i); }, parallel_for);
  DividedTriangles pieces = divide_edges ? divideTriangles(mesh, sides, parallel_for) : DividedTriangles{};
  if (pieces.triangles.source.empty()) {
    findBeyond(
        mesh, [&](std::size_t low, std::vector<LooseSide>&) { return sides[low]; }, parallel_for);
    return;
  }
  const Renumbering numbers = replaceDivided(mesh, pieces);
  pieces = {};
  base::Rows<LooseSide> of_pieces = sidesByVertex(
      mesh, numbers.pieces.size(), [&](std::size_t i) { return numbers.pieces[i]; }, parallel_for);
  findBeyond(
      mesh,
      [&](std::size_t low, std::vector<LooseSide>& scratch) {
        const std::span<LooseSide> kept = renumbered(numbers, sides[low]), added = of_pieces[low];
        if (added.empty() || kept.empty()) {
          return kept.empty() ? added : kept;
        }
        scratch.resize(kept.size() + added.size());
        std::merge(kept.begin(), kept.end(), added.begin(), added.end(), scratch.begin());
        return std::span(scratch);
      },
      parallel_for);
}

}  // namespace sightline::occluders
