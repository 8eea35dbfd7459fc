#pragma once

// The parts of a glTF file that Sightline reads, as plain data. Their names are those of the glTF 2.0
// specification. An index of -1 means that the file names none; whether the others exist is not yet checked.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sightline/math/vec3.h"

namespace sightline::io {

// Numbers in files; other numbers may stand there too.
struct ComponentType {
  static constexpr int kByte = 5120, kUnsignedByte = 5121, kShort = 5122, kUnsignedShort = 5123,
                       kUnsignedInt = 5125, kFloat = 5126, kDouble = 5130;
};
struct PrimitiveMode {
  static constexpr int kTriangles = 4, kTriangleStrip = 5, kTriangleFan = 6;
};

enum class ElementType : std::uint8_t { kScalar, kVec2, kVec3, kVec4, kMat2, kMat3, kMat4 };

// Translation, rotation (x, y, z, w), scale.
struct NodePose {
  Vec3d translation;
  std::array<double, 4> rotation{0, 0, 0, 1};
  Vec3d scale{1, 1, 1};
};

struct GltfFile {
  struct BufferView {
    int buffer = -1;
    std::uint64_t byte_offset = 0, byte_length = 0;
    std::uint64_t byte_stride = 0;  // 0: elements follow each other closely
  };

  struct Sparse {
    std::uint64_t count = 0;
    int indices_view = -1;
    std::uint64_t indices_offset = 0;
    int indices_type = 0;  // ComponentType
    int values_view = -1;
    std::uint64_t values_offset = 0;
  };
  struct Accessor {
    int buffer_view = -1;  // -1: all elements are zero
    std::uint64_t byte_offset = 0;
    int type_of_component = 0;  // ComponentType
    std::uint64_t count = 0;
    ElementType type = ElementType::kScalar;
    bool normalized = false;
    std::optional<Sparse> sparse;
  };

  struct Primitive {
    int positions = -1;                // accessor of the attribute POSITION
    std::vector<int> joints, weights;  // accessors of the attributes JOINTS_n and WEIGHTS_n, by n
    int indices = -1;
    int material = -1;
    std::vector<int> targets;  // accessors of how the morph targets displace POSITION; -1: not at all
    int mode = PrimitiveMode::kTriangles;
    std::vector<int> variants;  // materials that KHR_materials_variants may put in the place of its own
  };
  struct Mesh {
    std::string name;
    std::vector<Primitive> primitives;
    std::vector<double> weights;   // of the morph targets
    std::optional<bool> occluder;  // extras
  };

  // EXT_mesh_gpu_instancing
  struct Instances {
    int translations = -1, rotations = -1, scales = -1;  // accessors
  };

  struct Node {
    std::string name;
    int camera = -1;
    int mesh = -1;
    int skin = -1;
    std::vector<int> children;
    std::optional<std::array<double, 16>> matrix;
    NodePose pose;                               // of a node without a matrix
    std::optional<std::vector<double>> weights;  // instead of the mesh's
    std::optional<Instances> instances;
    bool visible = true;     // KHR_node_visibility
    bool exchanged = false;  // an extension lets it move, or shows others in its place at times
    std::optional<bool> occluder;
  };
  struct Scene {
    std::vector<int> nodes;
  };

  struct Skin {
    std::vector<int> joints;         // nodes
    int inverse_bind_matrices = -1;  // accessor; -1: all are the identity
  };

  struct Material {
    std::string name;
    std::string alpha_mode = "OPAQUE";
    bool double_sided = false;
    std::array<double, 4> base_color{1, 1, 1, 1};
    double transmission = 0.0;  // the largest of all extensions that let light through
    bool exchanged = false;     // for another one at times
    std::optional<bool> occluder;
  };

  struct Perspective {
    double yfov = 0.0;  // radians
    double znear = 0.0;
    double zfar = 0.0;          // 0: none
    double aspect_ratio = 0.0;  // 0: not given
  };
  struct Orthographic {
    double xmag = 0.0, ymag = 0.0, znear = 0.0, zfar = 0.0;
  };
  struct Camera {
    std::string name;
    std::string type;
    std::optional<Perspective> perspective;
    std::optional<Orthographic> orthographic;
  };

  struct Channel {
    int sampler = -1;
    int node = -1;  // -1: what the pointer names, or something of an extension
    std::string path;
    std::string pointer;  // KHR_animation_pointer
  };
  struct Sampler {
    int input = -1, output = -1;
    std::string interpolation = "LINEAR";
  };
  struct Animation {
    std::vector<Channel> channels;
    std::vector<Sampler> samplers;
  };

  int scene = -1;
  std::vector<Scene> scenes;
  std::vector<Node> nodes;
  std::vector<Mesh> meshes;
  std::vector<Skin> skins;
  std::vector<Accessor> accessors;
  std::vector<BufferView> buffer_views;
  std::vector<Material> materials;
  std::vector<Camera> cameras;
  std::vector<Animation> animations;
};

}  // namespace sightline::io
