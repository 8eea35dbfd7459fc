#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "src/io/gltf/gltf_primitives.h"

namespace sightline::io {

// The matrices of each skin, made once, however many nodes use it.
class Skins {
 public:
  Skins(const Document& document, const NodeTree& tree, Accessors& accessors)
      : document_(document), tree_(tree), accessors_(accessors), skins_(document.file.skins.size()) {}

  // The matrix that takes a vertex of the mesh to the world, for each joint: the joint's own in the pose of
  // the nodes, times its inverse bind matrix. user: the node with the skin, in errors.
  Result<const std::vector<Mat4>*> open(int skin, std::size_t user);

 private:
  Result<std::vector<Mat4>> matricesOf(const GltfFile::Skin& skin, const std::string& where);
  Result<Mat4> inverseBindMatrix(const AccessorView& matrices, std::size_t joint,
                                 const std::string& where) const;

  const Document& document_;
  const NodeTree& tree_;
  Accessors& accessors_;
  std::vector<std::optional<std::vector<Mat4>>> skins_;
  std::uint64_t joints_ = 0;  // of all that were opened
};

}  // namespace sightline::io
