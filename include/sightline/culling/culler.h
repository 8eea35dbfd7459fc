#pragma once

// The front door of run-time culling: one call a frame, from a view to the objects that may be seen.

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

#include "sightline/base/parallel_for.h"
#include "sightline/culling/culling_method.h"
#include "sightline/hierarchy/hierarchy.h"
#include "sightline/occluders/choose_occluders.h"
#include "sightline/occluders/occluder_set.h"
#include "sightline/occlusion/visibility.h"
#include "sightline/scene/camera.h"

namespace sightline {

// How the occluders of a frame are chosen, for methods that have occluders.
struct OccluderChoiceSettings {
  std::uint32_t count = 64;  // at most so many a frame
  AreaAngleDirection area_angle_direction = AreaAngleDirection::kOccluder;
  // Without lists: occluders are looked for within so many steps of the observer (lambda); 0: everywhere. The
  // paper has 100, which suits interiors; along a street it leaves out the walls at its end.
  double lambda_steps = 0.0;
};

// What holds for any method, as far as it has occluders or uses sets (MethodTraits).
struct CullerSettings {
  OccluderChoiceSettings occluders{};
  std::uint32_t min_node_cost = 0;  // a node with fewer triangles is taken as visible without a test
  bool test_objects = true;         // objects of partly visible leaves are tested by their own boxes
  // Only what is in the potentially visible set of the eye's cell is tested, and kept.
  bool visible_sets = false;
  // More than 1: where the method can (CullingMethod::answersForRegions(): depthPyramid() with surfaces
  // alone, also in whileItPays() but not in detailObjects()), the scene is culled for up to so many views at
  // once, at most 16: this one and those that the camera is expected to have next, fewer the faster it moves.
  // As long as it does what was expected, the next frames only compare what was kept with their frustum
  // (CullStats::held). More is kept, and the frame in which the scene is culled takes longer.
  std::uint32_t views_at_once = 1;
};

// Culls a scene, frame after frame, by one method.
//
// Conservative: cull() keeps whatever can be seen (docs/conservative.md), with any method and any settings
// but two: RasterSettings::coverage and OpacityMapSettings::tolerance, which are for comparison. A scene
// whose cracks were closed, with closeCracks(), relaxes it by the width of these.
//
// For one thread at a time. Several cullers may cull one scene at the same time, each with VisibleSets of its
// own. The scene and its parts outlive the culler and change only together with reset().
//
// Answers, spans and the depth buffer included, are those of the last cull() and valid until the next one or
// reset(), or until the culler is destroyed.
class Culler {
 public:
  // Where the hierarchy is not of the scene's boxes, because it names other objects or a box lies outside the
  // leaves that name it (kd-tree: outside the box around them), cull() keeps everything, and
  // CullStats::scene_fault says why.
  //
  // Sets are of the scene if every object's box is exactly the baked one; that triangles within equal boxes
  // are others cannot be seen here, see SightFile::matches. For orthographic views everything is in the set.
  //
  // method: not null.
  Culler(const CullingScene& scene, std::unique_ptr<CullingMethod> method,
         const CullerSettings& settings = {});
  ~Culler();
  Culler(Culler&&) noexcept;
  Culler& operator=(Culler&&) noexcept;

  // One frame; view, boxes and occluders are in scene space. Does not fail, and allocates nothing once the
  // storage has grown to what the views need: a view that shows more than all before it may let it grow once
  // more. With a view that validate() refuses, everything is visible (CullStats::view_fault).
  // dynamic_boxes: moving occludees, classified in the same call; sets say nothing about them. moving:
  // occluders of this frame only (makeOccluders), all of which are used in addition by all methods that have
  // occluders. They need to outlive the call only. moving_surfaces: whole surfaces that move, drawn by the
  // methods that draw surfaces, whether the scene has a SurfaceSet or not, unless the method is set to draw
  // none.
  void cull(const View& view, std::span<const Box> dynamic_boxes = {}, const OccluderSet* moving = nullptr,
            std::span<const MovingSurfaces> moving_surfaces = {});

  // Answers of the last cull(). Objects that may be seen, ascending.
  std::span<const ObjectId> visible() const;
  // One state a dynamic box: hidden also means outside the frustum.
  std::span<const Visibility> dynamicStates() const;
  // The scene's occluders that this frame's structure was built from; without those that move.
  std::span<const OccluderId> occludersUsed() const;
  const CullStats& stats() const;
  // What the method alone counted in the last cull(): the same statistics in the same order in every frame, 0
  // where everything was kept and before the first frame.
  std::span<const MethodStatistic> statistics() const;
  // The value of the statistic of this group and name; 0 where the method has none.
  std::uint64_t statistic(std::string_view group, std::string_view name) const;
  // The depth buffer of the opacity map or the depth pyramid; empty with other methods. Of a left-handed view
  // it is mirrored. It is that of depthBufferView(): of the last view, or of the wider one that was culled
  // for it and others (CullerSettings::views_at_once).
  DepthBufferView depthBuffer() const;
  const View& depthBufferView() const;

  // For drawing depth buffers and for the depth pyramid's traversal, from now on; answers do not depend on
  // it. Serial at first.
  void setParallelFor(ParallelFor parallel_for);

  // After any change of scene: boxes that moved, objects that came or went, another hierarchy, other
  // occluders, surfaces, boxes of objects, lists or sets. The culler is then as new, with the same method and
  // settings: all that it made of the scene, and of earlier frames, is made anew, which takes as long as the
  // constructor and allocates. Answers are empty until the next cull().
  //
  // The form without a scene takes the same memory as before, changed in place: for boxes in a vector that
  // has grown, and for other objects, call the other form. A change without reset() is noticed where the
  // number of nodes, of their objects, of occluders or of their corners is another one: then cull() keeps
  // everything, and CullStats::scene_fault says why. What keeps all these numbers, as boxes that moved,
  // cannot be noticed.
  void reset();
  void reset(const CullingScene& scene);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sightline
