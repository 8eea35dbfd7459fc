#include "src/layers/hull/hull_solid.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "src/base/rows.h"
#include "src/layers/hull/hull_descent.h"
#include "src/layers/hull/hull_excess.h"
#include "src/layers/hull/qhull_candidates.h"
#include "src/layers/hull/support.h"

namespace sightline::layers {
namespace {

constexpr int kMaxRounds = 64;
// Points farther outside than this many times the tolerance become vertices.
constexpr double kWorthInserting = 4.0;
constexpr std::size_t kLookAtAll = 4096;  // vertices up to which all are compared to place faces

// Returns the corners of the mesh at which at least `min_edges` edges end, ascending.
std::vector<std::uint32_t> cornersOf(const HullMesh& mesh, std::size_t points, std::uint32_t min_edges) {
  std::vector<std::uint32_t> edges(points, 0);
  std::vector<std::uint8_t> used(points, 0);
  for (const HullMesh::Facet& facet : mesh.facets()) {
    if (!facet.live) {
      continue;
    }
    for (std::size_t i = 0; i < 3; ++i) {
      used[facet.corner[i]] = 1;
      edges[facet.corner[i]] += mesh.bends(facet, i) ? 1 : 0;
    }
  }
  std::vector<std::uint32_t> corners;
  for (std::uint32_t i = 0; i < points; ++i) {
    if (used[i] != 0 && edges[i] >= min_edges) {
      corners.push_back(i);
    }
  }
  return corners;
}

// Rebuilds the mesh without corners inside an edge, which have two edges, and inside a side, which have none.
void dropFlatCorners(HullMesh& mesh, std::span<const Vec3d> points) {
  for (int round = 0; round < kMaxRounds; ++round) {
    const std::vector<std::uint32_t> extreme = cornersOf(mesh, points.size(), 3);
    if (extreme.size() == cornersOf(mesh, points.size(), 0).size()) {
      return;
    }
    const HullFrame frame = hullFrame(points, extreme);
    if (frame.dimension < 3) {
      return;
    }
    HullMesh fewer(points, extreme, frame);
    if (!fewer.valid()) {
      return;
    }
    mesh = std::move(fewer);
  }
}

std::optional<Vec3d> pointInside(const HullMesh& mesh, std::span<const Vec3d> points,
                                 const HullFrame& frame) {
  const auto mean = [&points](std::span<const std::uint32_t> numbers) {
    const Vec3d first = points[numbers[0]];
    Vec3d sum;
    for (const std::uint32_t i : numbers) {
      sum += points[i] - first;
    }
    return first + sum / static_cast<double>(numbers.size());
  };
  for (const Vec3d& inside : {mean(cornersOf(mesh, points.size(), 0)), mean(frame.corners)}) {
    if (strictlyInside(mesh, inside)) {
      return inside;
    }
  }
  return std::nullopt;
}

// Returns the face of each triangle. Coplanar triangles make one face; faces are numbered by their first
// triangle.
std::vector<std::uint32_t> facesOf(const HullMesh& mesh, std::uint32_t& faces) {
  constexpr std::uint32_t kNone = 0xffffffffu;
  std::vector<std::uint32_t> face(mesh.facets().size(), kNone);
  std::vector<std::uint32_t> open;
  faces = 0;
  for (std::uint32_t first = 0; first < face.size(); ++first) {
    if (!mesh.facets()[first].live || face[first] != kNone) {
      continue;
    }
    open.assign(1, first);
    face[first] = faces;
    while (!open.empty()) {
      const HullMesh::Facet& facet = mesh.facets()[open.back()];
      open.pop_back();
      for (std::size_t i = 0; i < 3; ++i) {
        if (face[facet.across[i]] == kNone && !mesh.bends(facet, i)) {
          face[facet.across[i]] = faces;
          open.push_back(facet.across[i]);
        }
      }
    }
    ++faces;
  }
  return face;
}

// Sets the edges of the triangles, without those inside a face.
void setEdges(ConvexHull& hull, const HullMesh& mesh, std::span<const std::uint32_t> vertex_of) {
  std::vector<std::array<std::uint32_t, 2>> edges;
  for (const HullMesh::Facet& facet : mesh.facets()) {
    for (std::size_t i = 0; facet.live && i < 3; ++i) {
      if (mesh.bends(facet, i)) {
        edges.push_back({vertex_of[facet.corner[i]], vertex_of[facet.corner[(i + 1) % 3]]});
      }
    }
  }
  std::sort(edges.begin(), edges.end());
  base::groupIntoRows(hull.vertices.size(), hull.first_neighbour, hull.neighbours, [&](auto&& body) {
    for (const std::array<std::uint32_t, 2>& edge : edges) {
      body(edge[0], edge[1]);
    }
  });
}

// Sets the faces. A face's plane has the normal of its largest triangle and lies at or just beyond the
// farthest vertex in that direction.
void setFaces(ConvexHull& hull, const HullMesh& mesh, std::span<const std::uint32_t> vertex_of) {
  std::uint32_t count = 0;
  const std::vector<std::uint32_t> face = facesOf(mesh, count);
  std::vector<double> largest(count, -1.0);
  // supportError() for coordinates of at most 1.
  const double rounding = 0x1p-49 * (1.0 + 2.0 * hull.descent_factor);
  hull.faces.resize(count);
  for (std::size_t i = 0; i < face.size(); ++i) {
    const HullMesh::Facet& facet = mesh.facets()[i];
    if (!facet.live) {
      continue;
    }
    const Vec3d first = mesh.at(facet.corner[0]);
    const double area = length(cross(mesh.at(facet.corner[1]) - first, mesh.at(facet.corner[2]) - first));
    if (area > largest[face[i]]) {
      largest[face[i]] = area;
      const double height = farthest(hull, facet.normal, vertex_of[facet.corner[0]]).height;
      hull.faces[face[i]] = {facet.normal, -(height + rounding)};
    }
  }
}

ConvexHull hullOf(const HullMesh& mesh, std::span<const Vec3d> points,
                  std::span<const std::uint32_t> numbers) {
  ConvexHull hull;
  hull.dimension = 3;
  std::vector<std::uint32_t> vertex_of(points.size(), 0);
  for (const std::uint32_t i : numbers) {
    vertex_of[i] = static_cast<std::uint32_t>(hull.vertices.size());
    hull.vertices.push_back(points[i]);
  }
  std::vector<Vec3d> uphill(hull.vertices.size());
  for (const HullMesh::Facet& facet : mesh.facets()) {
    if (facet.live) {
      const auto& c = facet.corner;
      hull.triangles.push_back({vertex_of[c[0]], vertex_of[c[1]], vertex_of[c[2]]});
      for (const std::uint32_t v : hull.triangles.back()) {
        uphill[v] += facet.normal;
      }
    }
  }
  setEdges(hull, mesh, vertex_of);
  const double factor = descentFactor(hull, uphill);
  // Comparing all vertices gives the tightest planes.
  hull.descent_factor = hull.vertices.size() > kLookAtAll ? factor : 0.0;
  setFaces(hull, mesh, vertex_of);
  hull.descent_factor = factor;
  return hull;
}

}  // namespace

std::optional<ConvexHull> solidHull(std::span<const Vec3d> points, const HullFrame& frame,
                                    std::vector<std::uint32_t>& numbers) {
  std::vector<std::uint32_t> chosen = qhullCandidates(points, frame.middle);
  if (chosen.size() < 4) {  // Qhull gave up
    chosen.resize(points.size());
    std::iota(chosen.begin(), chosen.end(), 0u);
  }
  HullMesh mesh(points, chosen, frame);
  if (!mesh.valid()) {
    return std::nullopt;
  }
  HullExcess excess;
  for (int round = 0; round < kMaxRounds; ++round) {
    dropFlatCorners(mesh, points);
    const std::optional<Vec3d> inside = pointInside(mesh, points, frame);
    if (!inside) {
      return std::nullopt;
    }
    excess = hullExcess(mesh, points, *inside);
    if (excess.distance <= kWorthInserting * frame.tolerance || round + 1 == kMaxRounds) {
      break;
    }
    mesh.insert(excess.point, excess.facet);
  }
  numbers = cornersOf(mesh, points.size(), 0);
  ConvexHull hull = hullOf(mesh, points, numbers);
  hull.slack = excess.distance;
  return hull;
}

}  // namespace sightline::layers
