// Instances whose surfaces are found together.

#include <algorithm>
#include <cmath>
#include <utility>

#include "sightline/scene/scene.h"
#include "sightline/world/world.h"
#include "src/world/world_data.h"

namespace sightline {

using namespace world;

namespace world {
namespace {

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
  if (own.join != InstanceData::kNone) {
    leave(joins[own.join], own.object);
    own.join = InstanceData::kNone;
    own.alone = true;
  }
}

}  // namespace world

namespace {

// Whether it is certain on which side a transform turns a mesh: it flattens nothing.
bool isSolid(const Mat4& m) {
  const auto column = [&m](int i) { return Vec3d(m(0, i), m(1, i), m(2, i)); };
  const double size = std::max({length(column(0)), length(column(1)), length(column(2))});
  return std::abs(determinant3(m)) > 0x1p-36 * size * size * size;
}

}  // namespace

JoinInput World::joinInput(std::span<const InstanceId> instances) const {
  const WorldData& own = *data_;
  JoinInput input;
  WorldJoin& join = input.join;
  Scene& scene = input.scene;
  join.world = own.number;
  Box all;
  for (const InstanceId id : instances) {
    if (has(id) && own.hides(id.value) && boundsOf(id).wellFormed() &&
        !own.meshes[own.instances[id.value].mesh].mesh.has_occluder &&
        isSolid(own.world_from_mesh[id.value])) {
      join.instances.push_back(id);
      all.extend(boundsOf(id));
    }
  }
  std::sort(join.instances.begin(), join.instances.end());
  join.instances.erase(std::unique(join.instances.begin(), join.instances.end()), join.instances.end());
  if (join.instances.empty()) {
    return input;
  }
  // A whole number, so that positions that are short numbers stay so.
  const Vec3d middle = center(all) + own.origin;
  join.origin = {std::round(middle.x), std::round(middle.y), std::round(middle.z)};
  scene.materials = {{.double_sided = false}, {.double_sided = true}};
  for (const InstanceId id : join.instances) {
    join.versions.push_back(own.instances[id.value].version);
    const Mat4 m = relativeTo(join.origin, own.world_from_mesh[id.value]);
    const SurfaceSet& surfaces = own.meshes[own.instances[id.value].mesh].mesh.surfaces;
    const auto first = static_cast<std::uint32_t>(scene.positions.size());
    for (const Vec3f& vertex : surfaces.vertices) {
      const Vec3d at = transformPoint(m, Vec3d(vertex));
      scene.positions.emplace_back(at);
      join.rounding = std::max(join.rounding, length(Vec3d(scene.positions.back()) - at));
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
  return input;
}

WorldJoin makeJoin(JoinInput input, const SurfaceSettings& settings, const ParallelFor& parallel_for) {
  updateBounds(input.scene);
  input.join.surfaces = findSurfaces(input.scene.view(), settings, parallel_for);
  return std::move(input.join);
}

JoinId World::addJoin(WorldJoin given) {
  WorldData& own = *data_;
  const std::uint32_t number = numberIn(own.joins, own.free_joins);
  Joined& joined = own.joins[number];
  joined.there = true;
  joined.groups = 0xffffffffu;
  joined.join = std::move(given);
  const WorldJoin& join = joined.join;
  joined.objects_of_part.group(join.surfaces.parts.size(), [&](auto&& body) {
    for (std::uint32_t object = 0; object < join.instances.size(); ++object) {
      for (const std::uint32_t part : join.surfaces.partsOf(ObjectId(object))) {
        body(part, object);
      }
    }
  });
  // All members come first, and what is no member goes, so that what one of them leaves alone is known to be
  // a member.
  for (std::uint32_t object = 0; object < join.instances.size(); ++object) {
    const InstanceId id = join.instances[object];
    if (join.world == own.number && has(id) && own.instances[id.value].version == join.versions[object]) {
      own.leaveJoin(id.value);
      InstanceData& member = own.instances[id.value];
      member.join = number;
      member.object = object;
      member.alone = false;
      joined.groups &= member.groups;
    } else {
      joined.join.instances[object] = InstanceId();
    }
  }
  for (std::uint32_t object = 0; object < join.instances.size(); ++object) {
    const InstanceId id = join.instances[object];
    if (!id.valid() || own.instances[id.value].join != number || own.instances[id.value].object != object) {
      joined.join.instances[object] = InstanceId();
      own.leave(joined, object);
    }
  }
  return JoinId(number);
}

void World::removeJoin(JoinId join) {
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

}  // namespace sightline
