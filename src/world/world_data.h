#pragma once

// What a World holds, as those who cull it read it.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/scene/camera.h"
#include "sightline/world/world.h"
#include "src/base/rows.h"
#include "src/hierarchy/dynamic_tree.h"

namespace sightline::world {

// Instances whose surfaces were found together.
struct Joined {
  bool there = false;
  WorldJoin join;
  std::uint32_t groups = 0;                   // that all members have
  base::Rows<std::uint32_t> objects_of_part;  // indices into join.instances, where members that left are not
                                              // valid any more
};

// The box of a mesh, as boxes of its instances are made from it.
struct MeshExtent {
  MeshExtent() = default;
  explicit MeshExtent(const Box& bounds);
  bool known = false;  // else the box is not well formed
  Vec3d middle, half;  // half: from the middle to the faces
  Vec3d farthest;      // the largest coordinates, without their signs
};

struct MeshData {
  bool there = false;
  MeshExtent extent;
  WorldMesh mesh;
  std::vector<InstanceId> instances;
};

// Objects of a baked scene.
struct BakedObjects {
  bool there = false;
  std::vector<InstanceId> instances{};  // by ObjectId; not valid for tombstones
  std::vector<ObjectId> tombstones{};
  std::uint64_t boxes = 0;    // hashOfBoxes()
  Vec3d origin;               // world space
  std::uint32_t groups = 0;   // that all of them have
  std::uint64_t version = 0;  // of the last change
};

// The same for equal boxes of the same objects, in whatever tree they are.
std::uint64_t hashOfBoxes(const BoxTreeView& boxes);

enum class Whereabouts : std::uint8_t {
  kNowhere,    // not there, or hidden
  kSettled,    // in WorldData::settled
  kMoving,     // in WorldData::moving
  kUnbounded,  // in WorldData::unbounded
};

// What every change and every frame reads of an instance. Small, so that moving many of a large world misses
// the caches seldom.
struct InstanceData {
  static constexpr std::uint32_t kNone = 0xffffffffu;

  bool there = false, shown = false, occludes = false;
  bool listed = false;  // in WorldData::movers
  Whereabouts where = Whereabouts::kNowhere;
  bool alone = true;   // it hides by its own mesh
  bool moves = false;  // it goes to the moving ones at once
  bool baked = false;  // it belongs to sets
  float displacement = 0.0f;
  std::uint32_t mesh = kNone;
  std::uint32_t join = kNone, object = kNone;  // it is that object of that join
  std::uint32_t groups = 0;
  std::uint32_t last_moved = 0;  // number of the frame, in the moving tree
  std::uint64_t version = 0;     // of its last change
  std::uint64_t born = 0;        // the version in which it was added
};

struct InstanceExtra {
  std::uint64_t user_data = 0;
  std::uint32_t in_mesh = 0;       // its place in MeshData::instances
  std::uint32_t in_unbounded = 0;  // with Whereabouts::kUnbounded: its place in WorldData::unbounded
  // With InstanceData::baked: it is that object of those sets.
  std::uint32_t sets = InstanceData::kNone, object = InstanceData::kNone;
};

// A matrix to world space as one to the space around an origin.
inline Mat4 relativeTo(const Vec3d& origin, Mat4 world_from_any) {
  for (int axis = 0; axis < 3; ++axis) {
    world_from_any(axis, 3) -= origin[axis];
  }
  return world_from_any;
}

// A number that no other World of this process has.
std::uint64_t newWorldNumber();

struct WorldData {
  // Whether the instance's own surfaces may be drawn.
  bool hides(std::uint32_t id) const {
    const InstanceData& own = instances[id];
    return hasBox(id) && own.occludes && own.displacement == 0.0f && own.mesh != InstanceData::kNone &&
           !meshes[own.mesh].mesh.surfaces.parts.empty();
  }

  // Whether nothing says that an instance that was baked as an occluder hides nothing any more.
  bool mayBeBaked(std::uint32_t id) const {
    const InstanceData& own = instances[id];
    return hasBox(id) && own.occludes && own.displacement == 0.0f && meshes[own.mesh].mesh.occludes;
  }

  // Whether the instance is shown and has a box.
  bool hasBox(std::uint32_t id) const {
    return instances[id].where == Whereabouts::kSettled || instances[id].where == Whereabouts::kMoving;
  }

  // Returns the box, from the origin, of an instance that has one.
  const Box& boxOf(std::uint32_t id) const {
    return instances[id].where == Whereabouts::kMoving ? moving.boxOf(id) : settled.boxOf(id);
  }

  std::vector<MeshData> meshes;
  std::vector<std::uint32_t> free_meshes;
  std::vector<InstanceData> instances;  // by InstanceId, as are the next columns
  std::vector<InstanceExtra> extras;
  std::vector<Mat4> world_from_mesh;
  std::vector<std::uint32_t> free_instances;
  std::size_t count = 0;        // instances that are there
  std::size_t in_no_group = 0;  // of these, with no bit of InstanceData::groups
  std::uint64_t version = 0;    // grows with each change
  std::uint64_t number = newWorldNumber();
  std::vector<Joined> joins;
  std::vector<std::uint32_t> free_joins;
  std::vector<BakedObjects> sets;

  Vec3d origin;                  // world space; boxes are relative to it
  bool origin_moves = false;     // to next_origin
  Vec3d next_origin;             // world space
  std::vector<InstanceId> lost;  // found without a box from next_origin, some twice; takeOrigin() places them
  hierarchy::DynamicTree settled, moving;  // boxes of what is shown
  std::vector<InstanceId> unbounded;       // shown, with no box that is well formed
  std::vector<InstanceId> movers;          // those in `moving`, and some that have left it; each once
  std::vector<hierarchy::DynamicTree::Item> moves;  // scratch for World::setTransforms()
  std::size_t next_mover = 0;                       // that tidy() looks at
  std::uint32_t frame = 0;                          // calls of tidy()

  void place(std::uint32_t id);
  void setMoving(std::uint32_t id);
  void unplace(std::uint32_t id);
  void moved(std::uint32_t id);
  void leave(Joined& joined, std::uint32_t object);
  void leaveJoin(std::uint32_t id);
  void leaveSets(std::uint32_t id);
  hierarchy::DynamicTree::Item movedInPlace(InstanceId instance, const Mat4& to, std::uint64_t new_version);
  // Boxes from an origin in world space, rounded outwards; empty if there is none.
  Box boundsOf(std::uint32_t id, const Vec3d& from) const;
  Box boundsOf(std::uint32_t id) const { return boundsOf(id, origin); }
  void goOnToOrigin();
  void takeOrigin();
  void placeAnew(std::span<const InstanceId> instances);
  // The matrix that takes points of an instance's mesh to where boxes are.
  Mat4 originFromMesh(std::uint32_t id) const { return relativeTo(origin, world_from_mesh[id]); }
  // A view of world space as seen from the origin.
  View fromOrigin(View view_world) const {
    view_world.eye = view_world.eye - origin;
    return view_world;
  }
  std::uint32_t addInstance(const Instance& instance);
  void settle(std::uint32_t looks);
};

// Returns the index of an element of a list that is not in use: one of `free`, which it takes out of there,
// or that of an element that it appends.
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

}  // namespace sightline::world
