#include "src/io/gltf/gltf_parts.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <string_view>
#include <utility>

namespace sightline::io {
namespace {

using nlohmann::json;

// Leaves the value as it is where the key is absent.
template <typename T>
void take(const json& object, const char* key, T& value) {
  const auto found = object.find(key);
  if (found != object.end()) {
    found->get_to(value);
  }
}

void take(const json& object, const char* key, Vec3d& value) {
  const auto found = object.find(key);
  if (found != object.end()) {
    value = {(*found)[0].get<double>(), (*found)[1].get<double>(), (*found)[2].get<double>()};
  }
}

// The items of an array, one by one; none where the key is absent.
template <typename Part>
void takeAll(const json& object, const char* key, std::vector<Part>& parts, Part (*read)(const json&)) {
  const auto found = object.find(key);
  if (found != object.end()) {
    parts.reserve(found->size());
    for (const json& item : *found) {
      parts.push_back(read(item));
    }
  }
}

std::optional<bool> occluderMark(const json& object) {
  const auto extras = object.find("extras");
  return extras == object.end() ? std::nullopt : std::optional((*extras)["occluder"].get<bool>());
}

ElementType elementType(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, ElementType>, 7> kTypes{{{"SCALAR", ElementType::kScalar},
                                                                            {"VEC2", ElementType::kVec2},
                                                                            {"VEC3", ElementType::kVec3},
                                                                            {"VEC4", ElementType::kVec4},
                                                                            {"MAT2", ElementType::kMat2},
                                                                            {"MAT3", ElementType::kMat3},
                                                                            {"MAT4", ElementType::kMat4}}};
  return std::find_if(kTypes.begin(), kTypes.end(), [&](const auto& type) { return type.first == name; })
      ->second;
}

GltfFile::BufferView bufferView(const json& source) {
  GltfFile::BufferView view;
  take(source, "buffer", view.buffer);
  take(source, "byteOffset", view.byte_offset);
  take(source, "byteLength", view.byte_length);
  take(source, "byteStride", view.byte_stride);
  return view;
}

GltfFile::Sparse sparse(const json& source) {
  GltfFile::Sparse sparse;
  take(source, "count", sparse.count);
  take(source["indices"], "bufferView", sparse.indices_view);
  take(source["indices"], "byteOffset", sparse.indices_offset);
  take(source["indices"], "componentType", sparse.indices_type);
  take(source["values"], "bufferView", sparse.values_view);
  take(source["values"], "byteOffset", sparse.values_offset);
  return sparse;
}

GltfFile::Accessor accessor(const json& source) {
  GltfFile::Accessor accessor;
  take(source, "bufferView", accessor.buffer_view);
  take(source, "byteOffset", accessor.byte_offset);
  take(source, "componentType", accessor.type_of_component);
  take(source, "count", accessor.count);
  accessor.type = elementType(source["type"].get_ref<const std::string&>());
  take(source, "normalized", accessor.normalized);
  if (source.contains("sparse")) {
    accessor.sparse = sparse(source["sparse"]);
  }
  return accessor;
}

int morphTarget(const json& source) {
  int positions = -1;
  take(source, "POSITION", positions);
  return positions;
}

int mapping(const json& source) {
  return source["material"].get<int>();
}

GltfFile::Primitive primitive(const json& source) {
  GltfFile::Primitive primitive;
  const json& attributes = source["attributes"];
  take(attributes, "POSITION", primitive.positions);
  take(attributes, "JOINTS_", primitive.joints);
  take(attributes, "WEIGHTS_", primitive.weights);
  take(source, "indices", primitive.indices);
  take(source, "material", primitive.material);
  take(source, "mode", primitive.mode);
  takeAll(source, "targets", primitive.targets, morphTarget);
  if (source.contains("extensions") && source["extensions"].contains("KHR_materials_variants")) {
    takeAll(source["extensions"]["KHR_materials_variants"], "mappings", primitive.variants, mapping);
  }
  return primitive;
}

GltfFile::Mesh mesh(const json& source) {
  GltfFile::Mesh mesh;
  take(source, "name", mesh.name);
  takeAll(source, "primitives", mesh.primitives, primitive);
  take(source, "weights", mesh.weights);
  mesh.occluder = occluderMark(source);
  return mesh;
}

void takeExtensions(const json& extensions, GltfFile::Node& node) {
  if (extensions.contains("KHR_node_visibility")) {
    take(extensions["KHR_node_visibility"], "visible", node.visible);
  }
  if (extensions.contains("EXT_mesh_gpu_instancing")) {
    const json& attributes = extensions["EXT_mesh_gpu_instancing"]["attributes"];
    GltfFile::Instances instances;
    take(attributes, "TRANSLATION", instances.translations);
    take(attributes, "ROTATION", instances.rotations);
    take(attributes, "SCALE", instances.scales);
    node.instances = instances;
  }
  node.exchanged = extensions.contains("MSFT_lod") || extensions.contains("AGI_articulations") ||
                   (extensions.contains("KHR_physics_rigid_bodies") &&
                    extensions["KHR_physics_rigid_bodies"].contains("motion"));
}

GltfFile::Node node(const json& source) {
  GltfFile::Node node;
  take(source, "name", node.name);
  take(source, "camera", node.camera);
  take(source, "mesh", node.mesh);
  take(source, "skin", node.skin);
  take(source, "children", node.children);
  if (source.contains("matrix")) {
    take(source, "matrix", node.matrix.emplace());
  } else {
    take(source, "translation", node.pose.translation);
    take(source, "rotation", node.pose.rotation);
    take(source, "scale", node.pose.scale);
  }
  if (source.contains("weights")) {
    take(source, "weights", node.weights.emplace());
  }
  if (source.contains("extensions")) {
    takeExtensions(source["extensions"], node);
  }
  node.occluder = occluderMark(source);
  return node;
}

GltfFile::Skin skin(const json& source) {
  GltfFile::Skin skin;
  take(source, "joints", skin.joints);
  take(source, "inverseBindMatrices", skin.inverse_bind_matrices);
  return skin;
}

GltfFile::Scene scene(const json& source) {
  GltfFile::Scene scene;
  take(source, "nodes", scene.nodes);
  return scene;
}

// The largest factor of those that let light through. Diffuse light too: what lies behind is guessed by it.
double transmission(const json& extensions) {
  double factor = 0.0, largest = 0.0;
  if (extensions.contains("KHR_materials_transmission")) {
    take(extensions["KHR_materials_transmission"], "transmissionFactor", largest);
  }
  if (extensions.contains("KHR_materials_diffuse_transmission")) {
    take(extensions["KHR_materials_diffuse_transmission"], "diffuseTransmissionFactor", factor);
    largest = std::max(largest, factor);
  }
  if (extensions.contains("ADOBE_materials_thin_transparency")) {
    factor = 1.0;  // unless it says otherwise
    take(extensions["ADOBE_materials_thin_transparency"], "transmissionFactor", factor);
    largest = std::max(largest, factor);
  }
  return largest;
}

GltfFile::Material material(const json& source) {
  GltfFile::Material material;
  take(source, "name", material.name);
  take(source, "alphaMode", material.alpha_mode);
  take(source, "doubleSided", material.double_sided);
  if (source.contains("pbrMetallicRoughness")) {
    take(source["pbrMetallicRoughness"], "baseColorFactor", material.base_color);
  }
  if (source.contains("extensions")) {
    material.transmission = transmission(source["extensions"]);
    material.exchanged = source["extensions"].contains("MSFT_lod");
  }
  material.occluder = occluderMark(source);
  return material;
}

GltfFile::Perspective perspective(const json& source) {
  GltfFile::Perspective shape;
  take(source, "yfov", shape.yfov);
  take(source, "znear", shape.znear);
  take(source, "zfar", shape.zfar);
  take(source, "aspectRatio", shape.aspect_ratio);
  return shape;
}

GltfFile::Orthographic orthographic(const json& source) {
  GltfFile::Orthographic shape;
  take(source, "xmag", shape.xmag);
  take(source, "ymag", shape.ymag);
  take(source, "znear", shape.znear);
  take(source, "zfar", shape.zfar);
  return shape;
}

GltfFile::Camera camera(const json& source) {
  GltfFile::Camera camera;
  take(source, "name", camera.name);
  take(source, "type", camera.type);
  if (source.contains("perspective")) {
    camera.perspective = perspective(source["perspective"]);
  }
  if (source.contains("orthographic")) {
    camera.orthographic = orthographic(source["orthographic"]);
  }
  return camera;
}

GltfFile::Channel channel(const json& source) {
  GltfFile::Channel channel;
  take(source, "sampler", channel.sampler);
  const json& target = source["target"];
  take(target, "node", channel.node);
  take(target, "path", channel.path);
  if (target.contains("extensions") && target["extensions"].contains("KHR_animation_pointer")) {
    take(target["extensions"]["KHR_animation_pointer"], "pointer", channel.pointer);
  }
  return channel;
}

GltfFile::Sampler sampler(const json& source) {
  GltfFile::Sampler sampler;
  take(source, "input", sampler.input);
  take(source, "output", sampler.output);
  take(source, "interpolation", sampler.interpolation);
  return sampler;
}

GltfFile::Animation animation(const json& source) {
  GltfFile::Animation animation;
  takeAll(source, "channels", animation.channels, channel);
  takeAll(source, "samplers", animation.samplers, sampler);
  return animation;
}

}  // namespace

GltfFile partsOf(const json& document) {
  GltfFile file;
  take(document, "scene", file.scene);
  takeAll(document, "scenes", file.scenes, scene);
  takeAll(document, "nodes", file.nodes, node);
  takeAll(document, "meshes", file.meshes, mesh);
  takeAll(document, "skins", file.skins, skin);
  takeAll(document, "accessors", file.accessors, accessor);
  takeAll(document, "bufferViews", file.buffer_views, bufferView);
  takeAll(document, "materials", file.materials, material);
  takeAll(document, "cameras", file.cameras, camera);
  takeAll(document, "animations", file.animations, animation);
  return file;
}

}  // namespace sightline::io
