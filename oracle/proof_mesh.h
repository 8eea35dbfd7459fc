#pragma once

// The triangles of a scene that hide something, and how they are joined, for RegionProof. A triangle is given
// by its number; a sheet by twice that, plus 1 if it is seen from its back.

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <unordered_map>
#include <vector>

#include "oracle/region_signs.h"
#include "oracle/triangle_tree.h"
#include "sightline/scene/scene.h"

namespace sightline {

struct ProofMesh {
  static constexpr std::uint32_t kNoSheet = std::numeric_limits<std::uint32_t>::max();

  struct Triangle {
    std::uint32_t object = 0;
    bool double_sided = false;
    std::array<std::uint32_t, 3> vertex{};
    std::array<std::uint32_t, 3> edge{};  // from each vertex to the next
    Corners at{};
  };
  // The triangles at an edge: at_edges[first, first + count), ascending.
  struct Edge {
    std::size_t first = 0;
    std::uint32_t count = 0;
    bool of_one_object = true;
    // Partners of few triangles are found beforehand; among many, that would take too long.
    bool hasPartners() const { return of_one_object && count <= 8; }
  };
  struct Body {
    std::vector<std::uint32_t> triangles;
    bool closed = false;
  };

  // The scene's memory must outlive this object.
  explicit ProofMesh(const SceneView& scene);

  Corners cornersOf(std::uint32_t sheet) const {
    const Corners& t = triangles[sheet / 2].at;
    return sheet % 2 == 0 ? t : Corners{t.a, t.c, t.b};
  }
  std::array<std::uint32_t, 3> verticesOf(std::uint32_t sheet) const {
    const auto& v = triangles[sheet / 2].vertex;
    return sheet % 2 == 0 ? v : std::array<std::uint32_t, 3>{v[0], v[2], v[1]};
  }
  // The edge from the sheet's vertex k (of verticesOf) to the next.
  std::uint32_t edgeOf(std::uint32_t sheet, std::uint32_t k) const {
    return triangles[sheet / 2].edge[sheet % 2 == 0 ? k : 2 - k];
  }
  // The sheet that is joined with this one at its edge k, without the left-out objects; kNoSheet if there is
  // none. Joining is mutual, so that joined edges cancel, whatever the choice. Precondition: the sheet's
  // object is not left out.
  std::uint32_t partnerOf(std::uint32_t sheet, std::uint32_t k,
                          std::span<const std::uint32_t> left_out) const {
    return edges[edgeOf(sheet, k)].hasPartners() ? partners[sheet][k] : partnerAt(sheet, k, left_out);
  }
  // True if the segment surely meets no triangle of the object.
  bool misses(const Vec3d& from, const Vec3d& to, ObjectId object) const;

  SceneView scene;
  TriangleTree tree;
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> first_of;                         // by object: its first triangle
  std::unordered_map<std::uint64_t, std::uint32_t> number_of;  // by triangleKey()
  std::vector<Edge> edges;
  std::vector<std::uint32_t> at_edges;  // triangles
  // By sheet: those that it is joined with at the edges that have partners.
  std::vector<std::array<std::uint32_t, 3>> partners;
  std::vector<Body> bodies;
  std::vector<std::uint32_t> body_of;

 private:
  void gather();
  void findEdges();
  void findBodies();
  void findPartners();
  std::span<const std::uint32_t> trianglesAt(std::uint32_t edge) const {
    return std::span(at_edges).subspan(edges[edge].first, edges[edge].count);
  }
  std::uint32_t partnerAt(std::uint32_t sheet, std::uint32_t k,
                          std::span<const std::uint32_t> left_out) const;
};

}  // namespace sightline
