#pragma once

// The front door of run-time culling: one call a frame, from a view to the objects that may be seen.

#include <cstdint>
#include <memory>
#include <span>

#include "sightline/base/parallel_for.h"
#include "sightline/comparison/viewpoint_database.h"
#include "sightline/hierarchy/hierarchy.h"
#include "sightline/occluders/choose_occluders.h"
#include "sightline/occluders/occluder_database.h"
#include "sightline/occluders/occluder_set.h"
#include "sightline/occlusion/depth_pyramid.h"
#include "sightline/occlusion/occlusion_tree.h"
#include "sightline/occlusion/opacity_map.h"
#include "sightline/occlusion/supporting_planes.h"
#include "sightline/occlusion/visibility.h"
#include "sightline/occlusion/visible_sets.h"
#include "sightline/scene/camera.h"

namespace sightline {

enum class CullMethod : std::uint8_t {
  kFrustum,
  kOcclusionTree,
  kSupportingPlanes,
  kOpacityMap,
  kDepthPyramid,
  // The potentially visible set of the eye's cell, as far as it meets the frustum. No occluders: the bake has
  // done their work.
  kVisibilityOctree,
};

// Where a frame's occluders come from.
enum class OccluderChoice : std::uint8_t {
  kAreaAngle,  // ranked anew in every frame, among the objects that the last frame kept
  kDatabase,   // the database's list for the viewpoint's cell and the nearest direction, ranked for the view
  // The first ones in view of the viewpoint database's list, which has been built by this criterion.
  kMinimumSets,
  kFirstHit,
  kProjectedSize,
};

// Depth pyramid: a second, finer map around the direction in which the first one hides least. Perspective
// views and inner coverage only; the occluders are what the last frame kept there.
struct FocusSettings {
  double magnification = 8.0;  // its pixels along the side of one of the first map's; 1 or less: no such map
  RasterSettings raster{.width = 128, .height = 64};  // coverage: as the first map's
  std::uint32_t occluder_count = 64;  // at most so many, in addition to those of the first map
  std::uint32_t min_objects = 256;    // that the first map does not hide there, for it to be made
};

struct CullerSettings {
  CullMethod method = CullMethod::kOcclusionTree;
  OcclusionTreeVariant variant = OcclusionTreeVariant::kFME;
  SupportingPlanesSettings supporting_planes{};  // keep_relations: see temporal_coherence
  RasterSettings raster{};                       // opacity map and depth pyramid
  FocusSettings focus{};
  // Opacity map, see OpacityMapSettings.
  DepthComparison depth_comparison = DepthComparison::kSparse;
  std::uint32_t tolerance = 0;  // other than 0 it is NOT conservative
  double coverage_ratio = 0.2;
  // What the renderer takes for a triangle, microseconds; > 0: coverage_ratio follows measured times and may
  // suspend occlusion culling (adaptive_coverage.h), so that what is kept, always conservative, depends on
  // them.
  double triangle_us = 0.0;
  OccluderChoice occluders = OccluderChoice::kAreaAngle;
  std::uint32_t occluder_count = 64;  // at most so many a frame
  AreaAngleDirection area_angle_direction = AreaAngleDirection::kOccluder;
  // Occluders are looked for within so many steps of the observer (lambda); 0: everywhere. The paper has 100,
  // which suits interiors; along a street it leaves out the walls at its end.
  double lambda_steps = 0.0;
  std::uint32_t min_node_cost = 0;  // a node with fewer triangles is taken as visible without a test
  // Occlusion tree: nodes found partial are not tested in the next frame. Supporting planes: relations are
  // kept from frame to frame. Depth pyramid: what was kept is not tested for six to nine frames.
  bool temporal_coherence = true;
  // Only what is in the potentially visible set of the eye's cell is asked about, and kept; not with
  // kFrustum.
  bool visible_sets = false;
  bool test_objects = true;  // objects of partly visible leaves are tested by their own boxes
  // Objects that the walk kept are tested once more, with the occluders near themselves; not dynamic boxes,
  // and not with kFrustum and kVisibilityOctree.
  bool detail_objects = false;
  std::uint32_t detail_occluder_count = 8;  // for each of them
};

struct CullStats {
  // What is wrong with the view, in the words of validate(); null where nothing is. Otherwise everything was
  // kept.
  const char* view_fault = nullptr;
  // The scene does not fit together, or has changed without reset(): every object was kept, also outside the
  // frustum, and no other count is made.
  bool unfit = false;
  bool focused = false;                // see FocusSettings
  std::uint32_t nodes_visited = 0;     // frustum tests of nodes
  std::uint32_t nodes_tested = 0;      // nodes asked of the occlusion structure
  std::uint32_t objects_tested = 0;    // objects asked of it
  std::uint32_t nodes_skipped = 0;     // by temporal coherence
  std::uint32_t occluders = 0;         // in the occlusion structure
  std::uint32_t occluders_hidden = 0;  // of them: behind what the map had already
  std::uint32_t tree_nodes = 0;        // of the occlusion tree
  std::uint64_t tree_plane_tests = 0;  // OcclusionTreeStats::plane_tests
  std::uint32_t tree_dropped =
      0;                      // occluder fragments that found no room (costs tightness, never correctness)
  RelationStats relations{};  // of the supporting planes
  OpacityMapStats opacity{};
  std::uint64_t hidden_triangles = 0;  // of nodes and objects found hidden, about; not with the depth pyramid
  double coverage_ratio = 0.0;         // the opacity map's in this frame
  bool suspended = false;              // occlusion culling, which did not pay (CullerSettings::triangle_us)
  std::uint32_t detail_tested = 0;     // objects that got the second test
  std::uint32_t detail_culled = 0;     // and were hidden by it
  std::uint32_t set_nodes = 0;         // of the potentially visible set, 1 where that is everything; else 0
  std::uint32_t set_objects = 0;       // below them
  double look_up_us = 0.0;             // finding the set; in another cell also marking what it leaves
  double choose_us = 0.0, build_us = 0.0, walk_us = 0.0, detail_us = 0.0;
  double totalUs() const { return look_up_us + choose_us + build_us + walk_us + detail_us; }
};

struct OccluderDatabases {
  // For OccluderChoice::kDatabase; without it occluders are chosen by area-angle.
  const OccluderDatabase* from_eye = nullptr;
  // For detail_objects, OccluderDatabaseSettings::turned_away; without it the second test is left out.
  const OccluderDatabase* from_objects = nullptr;
  // For OccluderChoice::kMinimumSets, kFirstHit and kProjectedSize; without it occluders are chosen by
  // area-angle.
  const ViewpointDatabase* from_viewpoints = nullptr;
};

class Culler {
 public:
  // Views of the caller's data, which must outlive this, and which do not change without reset(). Boxes are
  // by ObjectId, and the hierarchy is of these boxes: where it is not, because it names other objects or a
  // box lies outside the leaves that name it (kd-tree: outside the box around them), cull() keeps everything
  // (CullStats::unfit).
  //
  // sets: for kVisibilityOctree and visible_sets, used by this culler alone. Without them, where they are of
  // other boxes, and for orthographic views, everything is in the set. They are of the scene if every
  // object's box is exactly the baked one; that triangles within equal boxes are others cannot be seen here,
  // see SightFile::matches.
  Culler(const Hierarchy& hierarchy, std::span<const Box> object_bounds, const OccluderSet& occluders,
         const CullerSettings& settings = {}, const OccluderDatabases& databases = {},
         VisibleSets* sets = nullptr);
  ~Culler();
  Culler(Culler&&) noexcept;
  Culler& operator=(Culler&&) noexcept;

  // One frame. dynamic_boxes: moving occludees, classified in the same call; sets say nothing about them.
  // Does not fail, and does not allocate after a few frames; with a view that validate() refuses, everything
  // is visible (CullStats::view_fault). moving: occluders of this frame only (makeOccluders), in scene space,
  // all of which are used in addition by all methods that use occluders; the second test of detail_objects
  // leaves them out. They need to outlive the call only.
  void cull(const View& view, std::span<const Box> dynamic_boxes = {}, const OccluderSet* moving = nullptr);

  // Answers of the last cull(). Objects that may be seen, ascending.
  std::span<const ObjectId> visible() const;
  // One state a dynamic box: hidden also means outside the frustum.
  std::span<const Visibility> dynamicStates() const;
  // The occluders that this frame's structure was built from; without those that move.
  std::span<const OccluderId> occludersUsed() const;
  const CullStats& stats() const;
  // What the opacity map or the depth pyramid was made of; empty with other methods. Of a left-handed view it
  // is mirrored.
  DepthMapView depthMap() const;

  // For drawing the maps and for the depth pyramid's walk, from now on; answers do not depend on it. Serial
  // at first.
  void setParallelFor(ParallelFor parallel_for);

  // After any change of scene: boxes that moved, objects that came or went, another hierarchy, other
  // occluders, databases or sets. The culler is then as new, with the same settings: all that it made of the
  // scene, and of earlier frames, is made anew, which takes as long as the constructor and allocates. Answers
  // are empty until the next cull().
  //
  // This form takes the same memory as before, changed in place: for boxes in a vector that has grown, and
  // for other objects, call the other form. A change without reset() is noticed where the number of nodes, of
  // their objects, of occluders or of their corners is another one: then cull() keeps everything
  // (CullStats::unfit). What keeps all these numbers, as boxes that moved, cannot be noticed.
  void reset();
  void reset(const Hierarchy& hierarchy, std::span<const Box> object_bounds, const OccluderSet& occluders,
             const OccluderDatabases& databases = {}, VisibleSets* sets = nullptr);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sightline
