#include "src/io/gltf/gltf_schema.h"

namespace sightline::io {
namespace {

using enum Kind;

constexpr bool kRequired = true;
constexpr bool kOptional = false;

constexpr Field numbers(const char* key, std::size_t count) {
  return {.key = key, .kind = kNumbers, .count = count};
}
constexpr Field fewObjects(const char* key, std::span<const Field> fields, const char* element) {
  return {.key = key, .kind = kObjects, .fields = fields, .element = element, .few = true};
}

constexpr Field kAsset[] = {{"version", kText, kRequired}, {"minVersion", kText}};

constexpr Field kScene[] = {{"nodes", kIndices}, {"name", kText}};

// An object whose presence is all that counts.
constexpr std::span<const Field> kAny{};

constexpr Field kVisibility[] = {{"visible", kFlag}};
constexpr Field kPhysics[] = {{"motion", kObject, kOptional, kAny}};
constexpr Field kInstanceAttributes[] = {{"TRANSLATION", kIndex}, {"ROTATION", kIndex}, {"SCALE", kIndex}};
constexpr Field kInstancing[] = {{"attributes", kObject, kRequired, kInstanceAttributes}};
constexpr Field kNodeExtensions[] = {
    {"EXT_mesh_gpu_instancing", kObject, kOptional, kInstancing},
    {"KHR_node_visibility", kObject, kOptional, kVisibility},
    {"KHR_physics_rigid_bodies", kObject, kOptional, kPhysics},
    {"MSFT_lod", kObject, kOptional, kAny},
    {"AGI_articulations", kObject, kOptional, kAny},
};
constexpr Field kNode[] = {
    {"name", kText},        {"camera", kIndex},     {"mesh", kIndex},
    {"skin", kIndex},       numbers("weights", 0),  {"extensions", kObject, kOptional, kNodeExtensions},
    {"children", kIndices}, numbers("matrix", 16),  numbers("scale", 3),
    {"extras", kMark},      numbers("rotation", 4), numbers("translation", 3),
};

constexpr Field kSkin[] = {{"joints", kIndices, kRequired}, {"inverseBindMatrices", kIndex}};

constexpr Field kAttributes[] = {{"POSITION", kIndex}, {"JOINTS_", kSets}, {"WEIGHTS_", kSets}};
constexpr Field kMapping[] = {{"material", kIndex, kRequired}};
constexpr Field kVariants[] = {{"mappings", kObjects, kRequired, kMapping, "mapping"}};
constexpr Field kPrimitiveExtensions[] = {{"KHR_materials_variants", kObject, kOptional, kVariants}};
constexpr Field kMorphTarget[] = {{"POSITION", kIndex}};
constexpr Field kPrimitive[] = {
    {"attributes", kObject, kRequired, kAttributes},
    {"indices", kIndex},
    {"material", kIndex},
    {"mode", kIndex},
    {"targets", kObjects, kOptional, kMorphTarget, "target"},
    {"extensions", kObject, kOptional, kPrimitiveExtensions},
};
constexpr Field kMesh[] = {{"name", kText},
                           {"primitives", kObjects, kRequired, kPrimitive, "primitive"},
                           numbers("weights", 0),
                           {"extras", kMark}};

constexpr Field kBuffer[] = {{"byteLength", kSize, kRequired}, {"uri", kText}};
constexpr Field kBufferView[] = {{"buffer", kIndex, kRequired},
                                 {"byteLength", kSize, kRequired},
                                 {"byteOffset", kSize},
                                 {"byteStride", kStride}};

constexpr Field kSparseIndices[] = {
    {"bufferView", kIndex, kRequired}, {"componentType", kIndex, kRequired}, {"byteOffset", kIndex}};
constexpr Field kSparseValues[] = {{"bufferView", kIndex, kRequired}, {"byteOffset", kIndex}};
constexpr Field kSparse[] = {
    {"count", kIndex, kRequired},
    {"indices", kObject, kRequired, kSparseIndices},
    {"values", kObject, kRequired, kSparseValues},
};
constexpr Field kAccessor[] = {
    {"bufferView", kIndex},
    {"byteOffset", kSize},
    {"componentType", kIndex, kRequired},
    {"count", kSize, kRequired},
    {"type", kElementType, kRequired},
    {"normalized", kFlag},
    {"sparse", kObject, kOptional, kSparse},
};

constexpr Field kMetallicRoughness[] = {numbers("baseColorFactor", 4)};
constexpr Field kTransmission[] = {{"transmissionFactor", kNumber}};
constexpr Field kDiffuseTransmission[] = {{"diffuseTransmissionFactor", kNumber}};
constexpr Field kMaterialExtensions[] = {
    {"KHR_materials_transmission", kObject, kOptional, kTransmission},
    {"KHR_materials_diffuse_transmission", kObject, kOptional, kDiffuseTransmission},
    {"ADOBE_materials_thin_transparency", kObject, kOptional, kTransmission},
    {"MSFT_lod", kObject, kOptional, kAny},
};
constexpr Field kMaterial[] = {
    {"name", kText},
    {"alphaMode", kText},
    {"doubleSided", kFlag},
    {"pbrMetallicRoughness", kObject, kOptional, kMetallicRoughness},
    {"extensions", kObject, kOptional, kMaterialExtensions},
    {"extras", kMark},
};

constexpr Field kPerspective[] = {
    {"yfov", kNumber, kRequired}, {"znear", kNumber, kRequired}, {"zfar", kNumber}, {"aspectRatio", kNumber}};
constexpr Field kOrthographic[] = {{"xmag", kNumber, kRequired},
                                   {"ymag", kNumber, kRequired},
                                   {"znear", kNumber, kRequired},
                                   {"zfar", kNumber, kRequired}};
constexpr Field kCamera[] = {
    {"name", kText},
    {"type", kText, kRequired},
    {"perspective", kObject, kOptional, kPerspective},
    {"orthographic", kObject, kOptional, kOrthographic},
};

constexpr Field kAnimationPointer[] = {{"pointer", kText}};
constexpr Field kTargetExtensions[] = {{"KHR_animation_pointer", kObject, kOptional, kAnimationPointer}};
constexpr Field kTarget[] = {
    {"node", kIndex}, {"path", kText, kRequired}, {"extensions", kObject, kOptional, kTargetExtensions}};
constexpr Field kChannel[] = {{"sampler", kIndex, kRequired}, {"target", kObject, kRequired, kTarget}};
constexpr Field kSampler[] = {
    {"input", kIndex, kRequired}, {"output", kIndex, kRequired}, {"interpolation", kText}};
constexpr Field kAnimation[] = {
    {"name", kText},
    {"channels", kObjects, kRequired, kChannel, "channel"},
    {"samplers", kObjects, kRequired, kSampler, "sampler"},
};

constexpr Field kDocument[] = {
    {"asset", kObject, kRequired, kAsset},
    {"extensionsUsed", kTexts},
    {"extensionsRequired", kTexts},
    {"scene", kIndex},
    {"scenes", kObjects, kOptional, kScene, "scene"},
    {"nodes", kObjects, kOptional, kNode, "node"},
    {"meshes", kObjects, kOptional, kMesh, "mesh"},
    {"skins", kObjects, kOptional, kSkin, "skin"},
    {"accessors", kObjects, kOptional, kAccessor, "accessor"},
    {"bufferViews", kObjects, kOptional, kBufferView, "buffer view"},
    {"buffers", kObjects, kOptional, kBuffer, "buffer"},
    fewObjects("materials", kMaterial, "material"),
    fewObjects("cameras", kCamera, "camera"),
    fewObjects("animations", kAnimation, "animation"),
};

}  // namespace

std::span<const Field> documentSchema() {
  return kDocument;
}

}  // namespace sightline::io
