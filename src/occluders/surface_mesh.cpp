#include "src/occluders/surface_mesh.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "src/occluders/close_cracks.h"
#include "src/scene/weld.h"

namespace sightline::occluders {

namespace {

// Calls use(corners, object, double_sided) for the opaque triangles of a scene that are finite.
template <typename Use>
void forOpaqueTriangles(const SceneView& scene, Use&& use) {
  for (std::uint32_t number = 0; number < scene.objects.size(); ++number) {
    const Object& object = scene.objects[number];
    if (!mayOcclude(scene, object)) {
      continue;
    }
    const bool double_sided = scene.materialOf(object).double_sided;
    const std::span<const std::uint32_t> indices = scene.indicesOf(object);
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
      if (isFiniteTriangle(scene, indices.subspan(i, 3))) {
        use(indices.subspan(i, 3), number, double_sided);
      }
    }
  }
}

struct WeldedVertices {
  LargeVector<Vec3f> vertices;             // in the order in which opaque triangles use them
  LargeVector<std::uint32_t> position_of;  // by vertex: the first of the scene's positions there
  LargeVector<std::uint32_t> vertex_of;    // by position, where opaque triangles use it
};

WeldedVertices weldVertices(const SceneView& scene) {
  constexpr std::uint32_t kUnknown = 0xffffffffu;
  WeldedVertices welded;
  welded.vertex_of.assign(scene.positions.size(), kUnknown);
  scene::PositionNumbers numbers(scene.positions.size());
  forOpaqueTriangles(scene, [&](std::span<const std::uint32_t> corners, std::uint32_t, bool) {
    for (const std::uint32_t corner : corners) {
      std::uint32_t& vertex = welded.vertex_of[corner];
      if (vertex == kUnknown) {
        vertex = numbers.numberOf(scene.positions[corner]);
        if (vertex == welded.position_of.size()) {
          welded.position_of.push_back(corner);
        }
      }
    }
  });
  welded.vertices = std::move(numbers).take();
  return welded;
}

// Numbers the edges, ascending by their lower and then their higher vertex, and finds the triangles beside
// them.
void connect(SurfaceMesh& mesh) {
  mesh.edge_vertices.clear();
  struct Side {
    std::uint32_t high, triangle, corner;
  };
  base::Rows<Side> by_low;
  by_low.group(mesh.vertices.size(), [&](auto&& pair) {
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t a = mesh.triangles[t].vertices[k], b = mesh.triangles[t].vertices[(k + 1) % 3];
        pair(std::min(a, b), Side{std::max(a, b), t, k});
      }
    }
  });
  mesh.edge_vertices.reserve(6 *
                             mesh.triangles.size());  // far more than needed; what is not used costs nothing
  for (std::uint32_t low = 0; low < by_low.count(); ++low) {
    const std::span<Side> sides = by_low[low];
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
      return std::tie(a.high, a.triangle, a.corner) < std::tie(b.high, b.triangle, b.corner);
    });
    std::uint32_t last = low;  // no edge ends where it begins
    for (const Side& side : sides) {
      if (side.high != last) {
        last = side.high;
        mesh.edge_vertices.insert(mesh.edge_vertices.end(), {low, last});
      }
      MeshTriangle& triangle = mesh.triangles[side.triangle];
      const bool back = triangle.vertices[side.corner] != low;
      triangle.edges[side.corner] = 2 * static_cast<std::uint32_t>(mesh.edgeCount() - 1) + (back ? 1 : 0);
    }
  }
  mesh.beside.group(mesh.edgeCount(), [&](auto&& pair) {
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      for (const std::uint32_t edge : mesh.triangles[t].edges) {
        pair(edge / 2, t);
      }
    }
  });
}

// By triangle, bit k for its edge k: the triangles at that edge do not cancel.
LargeVector<std::uint8_t> openEdges(const SurfaceMesh& mesh) {
  LargeVector<std::int32_t> sums(mesh.edgeCount());
  for (const MeshTriangle& triangle : mesh.triangles) {
    for (const std::uint32_t edge : triangle.edges) {
      sums[edge / 2] += edge % 2 == 0 ? 1 : -1;
    }
  }
  LargeVector<std::uint8_t> open(mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const bool remains = sums[mesh.triangles[t].edges[k] / 2] != 0;
      open[t] = static_cast<std::uint8_t>(open[t] | (remains ? 1u << k : 0u));
    }
  }
  return open;
}

}  // namespace

bool mayOcclude(const SceneView& scene, const Object& object) {
  return scene.materialOf(object).opaque() && object.mark != OccluderMark::kNever;
}

bool isFiniteTriangle(const SceneView& scene, std::span<const std::uint32_t> corners) {
  return isFinite(scene.positions[corners[0]]) && isFinite(scene.positions[corners[1]]) &&
         isFinite(scene.positions[corners[2]]);
}

OpaqueTriangles opaqueTriangles(const SceneView& scene) {
  WeldedVertices welded = weldVertices(scene);
  OpaqueTriangles opaque;
  forOpaqueTriangles(scene, [&](std::span<const std::uint32_t> corners, std::uint32_t object, bool) {
    for (const std::uint32_t corner : corners) {
      opaque.corners.push_back(welded.vertex_of[corner]);
    }
    opaque.objects.push_back(object);
  });
  opaque.vertices = std::move(welded.vertices);
  opaque.position_of = std::move(welded.position_of);
  return opaque;
}

SurfaceMesh weld(const SceneView& scene) {
  SurfaceMesh mesh;
  WeldedVertices welded = weldVertices(scene);
  mesh.vertices = std::move(welded.vertices);
  const LargeVector<std::uint32_t>& vertex_of = welded.vertex_of;
  mesh.triangles.reserve(scene.indices.size() / 3);
  forOpaqueTriangles(
      scene, [&](std::span<const std::uint32_t> corners, std::uint32_t object, bool double_sided) {
        const std::uint32_t a = vertex_of[corners[0]], b = vertex_of[corners[1]], c = vertex_of[corners[2]];
        if (a != b && b != c && c != a) {
          mesh.triangles.push_back({{a, b, c}, {}, object, double_sided});
        }
      });
  connect(mesh);
  return mesh;
}

void divideEdges(SurfaceMesh& mesh, const ParallelFor& parallel_for) {
  const LargeVector<std::uint8_t> open = openEdges(mesh);
  std::vector<std::uint32_t> asked, corners;
  std::vector<std::uint8_t> edges;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (open[t] != 0) {
      asked.push_back(t);
      edges.push_back(open[t]);
      corners.insert(corners.end(), mesh.triangles[t].vertices, mesh.triangles[t].vertices + 3);
    }
  }
  if (asked.empty()) {
    return;
  }
  const std::vector<Vec3d> vertices(mesh.vertices.begin(), mesh.vertices.end());
  const ClosedCracks divided = joinEdges({vertices, corners}, edges, parallel_for);
  LargeVector<MeshTriangle> pieces;
  pieces.reserve(mesh.triangles.size());
  std::size_t next = 0, piece = 0;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const MeshTriangle& triangle = mesh.triangles[t];
    const std::size_t before = pieces.size();
    if (next < asked.size() && asked[next] == t) {
      for (; piece < divided.source.size() && divided.source[piece] == next; ++piece) {
        const std::uint32_t* of = &divided.triangles[3 * piece];
        pieces.push_back({{of[0], of[1], of[2]}, {}, triangle.object, triangle.double_sided});
      }
      ++next;
    }
    if (pieces.size() == before) {
      pieces.push_back(triangle);
    }
  }
  mesh.triangles = std::move(pieces);
  connect(mesh);
}

}  // namespace sightline::occluders
