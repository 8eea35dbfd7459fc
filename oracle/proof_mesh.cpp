#include "oracle/proof_mesh.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "oracle/ray_scene.h"

namespace sightline {
namespace {

bool runs(const ProofMesh::Triangle& t, std::uint32_t from, std::uint32_t to) {
  return (t.vertex[0] == from && t.vertex[1] == to) || (t.vertex[1] == from && t.vertex[2] == to) ||
         (t.vertex[2] == from && t.vertex[0] == to);
}

}  // namespace

ProofMesh::ProofMesh(const SceneView& s) : scene(s), tree(s) {
  gather();
  findEdges();
  findBodies();
  findPartners();
}

void ProofMesh::gather() {
  std::map<std::array<float, 3>, std::uint32_t> numbers;
  first_of.assign(scene.objects.size() + 1, 0);
  for (std::uint32_t o = 0; o < scene.objects.size(); ++o) {
    const Object& object = scene.objects[o];
    first_of[o] = static_cast<std::uint32_t>(triangles.size());
    if (!occludes(scene, object)) {
      continue;
    }
    const std::span<const std::uint32_t> indices = scene.indicesOf(object);
    const bool both = scene.materialOf(object).double_sided;
    for (std::uint32_t i = 0; i + 2 < indices.size(); i += 3) {
      Triangle t{.object = o, .double_sided = both};
      bool finite = true;
      for (std::uint32_t k = 0; k < 3; ++k) {
        const Vec3f p = scene.positions[indices[i + k]];
        finite = finite && std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
        // Adding 0 turns -0 into 0.
        const std::array<float, 3> key{p.x + 0.0f, p.y + 0.0f, p.z + 0.0f};
        t.vertex[k] =
            finite ? numbers.emplace(key, static_cast<std::uint32_t>(numbers.size())).first->second : 0;
        (k == 0 ? t.at.a : k == 1 ? t.at.b : t.at.c) = Vec3d(p);
      }
      if (finite && t.vertex[0] != t.vertex[1] && t.vertex[1] != t.vertex[2] && t.vertex[2] != t.vertex[0]) {
        number_of.emplace(triangleKey(ObjectId(o), object.first_index + i),
                          static_cast<std::uint32_t>(triangles.size()));
        triangles.push_back(t);
      }
    }
  }
  first_of.back() = static_cast<std::uint32_t>(triangles.size());
}

void ProofMesh::findEdges() {
  std::unordered_map<std::uint64_t, std::uint32_t> numbers;  // by both vertices, the lower one first
  for (Triangle& t : triangles) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(t.vertex[k], t.vertex[(k + 1) % 3]);
      t.edge[k] = numbers.emplace(std::uint64_t{low} << 32 | high, static_cast<std::uint32_t>(edges.size()))
                      .first->second;
      edges.resize(std::max<std::size_t>(edges.size(), t.edge[k] + 1));
      edges[t.edge[k]].count += 1;
    }
  }
  std::size_t first = 0;
  for (Edge& edge : edges) {
    edge.first = first;
    first += std::exchange(edge.count, 0);
  }
  at_edges.resize(first);
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    for (const std::uint32_t number : triangles[i].edge) {
      Edge& edge = edges[number];
      at_edges[edge.first + edge.count++] = i;
      edge.of_one_object =
          triangles[at_edges[edge.first]].object == triangles[i].object && edge.of_one_object;
    }
  }
}

// Finds what of each object is connected over edges, and whether its directed edges cancel.
void ProofMesh::findBodies() {
  body_of.assign(triangles.size(), kNoSheet);
  for (std::uint32_t start = 0; start < triangles.size(); ++start) {
    if (body_of[start] != kNoSheet) {
      continue;
    }
    const auto number = static_cast<std::uint32_t>(bodies.size());
    Body body{{start}, true};
    body_of[start] = number;
    for (std::size_t i = 0; i < body.triangles.size(); ++i) {
      const Triangle& t = triangles[body.triangles[i]];
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t from = t.vertex[k], to = t.vertex[(k + 1) % 3];
        int sum = 0;
        for (const std::uint32_t other : trianglesAt(t.edge[k])) {
          if (triangles[other].object != t.object) {
            continue;
          }
          sum += runs(triangles[other], from, to) ? 1 : -1;
          if (body_of[other] == kNoSheet) {
            body_of[other] = number;
            body.triangles.push_back(other);
          }
        }
        body.closed = body.closed && sum == 0;
      }
    }
    bodies.push_back(std::move(body));
  }
}

void ProofMesh::findPartners() {
  partners.assign(2 * triangles.size(), {kNoSheet, kNoSheet, kNoSheet});
  for (std::uint32_t sheet = 0; sheet < partners.size(); ++sheet) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      if ((sheet % 2 == 0 || triangles[sheet / 2].double_sided) && edges[edgeOf(sheet, k)].hasPartners()) {
        partners[sheet][k] = partnerAt(sheet, k, {});
      }
    }
  }
}

std::uint32_t ProofMesh::partnerAt(std::uint32_t sheet, std::uint32_t k,
                                   std::span<const std::uint32_t> left_out) const {
  std::vector<std::uint32_t> there, back;
  const std::array<std::uint32_t, 3> vertices = verticesOf(sheet);
  const auto [low, high] = std::minmax(vertices[k], vertices[(k + 1) % 3]);
  for (const std::uint32_t t : trianglesAt(edgeOf(sheet, k))) {
    if (std::find(left_out.begin(), left_out.end(), triangles[t].object) != left_out.end()) {
      continue;
    }
    const bool runs_up = runs(triangles[t], low, high);
    (runs_up ? there : back).push_back(2 * t);
    if (triangles[t].double_sided) {
      (runs_up ? back : there).push_back(2 * t + 1);
    }
  }
  for (const std::uint32_t one : there) {
    const auto score = [&](std::uint32_t other) {
      const Corners a = cornersOf(one), b = cornersOf(other);
      const Vec3d n = cross(a.b - a.a, a.c - a.a), m = cross(b.b - b.a, b.c - b.a);
      const double alike = dot(n, m) / std::max(1e-300, length(n) * length(m));
      return alike + (triangles[one / 2].object == triangles[other / 2].object ? 0.1 : 0.0);
    };
    const auto best = std::max_element(back.begin(), back.end(),
                                       [&](std::uint32_t a, std::uint32_t b) { return score(a) < score(b); });
    if (best == back.end()) {
      return kNoSheet;
    }
    if (one == sheet || *best == sheet) {
      return one == sheet ? *best : one;
    }
    back.erase(best);
  }
  return kNoSheet;
}

bool ProofMesh::misses(const Vec3d& from, const Vec3d& to, ObjectId object) const {
  for (std::uint32_t t = first_of[object.value]; t < first_of[object.value + 1]; ++t) {
    if (crossing(triangles[t].at, from, to) != 0) {
      return false;
    }
  }
  return true;
}

}  // namespace sightline
