#include "src/io/gltf/gltf_skins.h"

#include <algorithm>
#include <cmath>

namespace sightline::io {

Result<const std::vector<Mat4>*> Skins::open(int skin, std::size_t user) {
  if (!isIndexInto(skin, skins_.size())) {
    return failure("{}: node {}: skin {} does not exist (the file has {})", document_.name, user, skin,
                   skins_.size());
  }
  const auto number = static_cast<std::size_t>(skin);
  std::optional<std::vector<Mat4>>& cached = skins_[number];
  if (!cached) {
    Result<std::vector<Mat4>> matrices =
        matricesOf(document_.file.skins[number], fmt::format("{}: skin {}", document_.name, skin));
    if (!matrices) {
      return matrices.error();
    }
    cached = std::move(*matrices);
  }
  return &*cached;
}

Result<std::vector<Mat4>> Skins::matricesOf(const GltfFile::Skin& skin, const std::string& where) {
  if (skin.joints.empty()) {
    return failure("{}: has no joints", where);
  }
  constexpr std::size_t kMostJoints = 65536;  // no vertex can name more
  if (skin.joints.size() > kMostJoints) {
    return failure("{}: has {} joints; at most {} are read", where, skin.joints.size(), kMostJoints);
  }
  joints_ += skin.joints.size();
  if (joints_ > document_.limits.elements) {
    return failure("{}: up to here, skins have {} joints; at most {} are read", where, joints_,
                   document_.limits.elements);
  }
  const AccessorView* inverse_bind = nullptr;
  if (skin.inverse_bind_matrices >= 0) {
    const Result<const AccessorView*> view =
        accessors_.view(skin.inverse_bind_matrices, "the matrices of a skin");
    if (!view) {
      return view.error();
    }
    inverse_bind = *view;
    if (inverse_bind->type() != ElementType::kMat4 ||
        inverse_bind->componentType() != ComponentType::kFloat ||
        inverse_bind->count() < skin.joints.size()) {
      return failure("{}: accessor {} does not hold a MAT4 of floats for each of its {} joints", where,
                     skin.inverse_bind_matrices, skin.joints.size());
    }
  }
  std::vector<Mat4> matrices;
  matrices.reserve(skin.joints.size());
  for (std::size_t i = 0; i < skin.joints.size(); ++i) {
    const int joint = skin.joints[i];
    if (!isIndexInto(joint, document_.file.nodes.size())) {
      return failure("{}: joint {}: node {} does not exist (the file has {})", where, i, joint,
                     document_.file.nodes.size());
    }
    if (!tree_.in_scene[static_cast<std::size_t>(joint)]) {
      return failure("{}: joint {}: node {} is not in the scene that the skin's mesh is in", where, i, joint);
    }
    Mat4 matrix = tree_.world_from_node[static_cast<std::size_t>(joint)];
    if (inverse_bind != nullptr) {
      const Result<Mat4> joint_from_mesh = inverseBindMatrix(*inverse_bind, i, where);
      if (!joint_from_mesh) {
        return joint_from_mesh.error();
      }
      matrix = matrix * *joint_from_mesh;
    }
    matrices.push_back(matrix);
  }
  return matrices;
}

Result<Mat4> Skins::inverseBindMatrix(const AccessorView& matrices, std::size_t joint,
                                      const std::string& where) const {
  // Exporters invert matrices in single precision, which leaves small errors in the last row.
  constexpr double kRounding = 1e-4;
  Mat4 matrix;
  for (std::size_t i = 0; i < 16; ++i) {
    matrix.m[i] = matrices.number(joint, static_cast<int>(i));
    const double last_row = i == 15 ? 1.0 : 0.0;
    const bool in_last_row = i % 4 == 3;
    if (!std::isfinite(matrix.m[i]) || (in_last_row && !(std::abs(matrix.m[i] - last_row) < kRounding))) {
      return failure("{}: inverse bind matrix {}: it is not finite, or its last row is not 0 0 0 1", where,
                     joint);
    }
    matrix.m[i] = in_last_row ? last_row : matrix.m[i];
  }
  return matrix;
}

}  // namespace sightline::io
