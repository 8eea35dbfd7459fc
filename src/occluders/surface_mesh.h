#pragma once

// The opaque triangles of a scene as one mesh: equal positions are one vertex, equal pairs of them one edge.

#include <cstdint>
#include <span>

#include "sightline/base/large_vector.h"
#include "sightline/base/parallel_for.h"
#include "sightline/scene/scene.h"
#include "src/base/rows.h"

namespace sightline::occluders {

struct MeshTriangle {
  std::uint32_t vertices[3] = {};  // three different ones, counter-clockwise from the front
  // Edge i goes from vertex i to the next one: twice its number, plus 1 if it runs from its higher to its
  // lower vertex.
  std::uint32_t edges[3] = {};
  std::uint32_t object = 0;
  bool double_sided = false;
};

struct SurfaceMesh {
  LargeVector<Vec3f> vertices;               // in the order in which triangles use them
  LargeVector<MeshTriangle> triangles;       // by object
  LargeVector<std::uint32_t> edge_vertices;  // two for each edge, the lower one first
  base::Rows<std::uint32_t> beside;          // triangles by edge

  std::size_t edgeCount() const { return edge_vertices.size() / 2; }
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
OpaqueTriangles opaqueTriangles(const SceneView& scene);

// Leaves out triangles that are not finite, and those with two equal corners.
SurfaceMesh weld(const SceneView& scene);

// Divides edges at which triangles do not cancel where vertices of other such edges lie on them exactly, and
// their triangles with them. No vertex is new.
void divideEdges(SurfaceMesh& mesh, const ParallelFor& parallel_for);

}  // namespace sightline::occluders
