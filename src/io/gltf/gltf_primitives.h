#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "src/io/gltf/gltf_model.h"

namespace sightline::io {

// A primitive with triangles, its accessors checked; index values are not.
struct PrimitiveSource {
  std::string where;  // "mesh 3 primitive 0", for errors
  std::size_t number = 0;
  int material = -1;
  // The weakest of its material and those that variants put in its place: what it surely hides.
  Opacity opacity = Opacity::kOpaque;
  bool double_sided = false;
  std::optional<bool> occluder;  // mark of its material; false if any material has that
  int mode = PrimitiveMode::kTriangles;
  int position_accessor = -1;
  const AccessorView* positions = nullptr;
  const AccessorView* indices = nullptr;             // nullptr: vertices in order
  std::vector<const AccessorView*> targets;          // displacements of positions; nullptr: none
  std::vector<const AccessorView*> joints, weights;  // by set, as many of both
  std::uint64_t triangles = 0;
  std::uint64_t vertices = 0;  // at most so many are used

  // Which places of the vertex sequence are the corners of a triangle.
  std::array<std::uint64_t, 3> cornersOf(std::uint64_t triangle) const;
};

// A morph target whose weight is not 0.
struct ActiveTarget {
  std::size_t number = 0;
  double weight = 0.0;
};
std::vector<ActiveTarget> activeTargets(std::span<const double> weights);

struct MeshSource {
  std::vector<PrimitiveSource> primitives;  // those with triangles
  std::uint64_t triangles = 0, vertices = 0;
  std::uint64_t implied_vertices = 0;        // those of them without bytes in the file
  std::uint64_t joint_vertices = 0;          // vertices, as often as sets of joints place them
  std::vector<ActiveTarget> active_targets;  // by the mesh's own weights
};

// Opens each mesh once, however many nodes show it.
class MeshSources {
 public:
  MeshSources(const Document& document, Accessors& accessors)
      : document_(document), accessors_(accessors), meshes_(document.file.meshes.size()) {}

  // Precondition: the mesh exists.
  Result<const MeshSource*> open(std::size_t mesh);

 private:
  Result<PrimitiveSource> openPrimitive(std::size_t mesh, std::size_t number);
  Status openMaterials(const GltfFile::Primitive& primitive, PrimitiveSource& source) const;
  Status openAccessors(const GltfFile::Primitive& primitive, PrimitiveSource& source);
  Status openTargets(const GltfFile::Primitive& primitive, PrimitiveSource& source);
  Status openJoints(const GltfFile::Primitive& primitive, PrimitiveSource& source);

  const Document& document_;
  Accessors& accessors_;
  std::vector<std::optional<MeshSource>> meshes_;
};

}  // namespace sightline::io
