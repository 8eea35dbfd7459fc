#pragma once

#include "src/io/gltf/gltf_model.h"

namespace sightline::io {

// The instances of a node's mesh by EXT_mesh_gpu_instancing; without the extension, the mesh itself.
struct InstanceSource {
  const AccessorView* translations = nullptr;
  const AccessorView* rotations = nullptr;
  const AccessorView* scales = nullptr;
  std::uint64_t count = 1;
  bool listed = false;  // by the extension

  // Precondition: instance < count.
  Mat4 nodeFromInstance(std::uint64_t instance) const;
};

Result<InstanceSource> openInstances(const Document& document, std::size_t node, Accessors& accessors);

}  // namespace sightline::io
