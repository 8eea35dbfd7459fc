#include "sightline/world/world.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "sightline/scene/scene.h"
#include "src/world/world_data.h"

namespace sightline {

using namespace world;

namespace world {
namespace {

constexpr std::uint32_t kNone = InstanceData::kNone;
constexpr std::uint32_t kSettleAfter = 60;  // frames without movement

bool isAffine(const Mat4& m) {
  bool finite = true;
  for (const double element : m.m) {
    finite = finite && std::isfinite(element);
  }
  return finite && m(3, 0) == 0.0 && m(3, 1) == 0.0 && m(3, 2) == 0.0 && m(3, 3) == 1.0;
}

// Takes a number out of use, and back into it.
template <typename List>
std::uint32_t numberIn(List& list, std::vector<std::uint32_t>& free) {
  if (free.empty()) {
    list.emplace_back();
    return static_cast<std::uint32_t>(list.size() - 1);
  }
  const std::uint32_t number = free.back();
  free.pop_back();
  return number;
}

// The clusters of a part count for nothing from now on, also where they adjoin other parts: their plane has
// no side on which an eye could be.
void removePart(SurfaceSet& set, std::uint32_t part) {
  for (const SurfacePatch& patch : set.patchesOf(set.parts[part])) {
    for (std::uint32_t i = 0; i < patch.cluster_count; ++i) {
      SurfaceCluster& cluster = set.clusters[patch.first_cluster + i];
      cluster.support = {{0.0, 0.0, 0.0}, -1.0};
      cluster.double_sided = false;
    }
  }
  set.parts[part].patch_count = 0;
}

}  // namespace

Box boundsOf(const Box& mesh_bounds, const Mat4& m, double displacement) {
  Box box;
  if (!mesh_bounds.wellFormed() || !isAffine(m) || !(displacement >= 0.0)) {
    return box;
  }
  const Vec3d middle = center(mesh_bounds), half = (Vec3d(mesh_bounds.max) - Vec3d(mesh_bounds.min)) * 0.5;
  const Vec3d at = transformPoint(m, middle);
  // Single precision, in which renderers transform vertices, is off by less than this part of all terms.
  constexpr double kRounding = 0x1p-21;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3d row{std::abs(m(axis, 0)), std::abs(m(axis, 1)), std::abs(m(axis, 2))};
    const double terms = dot(row, abs(middle) + half) + std::abs(m(axis, 3));
    const double reach = dot(row, half) + displacement + kRounding * terms;
    constexpr float kFar = std::numeric_limits<float>::infinity();
    box.min[axis] = std::nextafterf(static_cast<float>(at[axis] - reach), -kFar);
    box.max[axis] = std::nextafterf(static_cast<float>(at[axis] + reach), kFar);
  }
  return box;
}

// Puts an instance that is shown where those are found who cull.
void WorldData::place(std::uint32_t id) {
  InstanceData& own = instances[id];
  const Box box = own.mesh < meshes.size()
                      ? boundsOf(meshes[own.mesh].mesh.bounds, world_from_mesh[id], own.displacement)
                      : Box{};
  if (!box.wellFormed()) {
    unplace(id);
    own.where = Whereabouts::kUnbounded;
    unbounded.emplace_back(id);
  } else if (own.where == Whereabouts::kMoving) {
    moving.move({id, box});
  } else {
    unplace(id);
    own.where = Whereabouts::kSettled;
    settled.insert({id, box});
  }
}

void WorldData::unplace(std::uint32_t id) {
  InstanceData& own = instances[id];
  if (own.where == Whereabouts::kSettled) {
    settled.remove(id);
  } else if (own.where == Whereabouts::kMoving) {
    moving.remove(id);
  } else if (own.where == Whereabouts::kUnbounded) {
    std::erase(unbounded, InstanceId(id));
  }
  own.where = Whereabouts::kNowhere;
}

// What moves is in a tree of its own, which is small, so that keeping it good costs little.
void WorldData::moved(std::uint32_t id) {
  InstanceData& own = instances[id];
  own.last_moved = frame;
  if (!own.shown) {
    return;
  }
  if (own.where == Whereabouts::kSettled) {
    const Box box = settled.boxOf(id);
    settled.remove(id);
    moving.insert({id, box});
    own.where = Whereabouts::kMoving;
    if (!own.listed) {
      own.listed = true;
      movers.emplace_back(id);
    }
  }
  place(id);
}

// What was found together with the triangles of this object hides no longer, and the others that have some of
// it do so by their own meshes.
void WorldData::leave(Joined& joined, std::uint32_t object) {
  for (const std::uint32_t part : joined.join.surfaces.partsOf(ObjectId(object))) {
    for (const std::uint32_t other : joined.objects_of_part[part]) {
      const InstanceId id = joined.join.instances[other];
      if (id.valid()) {
        instances[id.value].alone = true;
      }
    }
    removePart(joined.join.surfaces, part);
  }
  joined.join.instances[object] = InstanceId();
}

void WorldData::leaveJoin(std::uint32_t id) {
  InstanceData& own = instances[id];
  if (own.join != kNone) {
    leave(joins[own.join], own.object);
    own.join = kNone;
    own.alone = true;
  }
}

std::uint32_t WorldData::addInstance(const Instance& given) {
  const std::uint32_t id = numberIn(instances, free_instances);
  world_from_mesh.resize(instances.size());
  InstanceData& own = instances[id];
  own = {.there = true, .shown = given.shown, .occludes = given.occludes, .listed = own.listed};
  own.displacement = static_cast<float>(given.displacement);
  if (!(double{own.displacement} >= given.displacement)) {
    own.displacement = std::nextafterf(own.displacement, std::numeric_limits<float>::infinity());
  }
  own.version = own.born = ++version;
  world_from_mesh[id] = given.world_from_mesh;
  if (given.mesh.value < meshes.size() && meshes[given.mesh.value].there) {
    own.mesh = given.mesh.value;
    own.in_mesh = static_cast<std::uint32_t>(meshes[own.mesh].instances.size());
    meshes[own.mesh].instances.emplace_back(id);
  }
  ++count;
  return id;
}

// Looks at some of those that moved, and puts those that have not done so for a while among the settled ones.
void WorldData::settle(std::uint32_t looks) {
  for (std::uint32_t i = 0; i < looks && !movers.empty(); ++i) {
    next_mover = next_mover < movers.size() ? next_mover : 0;
    const std::uint32_t id = movers[next_mover].value;
    InstanceData& own = instances[id];
    const bool moves = own.where == Whereabouts::kMoving;
    if (moves && frame - own.last_moved < kSettleAfter) {
      ++next_mover;
      continue;
    }
    own.listed = false;
    movers[next_mover] = movers.back();
    movers.pop_back();
    if (moves) {
      const Box box = moving.boxOf(id);
      moving.remove(id);
      settled.insert({id, box});
      own.where = Whereabouts::kSettled;
    }
  }
}

}  // namespace world

World::World() : data_(std::make_unique<WorldData>()) {}
World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

MeshId World::addMesh(WorldMesh mesh) {
  const std::uint32_t number = numberIn(data_->meshes, data_->free_meshes);
  data_->meshes[number] = {.there = true, .mesh = std::move(mesh), .instances = {}};
  return MeshId(number);
}

void World::removeMesh(MeshId mesh) {
  WorldData& own = *data_;
  if (mesh.value >= own.meshes.size() || !own.meshes[mesh.value].there) {
    return;
  }
  while (!own.meshes[mesh.value].instances.empty()) {
    remove(own.meshes[mesh.value].instances.back());
  }
  own.meshes[mesh.value] = {};
  own.free_meshes.push_back(mesh.value);
}

InstanceId World::add(const Instance& instance) {
  const std::uint32_t id = data_->addInstance(instance);
  if (instance.shown) {
    data_->place(id);
  }
  return InstanceId(id);
}

void World::add(std::span<const Instance> given, std::vector<InstanceId>& ids) {
  WorldData& own = *data_;
  std::vector<hierarchy::DynamicTree::Item> items;
  for (const Instance& instance : given) {
    const std::uint32_t id = own.addInstance(instance);
    ids.emplace_back(id);
    InstanceData& added = own.instances[id];
    const Box box = added.shown && added.mesh != InstanceData::kNone
                        ? world::boundsOf(own.meshes[added.mesh].mesh.bounds, instance.world_from_mesh,
                                          added.displacement)
                        : Box{};
    if (box.wellFormed()) {
      items.push_back({id, box});
      added.where = Whereabouts::kSettled;
    } else if (added.shown) {
      own.place(id);
    }
  }
  own.settled.insert(items);
}

void World::remove(InstanceId instance) {
  WorldData& own = *data_;
  if (!has(instance)) {
    return;
  }
  const std::uint32_t id = instance.value;
  InstanceData& gone = own.instances[id];
  own.unplace(id);
  own.leaveJoin(id);
  if (gone.mesh != InstanceData::kNone) {
    std::vector<InstanceId>& of_mesh = own.meshes[gone.mesh].instances;
    own.instances[of_mesh.back().value].in_mesh = gone.in_mesh;
    of_mesh[gone.in_mesh] = of_mesh.back();
    of_mesh.pop_back();
  }
  gone = {.listed = gone.listed};
  gone.version = ++own.version;
  own.free_instances.push_back(id);
  --own.count;
}

void World::setTransform(InstanceId instance, const Mat4& world_from_mesh) {
  WorldData& own = *data_;
  if (!has(instance) || own.world_from_mesh[instance.value].m == world_from_mesh.m) {
    return;
  }
  own.world_from_mesh[instance.value] = world_from_mesh;
  own.instances[instance.value].version = ++own.version;
  own.leaveJoin(instance.value);
  own.moved(instance.value);
}

void World::setShown(InstanceId instance, bool shown) {
  WorldData& own = *data_;
  if (!has(instance) || own.instances[instance.value].shown == shown) {
    return;
  }
  InstanceData& changed = own.instances[instance.value];
  changed.shown = shown;
  changed.version = ++own.version;
  if (shown) {
    own.place(instance.value);
  } else {
    own.leaveJoin(instance.value);
    own.unplace(instance.value);
  }
}

bool World::has(InstanceId instance) const {
  return instance.value < data_->instances.size() && data_->instances[instance.value].there;
}
std::size_t World::instances() const {
  return data_->count;
}
std::size_t World::idBound() const {
  return data_->instances.size();
}
MeshId World::meshOf(InstanceId instance) const {
  return has(instance) ? MeshId(data_->instances[instance.value].mesh) : MeshId();
}
Box World::boundsOf(InstanceId instance) const {
  if (!has(instance) || data_->instances[instance.value].mesh == InstanceData::kNone) {
    return {};
  }
  const InstanceData& own = data_->instances[instance.value];
  return world::boundsOf(data_->meshes[own.mesh].mesh.bounds, data_->world_from_mesh[instance.value],
                         own.displacement);
}

WorldJoin World::prepareJoin(std::span<const InstanceId> instances, const SurfaceSettings& settings,
                             const ParallelFor& parallel_for) const {
  const WorldData& own = *data_;
  WorldJoin join;
  Box all;
  for (const InstanceId id : instances) {
    if (has(id) && own.hides(id.value) && boundsOf(id).wellFormed()) {
      join.instances.push_back(id);
      all.extend(boundsOf(id));
    }
  }
  std::sort(join.instances.begin(), join.instances.end());
  join.instances.erase(std::unique(join.instances.begin(), join.instances.end()), join.instances.end());
  if (join.instances.empty()) {
    return join;
  }
  // A whole number, so that positions that are short numbers stay so.
  const Vec3d middle = center(all);
  join.origin = {std::round(middle.x), std::round(middle.y), std::round(middle.z)};
  Scene scene;
  scene.materials = {{.double_sided = false}, {.double_sided = true}};
  for (const InstanceId id : join.instances) {
    join.versions.push_back(own.instances[id.value].version);
    const Mat4& m = own.world_from_mesh[id.value];
    const SurfaceSet& surfaces = own.meshes[own.instances[id.value].mesh].mesh.surfaces;
    const auto first = static_cast<std::uint32_t>(scene.positions.size());
    for (const Vec3f& vertex : surfaces.vertices) {
      scene.positions.emplace_back(transformPoint(m, Vec3d(vertex)) - join.origin);
    }
    const bool mirrored = determinant3(m) < 0.0;
    Object object;
    object.first_index = static_cast<std::uint32_t>(scene.indices.size());
    object.index_count = static_cast<std::uint32_t>(surfaces.triangles.size());
    object.material = MaterialId(surfaces.clusters[0].double_sided ? 1u : 0u);
    for (std::size_t i = 0; i < surfaces.triangles.size(); i += 3) {
      scene.indices.push_back(first + surfaces.triangles[i]);
      scene.indices.push_back(first + surfaces.triangles[i + (mirrored ? 2 : 1)]);
      scene.indices.push_back(first + surfaces.triangles[i + (mirrored ? 1 : 2)]);
    }
    scene.objects.push_back(object);
  }
  updateBounds(scene);
  join.surfaces = findSurfaces(scene.view(), settings, parallel_for);
  return join;
}

JoinId World::use(WorldJoin given) {
  WorldData& own = *data_;
  const std::uint32_t number = numberIn(own.joins, own.free_joins);
  Joined& joined = own.joins[number];
  joined.there = true;
  joined.join = std::move(given);
  const WorldJoin& join = joined.join;
  joined.objects_of_part.group(join.surfaces.parts.size(), [&](auto&& body) {
    for (std::uint32_t object = 0; object < join.instances.size(); ++object) {
      for (const std::uint32_t part : join.surfaces.partsOf(ObjectId(object))) {
        body(part, object);
      }
    }
  });
  // First all members, so that what one of them leaves alone is known to be a member.
  for (std::uint32_t object = 0; object < join.instances.size(); ++object) {
    const InstanceId id = join.instances[object];
    if (has(id) && own.instances[id.value].version == join.versions[object]) {
      own.leaveJoin(id.value);
      InstanceData& member = own.instances[id.value];
      member.join = number;
      member.object = object;
      member.alone = false;
    }
  }
  for (std::uint32_t object = 0; object < join.instances.size(); ++object) {
    const InstanceId id = join.instances[object];
    if (!has(id) || own.instances[id.value].join != number || own.instances[id.value].object != object) {
      joined.join.instances[object] = InstanceId();
      own.leave(joined, object);
    }
  }
  return JoinId(number);
}

void World::drop(JoinId join) {
  WorldData& own = *data_;
  if (join.value >= own.joins.size() || !own.joins[join.value].there) {
    return;
  }
  for (const InstanceId id : own.joins[join.value].join.instances) {
    if (id.valid()) {
      own.instances[id.value].join = InstanceData::kNone;
      own.instances[id.value].alone = true;
    }
  }
  own.joins[join.value] = {};
  own.free_joins.push_back(join.value);
}

void World::tidy(std::uint32_t steps) {
  WorldData& own = *data_;
  ++own.frame;
  const std::uint32_t left = own.moving.tidy(steps);
  own.settle(std::min<std::uint32_t>(left, 256));
  own.settled.tidy(left);
}

}  // namespace sightline
