#include "src/io/gltf/gltf_instances.h"

namespace sightline::io {

Mat4 InstanceSource::nodeFromInstance(std::uint64_t instance) const {
  NodePose pose;
  if (translations != nullptr) {
    pose.translation = translations->vector(instance);
  }
  if (rotations != nullptr) {
    for (std::size_t i = 0; i < 4; ++i) {
      pose.rotation[i] = rotations->number(instance, static_cast<int>(i));
    }
  }
  if (scales != nullptr) {
    pose.scale = scales->vector(instance);
  }
  return matrixOf(pose);
}

Result<InstanceSource> openInstances(const Document& document, std::size_t node, Accessors& accessors) {
  InstanceSource source;
  const std::optional<GltfFile::Instances>& instances = document.file.nodes[node].instances;
  if (!instances) {
    return source;
  }
  source.listed = true;
  const std::string user = fmt::format("node {} instances", node);
  bool first = true;
  for (const auto& [accessor, view, type] :
       {std::tuple(instances->translations, &source.translations, ElementType::kVec3),
        std::tuple(instances->rotations, &source.rotations, ElementType::kVec4),
        std::tuple(instances->scales, &source.scales, ElementType::kVec3)}) {
    if (accessor < 0) {
      continue;
    }
    const Result<const AccessorView*> opened = accessors.view(accessor, user);
    if (!opened) {
      return opened.error();
    }
    if ((*opened)->type() != type || (*opened)->componentType() == ComponentType::kUnsignedInt) {
      return failure(
          "{}: {}: translations and scales must be VEC3, and rotations VEC4, but accessor {} is not",
          document.name, user, accessor);
    }
    if (!first && (*opened)->count() != source.count) {
      return failure("{}: {}: accessor {} has {} elements, and the one before has {}", document.name, user,
                     accessor, (*opened)->count(), source.count);
    }
    first = false;
    source.count = (*opened)->count();
    *view = *opened;
  }
  return source;
}

}  // namespace sightline::io
