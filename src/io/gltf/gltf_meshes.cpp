#include <algorithm>
#include <map>
#include <optional>
#include <tuple>

#include "src/io/gltf/gltf_instances.h"
#include "src/io/gltf/gltf_primitives.h"
#include "src/io/gltf/gltf_skins.h"
#include "src/io/gltf/gltf_vertices.h"

namespace sightline::io {
namespace {

constexpr std::uint64_t kNumberBytes = 24;  // "/primitive" and a number, or the like, in a name

class ObjectAdder {
 public:
  ObjectAdder(const Document& document, const NodeTree& tree, Accessors& accessors, SceneBuilder& builder)
      : document_(document),
        tree_(tree),
        accessors_(accessors),
        builder_(builder),
        meshes_(document, accessors),
        skins_(document, tree, accessors) {}

  // Instances multiply: their sum is known before the first is made.
  Status checkLimits() {
    const ImportLimits& limits = document_.limits;
    Sums sums;
    for (const int node : tree_.visited) {
      const Status added = addTo(sums, static_cast<std::size_t>(node));
      if (!added) {
        return added;
      }
      if (sums.objects > limits.objects || sums.triangles > limits.triangles ||
          sums.name_bytes > limits.name_bytes) {
        return failure(
            "{}: node {}: up to here the scene has {} objects, {} triangles and {} bytes of names; at most "
            "{}, {} and {} are read",
            document_.name, node, sums.objects, sums.triangles, sums.name_bytes, limits.objects,
            limits.triangles, limits.name_bytes);
      }
      if (sums.vertices > limits.vertices || sums.implied_vertices > limits.implied_vertices) {
        return failure(
            "{}: node {}: up to here the scene has {} vertices, {} of them without a buffer view; at most {} "
            "and {} are read",
            document_.name, node, sums.vertices, sums.implied_vertices, limits.vertices,
            limits.implied_vertices);
      }
    }
    return Success{};
  }

  // One object for each primitive with triangles of the node's mesh; of each of its instances, if it has
  // some.
  Status addNode(std::size_t node_number) {
    const Result<const MeshSource*> mesh = meshOf(node_number);
    if (!mesh) {
      return mesh.error();
    }
    if (*mesh == nullptr || (*mesh)->primitives.empty()) {
      return Success{};  // however many instances of nothing there are
    }
    Result<Placement> placement = placementOf(node_number);
    if (!placement) {
      return placement.error();
    }
    const GltfFile::Node& node = document_.file.nodes[node_number];
    const std::vector<ActiveTarget> own_targets =
        node.weights ? activeTargets(*node.weights) : std::vector<ActiveTarget>();
    placement->targets = node.weights ? own_targets : (*mesh)->active_targets;
    const Result<InstanceSource> instances = openInstances(document_, node_number, accessors_);
    if (!instances) {
      return instances.error();
    }
    if (instances->listed && node.skin >= 0) {
      return failure("{}: node {}: has both instances and a skin", document_.name, node_number);
    }
    for (std::uint64_t i = 0; i < instances->count; ++i) {
      if (instances->listed) {
        placement->instance = i;
        placement->world_from_node = tree_.world_from_node[node_number] * instances->nodeFromInstance(i);
      }
      const Status status = addPrimitives(**mesh, *placement);
      if (!status) {
        return status;
      }
    }
    return Success{};
  }

  void addNotes() {
    if (moving_ > 0) {
      builder_.addNote(fmt::format(
          "objects that move, by animations, skins or morph targets: {}. They stand in their rest pose and "
          "hide nothing. Cull them as moving objects where they are; to one that stays, give \"extras\": "
          "{{\"occluder\": true}}",
          moving_));
    }
  }

 private:
  // nullptr: the node has none, or the file hides it. A hidden object would not be drawn, but whoever judges
  // exactly what is seen would let it cover others, so it is left out. If an animation shows it at times, it
  // stays, and hides nothing.
  Result<const MeshSource*> meshOf(std::size_t node_number) {
    const int mesh = document_.file.nodes[node_number].mesh;
    if (mesh < 0 || tree_.hidden[node_number]) {
      return static_cast<const MeshSource*>(nullptr);
    }
    if (!isIndexInto(mesh, document_.file.meshes.size())) {
      return failure("{}: node {}: mesh {} does not exist (the file has {})", document_.name, node_number,
                     mesh, document_.file.meshes.size());
    }
    return meshes_.open(static_cast<std::size_t>(mesh));
  }

  // What all nodes together come to. No number overflows: each is at most kMany when another is added to it.
  struct Sums {
    std::uint64_t objects = 0, triangles = 0, name_bytes = 0;
    std::uint64_t vertices = 0;  // those that morph targets or joints move count once more for each of them
    std::uint64_t implied_vertices = 0;
  };
  static constexpr std::uint64_t kMany = std::uint64_t{1} << 62;  // far beyond every limit
  static std::uint64_t product(std::uint64_t a, std::uint64_t b) {
    return b > 0 && a > kMany / b ? kMany : a * b;
  }

  Status addTo(Sums& sums, std::size_t node_number) {
    const Result<const MeshSource*> found = meshOf(node_number);
    if (!found) {
      return found.error();
    }
    if (*found == nullptr) {
      return Success{};
    }
    const Result<InstanceSource> instances = openInstances(document_, node_number, accessors_);
    if (!instances) {
      return instances.error();
    }
    const MeshSource& mesh = **found;
    const GltfFile::Node& node = document_.file.nodes[node_number];
    const std::uint64_t targets =
        node.weights ? activeTargets(*node.weights).size() : mesh.active_targets.size();
    const std::uint64_t vertices =
        std::min(product(mesh.vertices, 1 + targets), kMany / 2) + (node.skin < 0 ? 0 : mesh.joint_vertices);
    const std::uint64_t objects = product(instances->count, mesh.primitives.size());
    sums.objects += objects;
    sums.name_bytes += product(objects, node.name.size() + kNumberBytes * (instances->listed ? 2 : 1));
    sums.triangles += product(instances->count, mesh.triangles);
    sums.vertices += product(instances->count, vertices);
    sums.implied_vertices += product(instances->count, mesh.implied_vertices);
    return Success{};
  }

  Status addPrimitives(const MeshSource& mesh, Placement& placement) {
    const CornerOrder order =
        tree_.flat[placement.node] ? CornerOrder::kUnknown : cornerOrder(placement.world_from_node);
    // The node of a skinned mesh does not place it, and no renderer looks at the determinants of joints: the
    // order stays as it is, also where joints mirror. But some turn it over where the node mirrors, or seems
    // to, being flat.
    placement.order = placement.joints.empty() || order == CornerOrder::kKept ? order : CornerOrder::kUnknown;
    for (const PrimitiveSource& primitive : mesh.primitives) {
      if (!placement.joints.empty() && primitive.joints.empty()) {
        return failure("{}: node {}: has a skin, but {} has no JOINTS_0 and WEIGHTS_0", document_.name,
                       placement.node, primitive.where);
      }
      addObject(primitive, placement);
      const Status status = addTriangles(primitive, placement);
      if (!status) {
        return status;
      }
    }
    return Success{};
  }

  Result<Placement> placementOf(std::size_t node_number) {
    Placement placement{.world_from_node = tree_.world_from_node[node_number], .node = node_number};
    const int skin = document_.file.nodes[node_number].skin;
    if (skin >= 0) {
      const Result<const std::vector<Mat4>*> joints = skins_.open(skin, node_number);
      if (!joints) {
        return joints.error();
      }
      placement.joints = **joints;
    }
    return placement;
  }

  void addObject(const PrimitiveSource& primitive, const Placement& placement) {
    const std::size_t node_number = placement.node;
    const GltfFile::Node& node = document_.file.nodes[node_number];
    const GltfFile::Mesh& mesh = document_.file.meshes[static_cast<std::size_t>(node.mesh)];
    std::string name = node.name.empty() ? fmt::format("node{}", node_number) : node.name;
    if (placement.instance) {
      name += fmt::format("/instance{}", *placement.instance);
    }
    if (mesh.primitives.size() > 1) {
      name += fmt::format("/primitive{}", primitive.number);
    }
    builder_.beginObject(std::move(name), materialOf(primitive), markFor(primitive, placement));
  }

  // Its own material, or one like it that is as weak as its variants.
  MaterialId materialOf(const PrimitiveSource& primitive) {
    const MaterialId own = ownMaterialOf(primitive);
    const Material& material = builder_.material(own);
    if (material.opacity == primitive.opacity && material.double_sided == primitive.double_sided) {
      return own;
    }
    MaterialId& weakened = weakened_[{own.value, primitive.opacity, primitive.double_sided}];
    if (!weakened.valid()) {
      Material copy = material;
      copy.opacity = primitive.opacity;
      copy.double_sided = primitive.double_sided;
      weakened = builder_.addMaterial(std::move(copy));
    }
    return weakened;
  }

  MaterialId ownMaterialOf(const PrimitiveSource& primitive) {
    if (primitive.material >= 0) {
      return MaterialId(static_cast<std::uint32_t>(primitive.material));
    }
    if (!default_material_.valid()) {
      Material material;
      material.name = "default";
      default_material_ = builder_.addMaterial(material);
    }
    return default_material_;
  }

  // Node, then mesh, then material. What moves and has no mark hides nothing: where it stands in the file, it
  // stands only for a while. What is flat, and may have its front on either side, hides nothing whatever its
  // mark.
  OccluderMark markFor(const PrimitiveSource& primitive, const Placement& placement) {
    if (placement.order == CornerOrder::kUnknown) {
      return OccluderMark::kNever;
    }
    const GltfFile::Node& node = document_.file.nodes[placement.node];
    const GltfFile::Mesh& mesh = document_.file.meshes[static_cast<std::size_t>(node.mesh)];
    std::optional<bool> occluder = node.occluder ? node.occluder : mesh.occluder;
    occluder = occluder ? occluder : primitive.occluder;
    if (!occluder && moves(primitive, placement)) {
      ++moving_;
      return OccluderMark::kNever;
    }
    return !occluder ? OccluderMark::kAutomatic : *occluder ? OccluderMark::kOccluder : OccluderMark::kNever;
  }

  bool moves(const PrimitiveSource& primitive, const Placement& placement) const {
    const GltfFile::Node& node = document_.file.nodes[placement.node];
    const bool shape_moves = !placement.targets.empty() || document_.moving.node_shapes[placement.node] ||
                             document_.moving.mesh_shapes[static_cast<std::size_t>(node.mesh)];
    return tree_.moves[placement.node] || node.skin >= 0 || (shape_moves && !primitive.targets.empty());
  }

  Status addTriangles(const PrimitiveSource& source, const Placement& placement) {
    const bool mirrored = placement.order == CornerOrder::kReversed;
    ++object_;
    if (slots_.size() < source.positions->count()) {
      slots_.resize(source.positions->count());
    }
    for (std::uint64_t triangle = 0; triangle < source.triangles; ++triangle) {
      std::array<std::uint32_t, 3> vertices;
      const std::array<std::uint64_t, 3> corners = source.cornersOf(triangle);
      for (std::size_t i = 0; i < 3; ++i) {
        const Result<std::uint32_t> vertex = vertexAt(source, corners[i], placement);
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

  // The builder's vertex for a corner; each vertex of an accessor is placed once an object, and only if used.
  Result<std::uint32_t> vertexAt(const PrimitiveSource& source, std::uint64_t corner,
                                 const Placement& placement) {
    const std::uint64_t index = source.indices == nullptr ? corner : source.indices->index(corner);
    if (index >= source.positions->count()) {
      return failure("{}: {}: index {} at position {} is out of range (accessor {} has {} vertices)",
                     document_.name, source.where, index, corner, source.position_accessor,
                     source.positions->count());
    }
    Slot& slot = slots_[index];
    if (slot.object == object_) {
      return slot.vertex;
    }
    const Result<Vec3d> point_world = placeVertex(document_, source, placement, index);
    if (!point_world) {
      return point_world.error();
    }
    slot = {object_, builder_.addVertex(*point_world)};
    return slot.vertex;
  }

  struct Slot {
    std::uint32_t object = 0;  // the object for which vertex is valid, counted from 1
    std::uint32_t vertex = 0;
  };

  const Document& document_;
  const NodeTree& tree_;
  Accessors& accessors_;
  SceneBuilder& builder_;
  MeshSources meshes_;
  Skins skins_;
  std::uint64_t moving_ = 0;  // objects that hide nothing because they move
  MaterialId default_material_;
  std::map<std::tuple<std::uint32_t, Opacity, bool>, MaterialId> weakened_;
  std::vector<Slot> slots_;
  std::uint32_t object_ = 0;
};

}  // namespace

Status addObjects(const Document& document, const NodeTree& tree, Accessors& accessors,
                  SceneBuilder& builder) {
  ObjectAdder adder(document, tree, accessors, builder);
  const Status within_limits = adder.checkLimits();
  if (!within_limits) {
    return within_limits;
  }
  for (const int node : tree.visited) {
    const Status status = adder.addNode(static_cast<std::size_t>(node));
    if (!status) {
      return status;
    }
  }
  adder.addNotes();
  return Success{};
}

}  // namespace sightline::io
