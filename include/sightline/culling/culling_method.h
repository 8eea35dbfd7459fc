#pragma once

// A method of culling as an object: what a Culler asks of it, a few times a frame and never for a single
// node of the hierarchy.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/base/ids.h"
#include "sightline/base/parallel_for.h"
#include "sightline/hierarchy/hierarchy.h"
#include "sightline/math/box.h"
#include "sightline/math/frustum.h"
#include "sightline/math/vec3.h"
#include "sightline/occluders/occluder_lists.h"
#include "sightline/occluders/occluder_set.h"
#include "sightline/occluders/surface_set.h"
#include "sightline/occlusion/rasteriser.h"
#include "sightline/occlusion/visibility.h"
#include "sightline/occlusion/visible_sets.h"
#include "sightline/scene/camera.h"
#include "sightline/scene/object_boxes.h"

namespace sightline {

namespace culling {
class DetailTest;
class SetFilter;
}  // namespace culling

// The scene that is culled: views of the caller's memory, which outlives the culler and changes only together
// with a call of Culler::reset(). Whatever a method does not use may be null.
struct CullingScene {
  const Hierarchy* hierarchy = nullptr;  // of these boxes
  std::span<const Box> object_bounds{};  // by ObjectId, scene space
  // Several boxes an object, by which what the method keeps is tested once more; null: no such test. They are
  // found in the same triangles, and again whenever triangles change: those of an object are not used where
  // the box around them is not exactly the object's own, but a change within that box cannot be noticed.
  const ObjectBoxes* object_boxes = nullptr;
  const OccluderSet* occluders = nullptr;
  // Surfaces of the same scene, for methods that draw whole surfaces; null: they draw none.
  const SurfaceSet* surfaces = nullptr;
  // Candidates for the occluders of a frame, by the eye's place and direction; null: they are found anew in
  // each frame among the objects that the last one kept.
  const OccluderLists* occluder_lists = nullptr;
  // Occluders near an object, for detailObjects(): OccluderDatabaseSettings::turned_away. Null: no such test.
  const OccluderLists* near_objects = nullptr;
  // Potentially visible sets, used by one culler alone; null, or sets of other boxes: everything is in them.
  VisibleSets* sets = nullptr;
};

// Whether a method looks at the potentially visible set of the eye's cell.
enum class SetUse : std::uint8_t {
  kNever,
  kIfAsked,  // with CullerSettings::visible_sets
  kAlways,
};

// What a method needs, the same for all of its settings.
struct MethodTraits {
  bool occluders = false;  // it hides boxes behind occluders, which are chosen for each frame
  SetUse sets = SetUse::kIfAsked;
  bool hierarchy = true;  // without one nothing is culled
};

// What a frame counted and how long it took, whatever the method.
struct CullStats {
  // What is wrong with the view, in the words of validate(); null where nothing is. Otherwise everything was
  // kept.
  const char* view_fault = nullptr;
  // What is wrong with the scene, whose parts do not fit together or which changed without reset(); null
  // where nothing is. Otherwise every object was kept, also outside the frustum, and no other count is made.
  const char* scene_fault = nullptr;
  // Null, or that a method which has occluders was given neither surfaces nor occluders, or that sets are of
  // other boxes and are not used.
  const char* scene_note = nullptr;
  // The answer was found in an earlier frame (CullerSettings::views_at_once): no other count is made.
  bool held = false;
  std::uint32_t nodes_visited = 0;     // nodes that were compared with the frustum
  std::uint32_t nodes_tested = 0;      // nodes that the occlusion structure was asked about
  std::uint32_t objects_tested = 0;    // objects that it was asked about
  std::uint32_t nodes_skipped = 0;     // nodes that temporal coherence left untested
  std::uint32_t occluders = 0;         // occluders in the occlusion structure, those that move included
  std::uint64_t hidden_triangles = 0;  // about how many triangles are below what was found hidden; not with
                                       // the depth pyramid
  std::uint32_t set_nodes = 0;    // nodes of the potentially visible set, 1 where that is everything; else 0
  std::uint32_t set_objects = 0;  // objects below them
  // Microseconds: finding the set, choosing occluders, building the structure, traversing the hierarchy with
  // the boxes that move, and detailObjects().
  double look_up_us = 0.0, choose_us = 0.0, build_us = 0.0, traverse_us = 0.0, detail_us = 0.0;

  double totalUs() const { return look_up_us + choose_us + build_us + traverse_us + detail_us; }
};

// A count that one method alone makes, of the last frame.
struct MethodStatistic {
  // Statistics that belong together, as "relations": the tool writes them as one object of that name, beside
  // the frame's own keys, so no group is called "frame", "visible" or "occluders".
  const char* group = "";    // "relations": statistics that belong together
  const char* name = "";     // "reused": its name within the group, in snake_case
  const char* caption = "";  // "relations reused": for people
  std::uint64_t value = 0;
};

// How a method uses CullingScene::surfaces. With a coverage rule of the caller it draws none.
enum class SurfaceUse : std::uint8_t {
  kNone,
  kAlone,          // instead of chosen occluders; occluders that move are drawn nevertheless
  kWithOccluders,  // in addition to them
};

// What a method is told about a frame. All of it is valid until the frame ends.
struct CullingFrame {
  View view{};        // validate() accepts it; never left-handed
  Frustum frustum{};  // of the view
  // For whom the answers must hold; more than the view's own eye only where answersForRegions().
  ViewerRegion viewers{};
  bool jumped = false;  // the view has little to do with that of the last frame
  // The chosen occluders of the scene's set and then, where there are any, a set of all that move. A method
  // uses all of them, and counts them all in CullStats::occluders; occludersUsed() names those of the first
  // set alone. Empty where the method wants none.
  std::span<const ChosenOccluders> occluders{};
  std::span<const MovingSurfaces> moving_surfaces{};  // of this frame alone; for methods that draw surfaces
  std::uint32_t max_occluders = 0;                    // so many were asked for
  std::span<const ObjectId> last_visible{};           // what the last frame kept; only if not jumped
  // Frames since the last one of which the method was told: its answers held for them (CullStats::held).
  std::uint32_t held_before = 0;
  // What is not in it is neither tested nor kept; null: no filter.
  const culling::SetFilter* filter = nullptr;
  bool filter_changed = false;      // since the last frame
  std::uint32_t min_node_cost = 0;  // see CullerSettings
  bool test_objects = true;
  const ParallelFor* parallel_for = nullptr;  // never null
};

// A box that is tested by itself, as one that moves, and the planes of the frustum that it may cross: bit i
// is clear where the box is inside of plane i.
struct MovingBox {
  Box box{};
  std::uint8_t frustum_planes = kAllFrustumPlanes;
  // Null, or a point of the box at which it was last seen. Where that is still seen a method may look no
  // further; it may replace the point.
  Vec3f* seen_point = nullptr;
};

// Made with its settings by a function of its own (occlusionTree(), depthPyramid(), ...), then owned by one
// Culler, which calls, in this order: prepare() once a scene; in each frame wantsOccluders(), build(),
// traverse(), classify() and finish(). A method never hides what can be seen, allocates nothing once its
// storage has grown to what a few frames need, and is used by one thread at a time.
//
// To add a method, see "Adding a method" in docs/architecture.md.
class CullingMethod {
 public:
  CullingMethod() = default;
  CullingMethod(const CullingMethod&) = delete;
  CullingMethod& operator=(const CullingMethod&) = delete;
  virtual ~CullingMethod() = default;

  virtual MethodTraits traits() const = 0;
  // Whether the next frame needs chosen occluders of the scene's set.
  virtual bool wantsOccluders() const { return traits().occluders; }
  // Whether a convex body counts as one occluder, so that one of its faces is enough.
  virtual bool drawsBodies() const { return false; }
  // Whether its answers in the next frame can hold for several viewers, CullingFrame::viewers.
  virtual bool answersForRegions() const { return false; }

  // Takes the scene and forgets every frame. scene.hierarchy and scene.occluders are never null here, but
  // may be empty.
  virtual void prepare(const CullingScene& scene) = 0;

  // Makes the occlusion structure of the frame ready.
  virtual void build(const CullingFrame&) {}
  // Appends the objects that may be seen to visible, ascending, and adds to the counts of stats.
  virtual void traverse(const CullingFrame& frame, CullStats& stats, std::vector<ObjectId>& visible) = 0;
  // For detailObjects(): a method that has supporting planes of the frame's occluders runs the test with them
  // and returns true; others leave it to detailObjects().
  virtual bool testDetail(culling::DetailTest&, std::vector<ObjectId>&) { return false; }
  // States of boxes in the frustum, one for each: of boxes that move, and of several boxes an object.
  virtual void classify(std::span<const MovingBox> boxes, std::span<Visibility> states);
  // Sets seen[i] to 1 where points[i] is surely seen, so that classify() would hide no box that contains it;
  // to 0 where that is not known. seen: as many as points.
  virtual void seesPoints(std::span<const Vec3f> points, std::span<std::uint8_t> seen) const;
  // The frame ends: completes stats and the method's own statistics. stats has the frame's times, but for
  // classify().
  virtual void finish(CullStats&) {}

  // Occluders of the scene's set that the structure of the last frame was built from.
  virtual std::span<const OccluderId> occludersUsed() const { return {}; }
  // The depth buffer of the last frame; empty with methods that have none.
  virtual DepthBufferView depthBuffer() const { return {}; }
  // The same ones, in the same order, after every frame and before the first; of the last frame that ended.
  virtual std::span<const MethodStatistic> statistics() const { return {}; }
};

}  // namespace sightline
