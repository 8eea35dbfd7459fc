#pragma once

// What of a World may be seen in a view.

#include <cstdint>
#include <memory>
#include <span>

#include "sightline/math/box.h"
#include "sightline/math/plane.h"
#include "sightline/occlusion/rasteriser.h"
#include "sightline/occlusion/visibility.h"
#include "sightline/occlusion/visible_sets.h"
#include "sightline/scene/camera.h"
#include "sightline/world/world.h"

namespace sightline {

struct WorldCullerSettings {
  RasterSettings raster{};  // of the depth buffer into which surfaces are drawn
  SurfaceLimits drawing{};  // of the surfaces of an instance or a join; `budget` is for all of a view
  bool occlusion = true;    // false: by the view's volume alone
  // Only instances that have one of these bits are drawn in the view (Instance::groups).
  std::uint32_t groups = 0xffffffffu;
  // Pixels of the depth buffer: where the rounding of a join's positions (WorldJoin::rounding) may move its
  // image by more, or a member by more than 2^-21 of its distance, its members hide by their own meshes. What
  // shows through a gap narrower than this between members of a join, or lies closer to a member than
  // WorldJoin::rounding, may be culled; 0: a join whose positions were rounded is not drawn, and its members
  // hide by their own meshes.
  double join_rounding = 0x1p-8;
};

// What the last cull() did.
struct WorldCullStats {
  // What is wrong with the view, in the words of validate(); null where nothing is. Otherwise everything that
  // is shown was kept.
  const char* view_fault = nullptr;
  // Instances that were kept because nothing tells where they are: their mesh is not there or has no extent
  // that is finite, or their matrix is not affine, not finite or leads beyond single precision.
  std::uint32_t unplaced = 0;
  std::uint32_t occluders = 0;     // instances whose own surfaces were drawn, and joins
  std::uint32_t edges = 0;         // of the boundaries that were drawn
  std::uint32_t nodes_tested = 0;  // nodes of the hierarchy whose children were tested
  std::uint32_t boxes_tested = 0;
  double draw_us = 0.0, test_us = 0.0;  // microseconds: drawing the depth buffer, testing boxes
};

// Culls a World for one view, frame after frame. Each view of a frame (the camera's, cascades of shadows,
// reflections) has a culler of its own, and several cullers may cull one world at the same time.
//
// Conservative: whatever can be seen is kept. One exception, only with joins (makeJoin()): see
// WorldCullerSettings::join_rounding; 0 removes it. What hides is what hid something or was kept in the frame
// before, and what is found not to be hidden in this one, each as far as it is there and where it is now,
// never where it was.
//
// Nothing is allocated once the storage has grown to what a few frames need. For one thread at a time.
class WorldCuller {
 public:
  explicit WorldCuller(const WorldCullerSettings& settings = {});
  ~WorldCuller();
  WorldCuller(WorldCuller&&) noexcept;
  WorldCuller& operator=(WorldCuller&&) noexcept;

  // view: in the space of the world. A view with little in common with that of the last call (a cut) is
  // noticed and costs more; one of another world needs reset().
  void cull(const World& world, const View& view);
  // Several views at once, as those of two eyes: what any of them may see. The same number of views in the
  // same order in each frame is best.
  void cull(const World& world, std::span<const View> views);
  // Forgets all frames. The clip plane and the sets stay in use; in another world, sets leave something out
  // only if there, too, the same SetsId stands for their boxes.
  void reset();

  // For views with an oblique near plane or a user clip plane, as those of a mirror: nothing on the negative
  // side of this plane, in world space, is drawn. It is not kept, and hides nothing. Holds for all views from
  // the next cull() on; Plane() ends it.
  void setClipPlane(const Plane& plane);
  // Leaves out what these sets say cannot be seen; see World::addSets(). The sets must outlive their use, at
  // the same address; null ends it. Each culler has look-ups (SetQuery) of its own, which may share one file.
  // Sets of other boxes than World::addSets() was given leave nothing out; finding that takes time as the
  // number of boxes, in this call.
  void useSets(SetsId id, VisibleSets* sets);

  // Answers of the last cull(). Spans, and depthBuffer(), are valid until the next cull() or reset(), or
  // until the culler is destroyed; changes of the world leave them as they are.
  //
  // Instances that may be seen, ascending.
  std::span<const InstanceId> visible() const;
  // The same as a set of bits: instance i is bit i % 64 of word i / 64. As many words as World::idBound()
  // needs. Uploaded as it is, it is bit i % 32 of word i / 32 to a shader (of a little-endian machine).
  std::span<const std::uint64_t> visibleBits() const;
  // Whether it is among these, whatever has been changed since.
  bool isVisible(InstanceId instance) const;
  // Instances that the cull() before did not keep, or that were not there then, and instances that it kept
  // and that are not kept any more or have been removed; ascending.
  std::span<const InstanceId> appeared() const;
  std::span<const InstanceId> disappeared() const;
  const WorldCullStats& stats() const;
  DepthBufferView depthBuffer() const;  // of the first view

  // Whether a box of something that is no instance may be seen in one of the views: kHidden also means
  // outside of them. Every box may be seen before the first cull(), after reset(), and in a view that is not
  // usable. box_from_origin: world space less World::origin(), as World::boundsOf() gives it, and
  // World::boxFromOrigin() for what is no instance.
  // Several threads may ask at the same time.
  Visibility classify(const Box& box_from_origin) const;

 private:
  friend class ShadowCasters;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sightline
