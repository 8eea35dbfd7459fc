#include "src/io/gltf/gltf_primitives.h"

#include <algorithm>

namespace sightline::io {
namespace {

bool isIndexType(const AccessorView& view) {
  const int type = view.componentType();
  return view.type() == ElementType::kScalar &&
         (type == ComponentType::kUnsignedByte || type == ComponentType::kUnsignedShort ||
          type == ComponentType::kUnsignedInt);
}

bool isJointType(const AccessorView& view) {
  return view.type() == ElementType::kVec4 && !view.normalized() &&
         (view.componentType() == ComponentType::kUnsignedByte ||
          view.componentType() == ComponentType::kUnsignedShort);
}

// Integers that are not normalized count all the same: only the ratio of weights matters.
bool isWeightType(const AccessorView& view) {
  return view.type() == ElementType::kVec4 && (view.componentType() == ComponentType::kUnsignedByte ||
                                               view.componentType() == ComponentType::kUnsignedShort ||
                                               view.componentType() == ComponentType::kFloat);
}

bool isPositionType(const AccessorView& view) {
  return view.type() == ElementType::kVec3 && view.componentType() != ComponentType::kUnsignedInt;
}

}  // namespace

std::array<std::uint64_t, 3> PrimitiveSource::cornersOf(std::uint64_t triangle) const {
  switch (mode) {
    case PrimitiveMode::kTriangleStrip:
      return {triangle, triangle + 1 + triangle % 2, triangle + 2 - triangle % 2};
    case PrimitiveMode::kTriangleFan:
      return {triangle + 1, triangle + 2, 0};
    default:
      return {3 * triangle, 3 * triangle + 1, 3 * triangle + 2};
  }
}

std::vector<ActiveTarget> activeTargets(std::span<const double> weights) {
  std::vector<ActiveTarget> targets;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    if (weights[i] != 0.0) {
      targets.push_back({i, weights[i]});
    }
  }
  return targets;
}

Result<const MeshSource*> MeshSources::open(std::size_t mesh) {
  std::optional<MeshSource>& cached = meshes_[mesh];
  if (cached) {
    return &*cached;
  }
  MeshSource source;
  for (std::size_t number = 0; number < document_.file.meshes[mesh].primitives.size(); ++number) {
    Result<PrimitiveSource> primitive = openPrimitive(mesh, number);
    if (!primitive) {
      return primitive.error();
    }
    if (primitive->triangles > 0) {
      source.triangles += primitive->triangles;
      source.vertices += primitive->vertices;
      source.joint_vertices += primitive->vertices * primitive->joints.size();
      source.implied_vertices += primitive->positions->implied() ? primitive->vertices : 0;
      source.primitives.push_back(std::move(*primitive));
    }
  }
  source.active_targets = activeTargets(document_.file.meshes[mesh].weights);
  cached = std::move(source);
  return &*cached;
}

Result<PrimitiveSource> MeshSources::openPrimitive(std::size_t mesh, std::size_t number) {
  const GltfFile::Primitive& primitive = document_.file.meshes[mesh].primitives[number];
  PrimitiveSource source;
  source.where = fmt::format("mesh {} primitive {}", mesh, number);
  source.number = number;
  source.mode = primitive.mode;
  source.material = primitive.material;
  if (source.mode > PrimitiveMode::kTriangleFan) {
    return failure("{}: {}: mode {} does not exist", document_.name, source.where, source.mode);
  }
  if (source.mode < PrimitiveMode::kTriangles) {
    return source;  // points and lines
  }
  Status status = openMaterials(primitive, source);
  if (status) {
    status = openAccessors(primitive, source);
  }
  if (status) {
    status = openTargets(primitive, source);
  }
  if (status) {
    status = openJoints(primitive, source);
  }
  if (!status) {
    return status.error();
  }
  const std::uint64_t corners = (source.indices == nullptr ? source.positions : source.indices)->count();
  if (source.mode == PrimitiveMode::kTriangles && corners % 3 != 0) {
    return failure("{}: {}: {} corners do not make whole triangles", document_.name, source.where, corners);
  }
  const std::uint64_t strung = corners < 3 ? 0 : corners - 2;  // of a strip or fan
  source.triangles = source.mode == PrimitiveMode::kTriangles ? corners / 3 : strung;
  source.vertices = std::min(corners, source.positions->count());
  return source;
}

Status MeshSources::openMaterials(const GltfFile::Primitive& primitive, PrimitiveSource& source) const {
  const std::vector<GltfFile::Material>& materials = document_.file.materials;
  const auto add = [&](int material, bool own) {
    if (!isIndexInto(material, materials.size())) {
      return false;
    }
    const auto number = static_cast<std::size_t>(material);
    const Opacity opacity = opacityOf(document_, number);
    if (opacity == Opacity::kBlended || source.opacity == Opacity::kOpaque) {
      source.opacity = opacity;
    }
    source.double_sided = (own || source.double_sided) && materials[number].double_sided;
    if (own || materials[number].occluder == false) {
      source.occluder = materials[number].occluder;
    }
    return true;
  };
  int missing = primitive.material < 0 || add(primitive.material, true) ? -1 : primitive.material;
  for (const int variant : primitive.variants) {
    missing = missing >= 0 || add(variant, false) ? missing : variant;
  }
  if (missing >= 0) {
    return failure("{}: {}: material {} does not exist (the file has {})", document_.name, source.where,
                   missing, materials.size());
  }
  return Success{};
}

Status MeshSources::openAccessors(const GltfFile::Primitive& primitive, PrimitiveSource& source) {
  if (primitive.positions < 0) {
    return failure("{}: {}: has no POSITION attribute", document_.name, source.where);
  }
  source.position_accessor = primitive.positions;
  const Result<const AccessorView*> positions = accessors_.view(source.position_accessor, source.where);
  if (!positions) {
    return positions.error();
  }
  if (!isPositionType(**positions)) {
    return failure("{}: {}: positions must be VEC3 of floats, bytes or shorts, but accessor {} is not",
                   document_.name, source.where, source.position_accessor);
  }
  source.positions = *positions;
  if (primitive.indices < 0) {
    return Success{};
  }
  const Result<const AccessorView*> indices = accessors_.view(primitive.indices, source.where);
  if (!indices) {
    return indices.error();
  }
  if (!isIndexType(**indices)) {
    return failure("{}: {}: indices must be SCALAR of unsigned integers, but accessor {} is not",
                   document_.name, source.where, primitive.indices);
  }
  source.indices = *indices;
  return Success{};
}

Status MeshSources::openTargets(const GltfFile::Primitive& primitive, PrimitiveSource& source) {
  for (const int target : primitive.targets) {
    if (target < 0) {
      source.targets.push_back(nullptr);
      continue;
    }
    const Result<const AccessorView*> view = accessors_.view(target, source.where);
    if (!view) {
      return view.error();
    }
    if (!isPositionType(**view) || (*view)->count() != source.positions->count()) {
      return failure(
          "{}: {}: morph target {} must displace each of {} vertices, by VEC3 of floats, bytes or shorts, "
          "but "
          "accessor {} does not",
          document_.name, source.where, source.targets.size(), source.positions->count(), target);
    }
    source.targets.push_back(*view);
  }
  return Success{};
}

Status MeshSources::openJoints(const GltfFile::Primitive& primitive, PrimitiveSource& source) {
  if (primitive.joints.size() != primitive.weights.size()) {
    return failure("{}: {}: has {} sets JOINTS_n, but {} WEIGHTS_n", document_.name, source.where,
                   primitive.joints.size(), primitive.weights.size());
  }
  for (std::size_t set = 0; set < primitive.joints.size(); ++set) {
    const Result<const AccessorView*> joints = accessors_.view(primitive.joints[set], source.where);
    if (!joints) {
      return joints.error();
    }
    const Result<const AccessorView*> weights = accessors_.view(primitive.weights[set], source.where);
    if (!weights) {
      return weights.error();
    }
    if (!isJointType(**joints) || !isWeightType(**weights)) {
      return failure(
          "{}: {}: joints must be VEC4 of unsigned bytes or shorts, and weights VEC4 of floats or unsigned "
          "bytes or shorts, but accessor {} or {} is not",
          document_.name, source.where, primitive.joints[set], primitive.weights[set]);
    }
    if ((*joints)->count() != source.positions->count() || (*weights)->count() != source.positions->count()) {
      return failure("{}: {}: {} joints and {} weights do not go with {} vertices", document_.name,
                     source.where, (*joints)->count(), (*weights)->count(), source.positions->count());
    }
    source.joints.push_back(*joints);
    source.weights.push_back(*weights);
  }
  return Success{};
}

}  // namespace sightline::io
