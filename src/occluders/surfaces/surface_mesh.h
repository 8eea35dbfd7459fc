#pragma once

// The opaque triangles of a scene as one mesh: equal positions are one vertex, equal pairs of them one edge.

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <utility>

#include "sightline/base/large_vector.h"
#include "sightline/base/parallel_for.h"
#include "sightline/scene/scene.h"
#include "src/base/rows.h"
#include "src/base/scratch_array.h"

namespace sightline::occluders {

// One of the three edges of a triangle, from its corner of that number to the next one: 3 * triangle +
// number.
using Corner = std::uint32_t;

// A triangle's way along an edge of the mesh.
struct Side {
  std::uint32_t code = 0;  // twice the corner, plus 1 if it runs from the edge's higher vertex to its lower

  Corner corner() const { return code / 2; }
  std::uint32_t triangle() const { return code / 6; }
  std::int32_t value() const { return code % 2 == 0 ? 1 : -1; }
};

struct SurfaceMesh {
  LargeVector<Vec3f> vertices;  // in the order in which triangles use them
  // Three different vertices each, counter-clockwise from the front; by object.
  LargeVector<std::array<std::uint32_t, 3>> triangles;
  LargeVector<std::uint32_t> objects;  // by triangle

  // Filled by connect().
  // By corner: the corner at which one other triangle runs back along the edge. Where there is no other
  // triangle: kNone; otherwise kCrowded and the number of the edge in `crowded`.
  LargeVector<std::uint32_t> beyond;
  static constexpr std::uint32_t kNone = 0xffffffffu, kCrowded = 0x80000000u;
  // Edges with more than two triangles, or two that run the same way: all their sides, ascending.
  base::Rows<Side> crowded;

  // Filled by connect(), and empty if nothing was divided: by triangle, which of the `given` ones it is a
  // piece of; and these as they were.
  LargeVector<std::uint32_t> source;
  LargeVector<std::array<std::uint32_t, 3>> given;

  std::size_t triangleCount() const { return triangles.size(); }
  // The vertices of an edge of the mesh, the lower one first.
  std::array<std::uint32_t, 2> endsOf(Side side) const {
    const std::array<std::uint32_t, 3>& triangle = triangles[side.triangle()];
    const std::uint32_t number = side.corner() % 3;
    const std::uint32_t from = triangle[number], to = triangle[number == 2 ? 0 : number + 1];
    return side.value() > 0 ? std::array{from, to} : std::array{to, from};
  }
  // Frees what only meetAtJunction() reads, which is not to be called afterwards.
  void forgetJunctions() {
    base::freeVector(source);
    base::freeVector(given);
  }
  // Frees all but the vertices.
  void forgetTriangles() {
    LargeVector<Vec3f> kept = std::move(vertices);
    *this = {};
    vertices = std::move(kept);
  }
  // Whether two triangles at an edge share it only because edges were divided: a corner of one of the given
  // triangles lay on an edge of the other.
  bool meetAtJunction(std::uint32_t a, std::uint32_t b) const {
    if (given.empty() || source[a] == source[b]) {
      return false;
    }
    int shared = 0;
    for (const std::uint32_t vertex : given[source[a]]) {
      shared += std::count(given[source[b]].begin(), given[source[b]].end(), vertex) > 0 ? 1 : 0;
    }
    return shared < 2;
  }
  // Calls visit(triangle) for all other triangles at the edge from a corner on, ascending, and maybe for the
  // corner's own.
  template <typename Visit>
  void forEachBeyond(Corner corner, Visit&& visit) const {
    const std::uint32_t other = beyond[corner];
    if (other < kCrowded) {
      visit(other / 3);
    } else if (other != kNone) {
      for (const Side side : crowded[other - kCrowded]) {
        visit(side.triangle());
      }
    }
  }
};

// Whether the object's triangles may be occluders: its material is opaque, and it is not marked kNever.
bool mayOcclude(const SceneView& scene, const Object& object);
// corners: three, into the scene's positions.
bool isFiniteTriangle(const SceneView& scene, std::span<const std::uint32_t> corners);

// The opaque triangles of a scene that are finite, with equal positions as one vertex.
struct OpaqueTriangles {
  LargeVector<Vec3f> vertices;             // in the order in which triangles use them
  LargeVector<std::uint32_t> position_of;  // by vertex: one of the scene's positions there
  LargeVector<std::uint32_t> corners;      // three for each triangle
  LargeVector<std::uint32_t> objects;      // by triangle, ascending
};
OpaqueTriangles opaqueTriangles(const SceneView& scene, const ParallelFor& parallel_for);

// The vertices and triangles of a scene. Leaves out triangles that are not finite, and those with two equal
// corners.
SurfaceMesh weld(const SceneView& scene, const ParallelFor& parallel_for);

// Finds what lies beyond the edges of triangles. divide_edges: edges at which triangles do not cancel are
// divided before where vertices of other such edges lie on them exactly, and their triangles with them. No
// vertex is new.
void connect(SurfaceMesh& mesh, bool divide_edges, const ParallelFor& parallel_for);

}  // namespace sightline::occluders
