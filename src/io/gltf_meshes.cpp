#include <optional>

#include "gltf_model.h"

namespace sightline::gltf {
namespace {

std::optional<OccluderMark> markOf(const tinygltf::Value& extras) {
  if (!extras.Has("occluder")) {
    return std::nullopt;
  }
  return extras.Get("occluder").Get<bool>() ? OccluderMark::kOccluder : OccluderMark::kNever;
}

// Which corner of a primitive's vertex sequence is corner 0, 1, 2 of a triangle.
std::array<std::uint64_t, 3> cornersOf(int mode, std::uint64_t triangle) {
  switch (mode) {
    case TINYGLTF_MODE_TRIANGLE_STRIP:
      return {triangle, triangle + 1 + triangle % 2, triangle + 2 - triangle % 2};
    case TINYGLTF_MODE_TRIANGLE_FAN:
      return {triangle + 1, triangle + 2, 0};
    default:
      return {3 * triangle, 3 * triangle + 1, 3 * triangle + 2};
  }
}

class ObjectAdder {
 public:
  ObjectAdder(const Document& document, const NodeTree& tree, SceneBuilder& builder)
      : document_(document), tree_(tree), builder_(builder) {}

  // One object for each primitive with triangles of the node's mesh.
  Status addNode(std::size_t node_number) {
    const tinygltf::Model& model = document_.model;
    const tinygltf::Node& node = model.nodes[node_number];
    if (node.mesh < 0) {
      return Success{};
    }
    if (!isIndexInto(node.mesh, model.meshes.size())) {
      return failure("{}: node {}: mesh {} does not exist (the file has {})", document_.name, node_number,
                     node.mesh, model.meshes.size());
    }
    const std::size_t count = model.meshes[static_cast<std::size_t>(node.mesh)].primitives.size();
    for (std::size_t primitive = 0; primitive < count; ++primitive) {
      const Status status = addPrimitive(node_number, primitive);
      if (!status) {
        return status;
      }
    }
    return Success{};
  }

 private:
  struct Source {
    std::string where;  // "mesh 3 primitive 0"
    int mode = TINYGLTF_MODE_TRIANGLES;
    int position_accessor = -1;
    AccessorView positions;
    std::optional<AccessorView> indices;
    std::uint64_t corners = 0;
    std::uint64_t triangles = 0;
  };

  Status addPrimitive(std::size_t node_number, std::size_t number) {
    const tinygltf::Node& node = document_.model.nodes[node_number];
    const tinygltf::Mesh& mesh = document_.model.meshes[static_cast<std::size_t>(node.mesh)];
    const tinygltf::Primitive& primitive = mesh.primitives[number];
    Source source;
    source.where = fmt::format("mesh {} primitive {}", node.mesh, number);
    source.mode = primitive.mode;
    if (source.mode > TINYGLTF_MODE_TRIANGLE_FAN) {
      return failure("{}: {}: mode {} does not exist", document_.name, source.where, source.mode);
    }
    if (source.mode < TINYGLTF_MODE_TRIANGLES) {
      return Success{};  // points and lines
    }
    const Status opened = open(primitive, source);
    if (!opened || source.triangles == 0) {
      return opened;
    }
    const Result<MaterialId> material = materialOf(primitive, source);
    if (!material) {
      return material.error();
    }
    std::string name = node.name.empty() ? fmt::format("node{}", node_number) : node.name;
    if (mesh.primitives.size() > 1) {
      name += fmt::format("/primitive{}", number);
    }
    builder_.beginObject(std::move(name), *material, markFor(node, mesh, primitive));
    return addTriangles(source, node_number);
  }

  // Finds and checks the accessors of a primitive of triangles.
  Status open(const tinygltf::Primitive& primitive, Source& source) const {
    const auto attribute = primitive.attributes.find("POSITION");
    if (attribute == primitive.attributes.end()) {
      return failure("{}: {}: has no POSITION attribute", document_.name, source.where);
    }
    source.position_accessor = attribute->second;
    Result<AccessorView> positions = viewAccessor(document_, attribute->second, source.where);
    if (!positions) {
      return positions.error();
    }
    if (positions->type() != TINYGLTF_TYPE_VEC3 ||
        positions->componentType() == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT) {
      return failure("{}: {}: positions must be VEC3 of floats, bytes or shorts, but accessor {} is not",
                     document_.name, source.where, source.position_accessor);
    }
    source.positions = std::move(*positions);
    source.corners = source.positions.count();
    if (primitive.indices >= 0) {
      Result<AccessorView> indices = viewAccessor(document_, primitive.indices, source.where);
      if (!indices) {
        return indices.error();
      }
      const int type = indices->componentType();
      if (indices->type() != TINYGLTF_TYPE_SCALAR ||
          (type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE && type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
           type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT)) {
        return failure("{}: {}: indices must be SCALAR of unsigned integers, but accessor {} is not",
                       document_.name, source.where, primitive.indices);
      }
      source.indices = std::move(*indices);
      source.corners = source.indices->count();
    }
    return countTriangles(source);
  }

  Status countTriangles(Source& source) const {
    if (source.mode == TINYGLTF_MODE_TRIANGLES && source.corners % 3 != 0) {
      return failure("{}: {}: {} corners do not make whole triangles", document_.name, source.where,
                     source.corners);
    }
    source.triangles = source.mode == TINYGLTF_MODE_TRIANGLES ? source.corners / 3
                       : source.corners < 3                   ? 0
                                                              : source.corners - 2;
    if (!builder_.fits(source.triangles)) {
      return failure("{}: {}: with its {} triangles the scene exceeds {} triangles", document_.name,
                     source.where, source.triangles, document_.limits.triangles);
    }
    return Success{};
  }

  Result<MaterialId> materialOf(const tinygltf::Primitive& primitive, const Source& source) {
    const std::size_t count = document_.model.materials.size();
    if (primitive.material >= 0) {
      if (!isIndexInto(primitive.material, count)) {
        return failure("{}: {}: material {} does not exist (the file has {})", document_.name, source.where,
                       primitive.material, count);
      }
      return MaterialId(static_cast<std::uint32_t>(primitive.material));
    }
    if (!default_material_.valid()) {
      Material material;
      material.name = "default";
      default_material_ = builder_.addMaterial(material);
    }
    return default_material_;
  }

  OccluderMark markFor(const tinygltf::Node& node, const tinygltf::Mesh& mesh,
                       const tinygltf::Primitive& primitive) const {
    if (const auto mark = markOf(node.extras)) {
      return *mark;
    }
    if (const auto mark = markOf(mesh.extras)) {
      return *mark;
    }
    const auto material = static_cast<std::size_t>(primitive.material);
    const bool has_material = primitive.material >= 0;
    return has_material
               ? markOf(document_.model.materials[material].extras).value_or(OccluderMark::kAutomatic)
               : OccluderMark::kAutomatic;
  }

  Status addTriangles(const Source& source, std::size_t node_number) {
    const Mat4& world_from_node = tree_.world_from_node[node_number];
    const bool mirrored = determinant3(world_from_node) < 0.0;
    ++object_;
    if (slots_.size() < source.positions.count()) {
      slots_.resize(source.positions.count());
    }
    for (std::uint64_t triangle = 0; triangle < source.triangles; ++triangle) {
      std::array<std::uint32_t, 3> vertices;
      const std::array<std::uint64_t, 3> corners = cornersOf(source.mode, triangle);
      for (std::size_t i = 0; i < 3; ++i) {
        const Result<std::uint32_t> vertex = vertexAt(source, corners[i], world_from_node, node_number);
        if (!vertex) {
          return vertex.error();
        }
        vertices[i] = *vertex;
      }
      if (mirrored) {
        std::swap(vertices[1], vertices[2]);
      }
      builder_.addTriangle(vertices[0], vertices[1], vertices[2]);
    }
    return Success{};
  }

  // The builder's vertex for a corner; each vertex of an accessor is transformed once an object, and only if
  // used.
  Result<std::uint32_t> vertexAt(const Source& source, std::uint64_t corner, const Mat4& world_from_node,
                                 std::size_t node_number) {
    const std::uint64_t index = source.indices ? source.indices->index(corner) : corner;
    if (index >= source.positions.count()) {
      return failure("{}: {}: index {} at position {} is out of range (accessor {} has {} vertices)",
                     document_.name, source.where, index, corner, source.position_accessor,
                     source.positions.count());
    }
    Slot& slot = slots_[index];
    if (slot.object == object_) {
      return slot.vertex;
    }
    const Vec3d point(source.positions.number(index, 0), source.positions.number(index, 1),
                      source.positions.number(index, 2));
    if (!isFinite(point)) {
      return failure("{}: {}: vertex {} of accessor {} is not finite", document_.name, source.where, index,
                     source.position_accessor);
    }
    const Vec3d point_world = transformPoint(world_from_node, point);
    if (!SceneBuilder::inRange(point_world)) {
      return failure("{}: node {}: {}: the world position of vertex {} exceeds single precision",
                     document_.name, node_number, source.where, index);
    }
    slot = {object_, builder_.addVertex(point_world)};
    return slot.vertex;
  }

  struct Slot {
    std::uint32_t object = 0;  // the object for which vertex is valid, counted from 1
    std::uint32_t vertex = 0;
  };

  const Document& document_;
  const NodeTree& tree_;
  SceneBuilder& builder_;
  MaterialId default_material_;
  std::vector<Slot> slots_;
  std::uint32_t object_ = 0;
};

}  // namespace

Status addObjects(const Document& document, const NodeTree& tree, SceneBuilder& builder) {
  ObjectAdder adder(document, tree, builder);
  for (const int node : tree.visited) {
    const Status status = adder.addNode(static_cast<std::size_t>(node));
    if (!status) {
      return status;
    }
  }
  return Success{};
}

}  // namespace sightline::gltf
