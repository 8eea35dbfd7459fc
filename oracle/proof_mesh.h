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
    Corners at{};
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
  // The sheet that is joined with this one at its edge, without the left-out objects; kNoSheet if there is
  // none. Joining is mutual, so that joined edges cancel, whatever the choice.
  std::uint32_t partnerOf(std::uint32_t sheet, std::uint32_t from, std::uint32_t to,
                          std::span<const std::uint32_t> left_out) const;
  // True if the segment surely meets no triangle of the object.
  bool misses(const Vec3d& from, const Vec3d& to, ObjectId object) const;

  SceneView scene;
  TriangleTree tree;
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> first_of;                         // by object: its first triangle
  std::unordered_map<std::uint32_t, std::uint32_t> number_of;  // by first index in the scene
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> edges;
  std::vector<Body> bodies;
  std::vector<std::uint32_t> body_of;

 private:
  void gather();
  void findBodies();
};

}  // namespace sightline
