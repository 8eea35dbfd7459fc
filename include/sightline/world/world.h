#pragma once

// A world of instances of meshes that are added, removed, moved, shown and hidden in any frame.
//
// A renderer tells a World what there is, and asks a WorldCuller, one for each view, what may be seen:
//
//   World world;
//   Result<WorldMesh> made = makeMesh(mesh);                              // once a mesh
//   if (!made) ... made.error().message
//   const MeshId crate = world.addMesh(std::move(*made));
//   const InstanceId one = world.add({crate, world_from_mesh});           // at any time
//   world.setTransform(one, elsewhere);
//   world.tidy();                                                         // once a frame
//   WorldCuller culler;
//   culler.cull(world, view);                                             // every frame
//   for (InstanceId id : culler.visible()) ...

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sightline/base/ids.h"
#include "sightline/base/parallel_for.h"
#include "sightline/hierarchy/box_tree.h"
#include "sightline/math/box.h"
#include "sightline/math/mat4.h"
#include "sightline/occluders/surface_set.h"
#include "sightline/scene/scene.h"
#include "sightline/world/world_mesh.h"

namespace sightline {

namespace world {
struct WorldData;
}

// Ids of a World's meshes, instances and joins stay the same as long as these are there; after removeMesh(),
// remove() or removeJoin(), the next one that comes may have the same id. So forget an id together with what
// it names; World::bornOf() tells two instances with one id apart.
using MeshId = Id<struct MeshTag>;
using InstanceId = Id<struct InstanceTag>;
using JoinId = Id<struct JoinTag>;
using SetsId = Id<struct SetsTag>;  // of a World; never given again

struct Instance {
  MeshId mesh{};
  Mat4 world_from_mesh{};       // affine; it may scale, shear and mirror, which leaves fronts fronts
  std::uint64_t user_data = 0;  // the caller's own: a pointer, or the number of a draw call
  // Bits of the caller's choice: in views that have none of them, the instance is not drawn, so it is not
  // kept, and hides nothing (WorldCullerSettings::groups).
  std::uint32_t groups = 1;
  bool shown = true;
  bool occludes = true;  // false: it hides nothing, whatever its mesh does
  // It will move in the next frames. The first movement of others takes about a microsecond, later ones a
  // tenth.
  bool moves = false;
  // More than 0, metres: vertices may be this far from where the matrix takes them (skinning, waves). The
  // instance then hides nothing, and its box is larger by this.
  double displacement = 0.0;
};

// What makeJoin() found, for World::addJoin(). Not to be changed by hand.
struct WorldJoin {
  std::vector<InstanceId> instances{};
  std::vector<std::uint64_t> versions{};  // of the instances
  std::uint64_t world = 0;                // the number of their World
  Vec3d origin{};                         // of the surfaces, world space
  SurfaceSet surfaces{};                  // ObjectId is the index into `instances`
  // Metres: how far, at most, a vertex of the surfaces is from where its matrix takes it, as far as double
  // precision can tell. Surfaces are in single precision, so this is 0 only for positions of few digits, else
  // up to 2^-24 of the distance from `origin`.
  double rounding = 0.0;
};

// What World::joinInput() copied, for makeJoin(). Not to be changed by hand.
struct JoinInput {
  WorldJoin join{};  // without its surfaces
  Scene scene{};     // their triangles, from WorldJoin::origin; its objects are the instances
};

// Finds the surfaces of instances anew as one, so that what touches hides jointly. Takes as long as
// findSurfaces(), on any thread, while the World changes: it reads the input alone.
WorldJoin makeJoin(JoinInput input, const SurfaceSettings& settings = {},
                   const ParallelFor& parallel_for = serialFor);

// Matrices and eyes are in double precision, in world space. Boxes are in single precision, relative to
// origin(), which moves with the camera where the world is large. The axes may be any: nothing depends on
// which one is up. Calls with an id that is not there have no effect.
//
// Memory: all of it, as that of WorldCuller, ShadowCasters and WorldSight, comes from operator new, also the
// aligned one; replacing that is the hook. An instance keeps about 250 bytes resident, and from the first
// time that tidy() builds the hierarchy anew about 75 more.
//
// Everything that is not const is for one thread, while no other one reads. Between two changes any number of
// threads may cull, each with a WorldCuller of its own.
class World {
 public:
  World();
  ~World();
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;

  MeshId addMesh(WorldMesh mesh);
  // Removes a mesh and its instances.
  void removeMesh(MeshId mesh);

  // Makes room for so many instances, all together. Without it, some of those that are added one by one take
  // long, as storage doubles and what is there is copied: 50 milliseconds in a world of half a million.
  void reserve(std::size_t instances);
  // Takes about a microsecond. An instance with a matrix that is not finite, or of a mesh that is not there,
  // is in every answer while it is shown.
  InstanceId add(const Instance& instance);
  // Adds many and appends their ids. Where they are at least an eighth of those that rest, the hierarchy is
  // built anew for all that rests, in n log n time; fewer are added to it one by one. The same holds for
  // those that move (Instance::moves), in a hierarchy of their own.
  void add(std::span<const Instance> instances, std::vector<InstanceId>& ids);
  void remove(InstanceId instance);
  // Puts another instance in the place of one, which gets the same id: another mesh, as of another level of
  // detail, or another displacement. The same as remove() and add(), and as fast.
  void replace(InstanceId instance, const Instance& by);
  void setTransform(InstanceId instance, const Mat4& world_from_mesh);
  // Instance i gets matrix i. For many this takes half to three quarters of the time of as many calls of
  // setTransform(), and most of it may be shared among threads. No instance may be named twice.
  void setTransforms(std::span<const InstanceId> instances, std::span<const Mat4> world_from_mesh,
                     const ParallelFor& parallel_for = serialFor);
  void setShown(InstanceId instance, bool shown);
  void setGroups(InstanceId instance, std::uint32_t groups);

  // World space less this are the coordinates of all boxes: of boundsOf() and of those that are classified.
  // A few kilometres from it, single precision and the rounding of double precision make boxes larger and
  // let less hide; nothing else depends on it.
  Vec3d origin() const;
  // For worlds in which the camera travels far. In the next calls of tidy(), about one for 400 instances, or
  // a few times as many while thousands move, everything gets its box from the new origin, beside the one
  // from the old origin, which stays in use. Then origin() becomes the new one, in a call of tidy(). Cull
  // again before anything is classified. A move to another origin that goes on is given up, so this is not
  // for the camera's place in each frame. An origin that is not finite has no effect.
  void moveOrigin(const Vec3d& origin);
  // The same at once, as behind a loading screen. Takes some 120 nanoseconds an instance.
  void setOrigin(const Vec3d& origin);

  // Whether an instance has this id: perhaps not the one that had it before.
  bool has(InstanceId instance) const;
  // A number that no other instance of this World has or had; replace() makes another instance, too. Note it
  // with an id to find out later whether the id has been given again. 0 if it is not there.
  std::uint64_t bornOf(InstanceId instance) const;
  std::size_t instances() const;  // that are there
  // All ids are below this: the size of an array by InstanceId.
  std::size_t idBound() const;
  Box boundsOf(InstanceId instance) const;  // from origin(), rounded outwards; not well formed if unknown
  // A box of what is no instance, given by its corners in world space, as one to classify or to look at: from
  // origin(), rounded outwards. Right until origin() becomes another one.
  Box boxFromOrigin(const Vec3d& min_world, const Vec3d& max_world) const;
  MeshId meshOf(InstanceId instance) const;
  std::uint64_t userDataOf(InstanceId instance) const;  // 0 if it is not there

  // Copies the triangles of instances for makeJoin(). Instances of a join that touch hide jointly: walls of
  // panels, floors of tiles, a level of brushes. Those that are hidden or hide nothing are left out. Changes
  // nothing, so that several threads may call it. Worth it for what does not move. Positions are rounded to
  // single precision, relative to the middle of the join (WorldJoin::rounding), and touch where they are
  // equal then. Takes some nanoseconds a triangle.
  JoinInput joinInput(std::span<const InstanceId> instances) const;
  // Takes microseconds. Instances that are in another join leave it. Those that have changed since
  // joinInput() leave this one at once, and all if that was of another World, such as the last level's. One
  // that moves, is hidden or is removed later leaves it, too; what was connected with it then hides by its
  // own mesh. Where rounding could be seen (WorldCullerSettings::join_rounding), members hide by their own
  // meshes.
  JoinId addJoin(WorldJoin join);
  // Its instances hide by their own meshes again.
  void removeJoin(JoinId join);

  // Says which instances a baked scene's objects are, so that WorldCuller::useSets() can leave out what its
  // sets say cannot be seen. objects: by ObjectId of the baked scene; not valid where an object is not there.
  // boxes: of the sets (VisibleSets::boxes()). baked_origin: where the origin of the baked scene lies, world
  // space.
  //
  // Sets stay right while the world changes. What came is in no set, and is always tested like all else. What
  // was moved, hidden or removed, or lies elsewhere than the baked box says, is a tombstone: a set that has a
  // tombstone in it counts as everything. All other sets hold: the first surface along a line of sight is
  // always in the set of the cell that the line starts in, so what no line of sight meets hides nothing that
  // another thing does not hide too. An instance that is in several belongs to the last one. For an eye that
  // is in no cell of the baked scene, as in the next part of a streamed world, its sets leave nothing out.
  //
  // What is said to hide nothing is a tombstone as well: by Instance::occludes or displacement, or by
  // MeshSettings::occludes. Else only boxes are compared, so it is for the caller to see to that an object is
  // drawn as it was baked, with the same triangles, sides and opacity: one that was opaque and is now glass
  // or alpha-tested, or was turned within its box, is not to be named in `objects`.
  //
  // An instance counts as unmoved if its box is off the baked one, along each axis, by at most 2^-20 of the
  // terms of that coordinate in the baked scene, as rounding to single precision may leave it: a millimetre
  // at a kilometre from that scene's origin.
  //
  // doors: those that the sets were baked with (SightFile::doors). They may move, be hidden and removed
  // without becoming tombstones, since the sets hold while all of them are open, and are always tested like
  // what came. Where the look-up is told that some are closed (SetQuery::setClosedDoors), it is for the
  // caller to see to that these are there and shown, stand where they were baked, are as opaque as they were
  // then, and belong to all groups that are culled.
  SetsId addSets(std::span<const InstanceId> objects, BoxTreeView boxes, const Vec3d& baked_origin = {},
                 std::span<const ObjectId> doors = {});
  void removeSets(SetsId sets);
  std::size_t tombstones(SetsId sets) const;  // tells when it is worth to bake anew

  // Call this once a frame, before culling: keeps the hierarchy good, in at most about so many steps of some
  // 20 nanoseconds, and goes on with moveOrigin(). Answers are right without it, but culling becomes slower.
  // Where a quarter of the instances was added one by one, or the hierarchy has worn in another way, it
  // builds another one in the calls to come, about one for 500 instances, and uses the old one until that is
  // done.
  void tidy(std::uint32_t steps = 10000);
  // Builds the hierarchy anew at once, as if all had been added as one list: after a loading screen, where
  // much was added one by one. Takes half a second for a million instances; no frame needs it.
  void rebuild();

 private:
  friend class WorldCuller;
  friend class WorldSight;
  friend class ShadowCasters;
  std::unique_ptr<world::WorldData> data_;
};

}  // namespace sightline
