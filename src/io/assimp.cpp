// PLY, STL, FBX, COLLADA and the rest. Assimp parses; what it hands over is checked here like a glTF's.

#include "src/io/assimp.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/config.h>
#include <algorithm>
#include <assimp/Importer.hpp>
#include <cctype>
#include <cmath>
#include <exception>
#include <new>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sightline/math/mat4.h"
#include "src/base/byte_stream.h"
#include "src/io/child_process.h"
#include "src/io/corner_order.h"
#include "src/io/failure.h"
#include "src/io/polygon_triangles.h"
#include "src/io/scene_bytes.h"

namespace sightline::io {
namespace {

// What the process that reads a file may take: 1 GiB and 100 bytes for each of the file's; a minute, and a
// second for each 100,000 bytes.
constexpr std::uint64_t kReaderBytes = 1024 * 1024 * 1024, kReaderBytesEach = 100;
constexpr std::uint64_t kReaderSeconds = 60, kReaderBytesInSecond = 100'000;
constexpr unsigned char kSceneFollows = 1, kErrorFollows = 2;  // what an answer of that process begins with

// Not aiProcess_Triangulate: where a corner lies on a diagonal, its triangles cover what the polygon does
// not. Not aiProcess_SortByPType either, which divides meshes of triangles and other polygons.
constexpr unsigned kSteps = aiProcess_RemoveComponent | aiProcess_JoinIdenticalVertices;
constexpr int kUnusedComponents = aiComponent_NORMALS | aiComponent_TANGENTS_AND_BITANGENTS |
                                  aiComponent_TEXCOORDS | aiComponent_TEXTURES | aiComponent_LIGHTS |
                                  aiComponent_CAMERAS;

// A .ply has no materials: only the colours of its vertices say that it is glass. Those of other files hold
// masks and the like as well, and are not looked at.
bool coloursCount(const std::string& file) {
  const std::size_t begin = file.size() - std::min<std::size_t>(file.size(), 4);
  return std::ranges::equal(file.substr(begin), std::string_view(".ply"), {},
                            [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
}

bool hasSeeThroughVertices(const aiMesh& mesh) {
  const aiColor4D* const colours = mesh.mColors[0];
  return colours != nullptr &&
         std::any_of(colours, colours + mesh.mNumVertices, [](const aiColor4D& c) { return !(c.a >= 1.0f); });
}

Mat4 matrixFrom(const aiMatrix4x4& source) {
  Mat4 matrix;
  for (unsigned row = 0; row < 4; ++row) {
    for (unsigned column = 0; column < 4; ++column) {
      matrix(static_cast<int>(row), static_cast<int>(column)) = static_cast<double>(source[row][column]);
    }
  }
  return matrix;
}

Material materialFrom(const aiMaterial& source, unsigned number) {
  Material material;
  aiString name;
  source.Get(AI_MATKEY_NAME, name);
  material.name = name.length > 0 ? name.C_Str() : fmt::format("material{}", number);
  float opacity = 1.0f;
  source.Get(AI_MATKEY_OPACITY, opacity);
  float transparency = 0.0f;
  source.Get(AI_MATKEY_TRANSMISSION_FACTOR, transparency);
  const bool opaque = opacity >= 1.0f && !(transparency > 0.0f);
  int two_sided = 0;
  source.Get(AI_MATKEY_TWOSIDED, two_sided);
  material.double_sided = two_sided != 0;
  aiColor3D color(0.8f, 0.8f, 0.8f);
  source.Get(AI_MATKEY_COLOR_DIFFUSE, color);
  const bool has_opacity_map = source.GetTextureCount(aiTextureType_OPACITY) > 0;
  material.opacity = !opaque ? Opacity::kBlended : has_opacity_map ? Opacity::kAlphaTested : Opacity::kOpaque;
  const auto channel = [](float c) { return c >= 0.0f ? std::min(c, 1.0f) : 0.0f; };
  material.base_color = {channel(color.r), channel(color.g), channel(color.b), channel(opacity)};
  return material;
}

bool isPolygon(const aiFace& face) {
  return face.mNumIndices >= 3;
}

std::span<const aiFace> facesOf(const aiMesh& mesh) {
  return {mesh.mFaces, mesh.mNumFaces};
}

std::uint64_t trianglesOf(const aiMesh& mesh) {
  std::uint64_t triangles = 0;
  for (const aiFace& face : facesOf(mesh)) {
    triangles += isPolygon(face) ? face.mNumIndices - 2 : 0;
  }
  return triangles;
}

class AssimpConverter {
 public:
  AssimpConverter(const aiScene& source, const std::string& name, const ImportLimits& limits,
                  AssimpFindings& findings)
      : source_(source), name_(name), limits_(limits), findings_(findings), builder_(limits) {}

  Result<Scene> convert() {
    std::vector<bool> see_through(source_.mNumMaterials, false);
    for (const aiMesh* mesh : std::span(source_.mMeshes, source_.mNumMeshes)) {
      if (mesh->mMaterialIndex < see_through.size() && hasSeeThroughVertices(*mesh)) {
        see_through[mesh->mMaterialIndex] = true;
      }
    }
    for (unsigned i = 0; i < source_.mNumMaterials; ++i) {
      Material material = materialFrom(*source_.mMaterials[i], i);
      material.opacity = see_through[i] ? Opacity::kBlended : material.opacity;
      builder_.addMaterial(std::move(material));
    }
    // Depth first; Assimp's nodes form a tree, each owning its children.
    const std::set<std::string, std::less<>> animated = animatedNodes();
    std::vector<Place> open{{source_.mRootNode}};
    while (!open.empty()) {
      Place at = open.back();
      open.pop_back();
      constexpr double kRounding = 1e-6;  // of matrices that Assimp multiplies in single precision
      at.to_world = at.to_world * matrixFrom(at.node->mTransformation);
      at.moves = at.moves || animated.contains(std::string_view(at.node->mName.C_Str()));
      at.flat = at.flat || cornerOrder(at.to_world, kRounding) == CornerOrder::kUnknown;
      if (const Status status = addMeshes(at); !status) {
        return status.error();
      }
      for (unsigned i = at.node->mNumChildren; i-- > 0;) {
        open.push_back(at);
        open.back().node = at.node->mChildren[i];
      }
    }
    return builder_.finish();
  }

 private:
  // A node, and what holds for it and all below it.
  struct Place {
    const aiNode* node = nullptr;
    Mat4 to_world{};     // from its parent, as long as it is to be visited
    bool moves = false;  // by an animation
    bool flat = false;   // CornerOrder::kUnknown
  };

  std::set<std::string, std::less<>> animatedNodes() const {
    std::set<std::string, std::less<>> names;
    for (const aiAnimation* animation : std::span(source_.mAnimations, source_.mNumAnimations)) {
      for (const aiNodeAnim* channel : std::span(animation->mChannels, animation->mNumChannels)) {
        names.emplace(channel->mNodeName.C_Str());
      }
    }
    return names;
  }

  // One object for each mesh that has triangles.
  Status addMeshes(const Place& place) {
    const aiNode& node = *place.node;
    std::vector<unsigned> numbers;
    for (const unsigned number : std::span(node.mMeshes, node.mNumMeshes)) {
      if (number >= source_.mNumMeshes) {
        return failure("{}: node \"{}\": mesh {} does not exist (the file has {})", name_, node.mName.C_Str(),
                       number, source_.mNumMeshes);
      }
      const std::span<const aiFace> faces = facesOf(*source_.mMeshes[number]);
      if (std::any_of(faces.begin(), faces.end(), isPolygon)) {
        numbers.push_back(number);
      }
    }
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      const aiMesh& mesh = *source_.mMeshes[numbers[i]];
      std::string object_name = node.mName.length > 0 ? node.mName.C_Str() : mesh.mName.C_Str();
      if (numbers.size() > 1) {
        object_name += fmt::format("/primitive{}", i);
      }
      const Status status = addMesh(std::move(object_name), numbers[i], place);
      if (!status) {
        return status;
      }
    }
    return Success{};
  }

  Status addMesh(std::string object_name, unsigned number, const Place& place) {
    const aiMesh& mesh = *source_.mMeshes[number];
    if (mesh.mMaterialIndex >= source_.mNumMaterials) {
      return failure("{}: mesh {}: material {} does not exist (the file has {})", name_, number,
                     mesh.mMaterialIndex, source_.mNumMaterials);
    }
    if (++objects_ > limits_.objects) {
      return failure("{}: object \"{}\": the scene exceeds {} objects", name_, object_name, limits_.objects);
    }
    if (const std::uint64_t triangles = trianglesOf(mesh); !builder_.fits(triangles)) {
      return failure("{}: mesh {}: with its {} triangles the scene exceeds {} triangles", name_, number,
                     triangles, limits_.triangles);
    }
    // It stands in its rest pose, and only for a while.
    const bool moves = place.moves || mesh.mNumBones > 0 || mesh.mNumAnimMeshes > 0;
    findings_.moving_objects += moves ? 1 : 0;
    builder_.beginObject(std::move(object_name), MaterialId(mesh.mMaterialIndex),
                         moves || place.flat ? OccluderMark::kNever : OccluderMark::kAutomatic);
    vertex_of_.assign(mesh.mNumVertices, kNone);
    const bool mirrored = determinant3(place.to_world) < 0.0;
    for (unsigned face = 0; face < mesh.mNumFaces; ++face) {
      if (isPolygon(mesh.mFaces[face])) {
        const Status status = addFace(mesh, number, face, place.to_world, mirrored);
        if (!status) {
          return status;
        }
      }
    }
    return Success{};
  }

  // Cuts the face as it is in the file: there, corners of one plane are still in one.
  Status addFace(const aiMesh& mesh, unsigned number, unsigned face, const Mat4& world_from_node,
                 bool mirrored) {
    corners_.clear();
    vertices_.clear();
    for (const unsigned index : std::span(mesh.mFaces[face].mIndices, mesh.mFaces[face].mNumIndices)) {
      if (index >= mesh.mNumVertices) {
        return failure("{}: mesh {}: index {} of face {} is out of range ({} vertices)", name_, number, index,
                       face, mesh.mNumVertices);
      }
      const aiVector3D& p = mesh.mVertices[index];
      corners_.push_back({static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)});
      if (vertex_of_[index] == kNone) {
        const Vec3d point_world = transformPoint(world_from_node, corners_.back());
        if (!isFinite(corners_.back()) || !SceneBuilder::inRange(point_world)) {
          return failure("{}: mesh {}: vertex {} is not finite or exceeds single precision", name_, number,
                         index);
        }
        vertex_of_[index] = builder_.addVertex(point_world);
      }
      vertices_.push_back(vertex_of_[index]);
    }
    const PolygonTriangles cut = triangulator_.triangulate(corners_);
    findings_.uncertain_polygons += cut.exact ? 0 : 1;
    for (const auto& [a, b, c] : cut.triangles) {
      builder_.addTriangle(vertices_[a], vertices_[mirrored ? c : b], vertices_[mirrored ? b : c], cut.exact);
    }
    return Success{};
  }

  static constexpr std::uint32_t kNone = 0xffffffffu;

  const aiScene& source_;
  const std::string& name_;
  const ImportLimits& limits_;
  AssimpFindings& findings_;
  SceneBuilder builder_;
  PolygonTriangulator triangulator_;
  std::uint64_t objects_ = 0;
  std::vector<std::uint32_t> vertex_of_;  // the builder's, for those of the mesh; kNone: not yet added
  std::vector<Vec3d> corners_;            // of a face
  std::vector<std::uint32_t> vertices_;   // of it, the builder's
};

}  // namespace

bool isAssimpExtension(const std::string& extension) {
  return Assimp::Importer().IsExtensionSupported(extension);
}

Result<Scene> importAssimp(const std::string& file, const ImportLimits& limits, AssimpFindings& findings) {
  // Assimp throws when memory runs out; nothing leaves here.
  try {
    Assimp::Importer importer;
    importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS,
                                kUnusedComponents | (coloursCount(file) ? 0 : int{aiComponent_COLORS}));
    const aiScene* const source = importer.ReadFile(file, kSteps);
    if (source == nullptr || source->mRootNode == nullptr ||
        (source->mFlags & AI_SCENE_FLAGS_INCOMPLETE) != 0) {
      // Assimp catches this one too.
      if (const std::exception_ptr& thrown = importer.GetException()) {
        std::rethrow_exception(thrown);
      }
      const std::string reason = importer.GetErrorString();
      return failure("{}: could not be read: {}", file,
                     reason.empty() ? "it holds no complete scene" : reason);
    }
    return AssimpConverter(*source, file, limits, findings).convert();
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& exception) {
    return failure("{}: could not be read: {}", file, exception.what());
  }
}

Result<Scene> importAssimpInChild(const std::string& file, std::uint64_t file_bytes,
                                  const ImportLimits& limits, AssimpFindings& findings,
                                  std::uint32_t most_seconds) {
  const std::uint64_t seconds = kReaderSeconds + file_bytes / kReaderBytesInSecond;
  const ChildLimits own{
      .memory_bytes = kReaderBytes + kReaderBytesEach * file_bytes,
      .seconds = static_cast<std::uint32_t>(std::min<std::uint64_t>(seconds, most_seconds))};
  // The first byte tells a scene from an error's text. Before the scene stand the findings.
  const Result<std::vector<std::byte>> answer = runInChild(own, [&] {
    AssimpFindings found;
    const Result<Scene> scene = importAssimp(file, limits, found);
    base::ByteWriter writer;
    writer.add(scene ? kSceneFollows : kErrorFollows);
    if (scene) {
      writer.add(found.uncertain_polygons);
      writer.add(found.moving_objects);
      writer.addBytes(sceneBytes(*scene));
    } else {
      writer.addBytes(std::as_bytes(std::span(scene.error().message)));
    }
    return writer.take();
  });
  if (!answer || answer->empty()) {
    return failure("{}: could not be read: {}", file,
                   answer ? "its reader gave no answer" : answer.error().message);
  }
  base::ByteReader reader(*answer);
  if (reader.read<unsigned char>() == kErrorFollows) {
    const std::span<const std::byte> text = reader.readBytes(reader.remaining());
    return failure("{}", std::string_view(reinterpret_cast<const char*>(text.data()), text.size()));
  }
  findings.uncertain_polygons = reader.read<std::uint64_t>();
  findings.moving_objects = reader.read<std::uint64_t>();
  std::optional<Scene> scene = sceneFromBytes(reader.readBytes(reader.remaining()));
  return scene ? Result<Scene>(std::move(*scene))
               : failure("{}: could not be read: its reader gave a broken answer", file);
}

}  // namespace sightline::io
