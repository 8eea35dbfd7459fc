#pragma once

// What a World holds, as those who cull it read it.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/world/world.h"
#include "src/base/rows.h"
#include "src/hierarchy/dynamic_tree.h"

namespace sightline::world {

// Instances whose surfaces were found together.
struct Joined {
  bool there = false;
  WorldJoin join;
  base::Rows<std::uint32_t> objects_of_part;  // indices into join.instances, where members that left are not
                                              // valid any more
};

struct MeshData {
  bool there = false;
  WorldMesh mesh;
  std::vector<InstanceId> instances;
};

enum class Whereabouts : std::uint8_t {
  kNowhere,    // not there, or hidden
  kSettled,    // in WorldData::settled
  kMoving,     // in WorldData::moving
  kUnbounded,  // in WorldData::unbounded
};

struct InstanceData {
  static constexpr std::uint32_t kNone = 0xffffffffu;

  bool there = false, shown = false, occludes = false;
  bool listed = false;  // in WorldData::movers
  Whereabouts where = Whereabouts::kNowhere;
  bool alone = true;  // it hides by its own mesh
  float displacement = 0.0f;
  std::uint32_t mesh = kNone;
  std::uint32_t in_mesh = 0;                   // its place in MeshData::instances
  std::uint32_t join = kNone, object = kNone;  // it is that object of that join
  std::uint32_t last_moved = 0;                // number of the frame, in the moving tree
  std::uint64_t version = 0;                   // of its last change
  std::uint64_t born = 0;                      // the version in which it was added
};

struct WorldData {
  // Whether the instance's own surfaces may be drawn.
  bool hides(std::uint32_t id) const {
    const InstanceData& own = instances[id];
    return (own.where == Whereabouts::kSettled || own.where == Whereabouts::kMoving) && own.occludes &&
           own.displacement == 0.0f && own.mesh != InstanceData::kNone &&
           !meshes[own.mesh].mesh.surfaces.parts.empty();
  }

  // Of an instance that hides and has a box; world space.
  const Box& boxOf(std::uint32_t id) const {
    return instances[id].where == Whereabouts::kMoving ? moving.boxOf(id) : settled.boxOf(id);
  }

  std::vector<MeshData> meshes;
  std::vector<std::uint32_t> free_meshes;
  std::vector<InstanceData> instances;  // by InstanceId, as is the next column
  std::vector<Mat4> world_from_mesh;
  std::vector<std::uint32_t> free_instances;
  std::size_t count = 0;      // instances that are there
  std::uint64_t version = 0;  // grows with each change
  std::vector<Joined> joins;
  std::vector<std::uint32_t> free_joins;

  hierarchy::DynamicTree settled, moving;  // boxes in world space
  std::vector<InstanceId> unbounded;       // shown, with no box that is well formed
  std::vector<InstanceId> movers;          // those in `moving`, and some that have left it; each once
  std::size_t next_mover = 0;              // that tidy() looks at
  std::uint32_t frame = 0;                 // calls of tidy()

  void place(std::uint32_t id);
  void unplace(std::uint32_t id);
  void moved(std::uint32_t id);
  void leave(Joined& joined, std::uint32_t object);
  void leaveJoin(std::uint32_t id);
  std::uint32_t addInstance(const Instance& instance);
  void settle(std::uint32_t looks);
};

// The box of an instance, grown by what single precision may move its points. Not well formed if it cannot be
// told.
Box boundsOf(const Box& mesh_bounds, const Mat4& world_from_mesh, double displacement);

}  // namespace sightline::world
