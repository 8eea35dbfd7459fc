#pragma once

// What the steps of the glTF reader share: the parsed file with its bytes, and checked access to its parts.

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sightline/math/mat4.h"
#include "src/io/failure.h"
#include "src/io/gltf/gltf_buffers.h"
#include "src/io/gltf/gltf_file.h"
#include "src/io/scene_builder.h"

namespace sightline::io {

// What animations and extensions change as time goes on: a flag for each part of the file.
struct Moving {
  std::vector<bool> nodes;                     // it moves, or is shown only at times, with all below it
  std::vector<bool> visibility;                // of nodes: an animation shows and hides it
  std::vector<bool> node_shapes, mesh_shapes;  // the weights of morph targets
  std::vector<bool> materials;                 // lets light through at times
};
Moving movingParts(const GltfFile& file);

struct Document {
  std::string name;  // of the file, in errors
  ImportLimits limits;
  GltfFile file;
  Moving moving;
  std::string note;  // on its extensions, for the user
  Buffers buffers;
};

// Elements of an accessor, all checked to lie in their buffer.
class AccessorView {
 public:
  std::uint64_t count() const { return count_; }
  int componentType() const { return component_type_; }
  ElementType type() const { return type_; }
  bool normalized() const { return normalized_; }
  bool implied() const { return data_ == nullptr; }  // all is zero but for what a sparse accessor replaces

  // Component of an element, normalised where the accessor says so. Precondition: element < count().
  double number(std::uint64_t element, int component) const;
  Vec3d vector(std::uint64_t element) const {
    return {number(element, 0), number(element, 1), number(element, 2)};
  }
  // Precondition: the accessor holds integers, and element < count().
  std::uint32_t index(std::uint64_t element) const;

 private:
  friend Result<AccessorView> openAccessor(const Document&, int, const std::string&);
  friend Status addSparse(const Document&, int, AccessorView&);

  const char* addressOf(std::uint64_t element) const;

  const char* data_ = nullptr;  // nullptr: all zero
  std::uint64_t stride_ = 0;
  std::uint64_t count_ = 0;
  std::uint64_t element_size_ = 0;
  int component_type_ = 0;
  ElementType type_ = ElementType::kScalar;
  bool normalized_ = false;
  std::vector<std::uint32_t> replaced_;  // sparse: ascending
  const char* replacements_ = nullptr;
};

// Checks each accessor once, when it is first asked for: instances must not multiply the work.
class Accessors {
 public:
  explicit Accessors(const Document& document)
      : document_(document), views_(document.file.accessors.size()) {}

  // Valid as long as this object. user: who refers to the accessor, in errors ("mesh 3 primitive 0").
  Result<const AccessorView*> view(int accessor, const std::string& user);

 private:
  const Document& document_;
  std::vector<std::optional<AccessorView>> views_;
};

// The nodes of the file as a forest.
struct NodeTree {
  std::vector<int> parent;  // -1: none
  std::vector<Mat4> parent_from_node;
  std::vector<Mat4> world_from_node;
  std::vector<int> visited;  // nodes of the default scene, depth first
  std::vector<bool> in_scene;
  std::vector<bool> moves;   // it or a node above it does: see Moving
  std::vector<bool> hidden;  // it or a node above it is, at all times
  std::vector<bool> flat;    // it or a node above it: see CornerOrder::kUnknown
};
Result<NodeTree> buildNodeTree(const Document& document);

Mat4 matrixOf(const NodePose& pose);

// Whether a material can be seen through. Precondition: it exists.
Opacity opacityOf(const Document& document, std::size_t material);

Status addMaterials(const Document& document, SceneBuilder& builder);
Status addObjects(const Document& document, const NodeTree& tree, Accessors& accessors,
                  SceneBuilder& builder);
Status addCameras(const Document& document, const NodeTree& tree, Accessors& accessors,
                  SceneBuilder& builder);

inline bool isIndexInto(int index, std::size_t size) {
  return index >= 0 && static_cast<std::size_t>(index) < size;
}

}  // namespace sightline::io
