#pragma once

// One view of a World: its depth buffer, and what it remembers from frame to frame.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/math/plane.h"
#include "sightline/occlusion/depth_pyramid.h"
#include "sightline/world/world_culler.h"
#include "src/culling/hiding_aims.h"
#include "src/culling/last_view.h"
#include "src/culling/usual_work.h"
#include "src/occlusion/boxes/pixel_boxes.h"
#include "src/world/eye_sets.h"
#include "src/world/hidden_boxes.h"
#include "src/world/id_bits.h"
#include "src/world/world_data.h"

namespace sightline::world {

class WorldEye {
 public:
  explicit WorldEye(const WorldCullerSettings& settings) : settings_(settings), pyramid_({settings.raster}) {}

  // view_world: a usable one. last: what the last frame kept, as a list and as a set. Adds what may be seen
  // to kept, which is as large as the world, and to the counts of stats.
  void cull(const WorldData& data, const View& view_world, std::span<const InstanceId> last,
            const IdBits& last_set, IdBits& kept, WorldCullStats& stats);
  // Forgets the last frame.
  void forget() { last_view_.forget(); }
  // What lies on the negative side of this plane, in world space, is not drawn. Plane(): all is drawn.
  void clipBy(const Plane& plane_world) { clip_world_ = plane_world; }
  EyeSets& sets() { return sets_; }

  // Whether the box, of coordinates from the origin, may be seen in this view of its own, in which nothing
  // hides that is in `ignored`.
  Visibility look(const WorldData& data, const View& view_world, const Box& box,
                  std::span<const InstanceId> ignored);

  Visibility classify(const Box& box) const;
  const DepthPyramid& pyramid() const { return pyramid_; }

 private:
  struct Entry {
    std::uint32_t node;
    bool view_only;  // nothing that was drawn hides any of it
  };
  // A join, or an instance whose own surfaces may be drawn.
  struct Candidate {
    std::uint32_t number;  // JoinId or InstanceId
    bool join;
    float nearest;  // reciprocal depth
  };
  // What is known of an instance that was drawn by its own surfaces.
  struct Past {
    std::uint64_t born = 0;      // of the instance for which it holds
    std::uint32_t drawn_in = 0;  // number of the last frame in which it was drawn
    // One that hides too little for its cost is not drawn for some frames.
    std::uint32_t until = 0;   // number of the frame in which it is drawn again
    std::uint32_t length = 0;  // frames
  };
  // An instance that paid when its own surfaces were drawn.
  struct Useful {
    std::uint32_t id;
    std::uint32_t gain;  // pixels
    std::uint64_t born;
  };

  // Begins a view; returns it as seen from the origin.
  View begin(const WorldData& data, const View& view_world);
  bool isDrawn(const InstanceData& instance) const { return (instance.groups & settings_.groups) != 0; }
  bool isJoined(const WorldData& data, const Joined& joined) const;
  void takeCandidates(const WorldData& data, const View& view, std::span<const InstanceId> candidates);
  bool isBlurred(const WorldData& data, const WorldJoin& join, const View& view) const;
  void separate(const WorldData& data, std::uint32_t join);
  void makeRoom(const WorldData& data);
  bool hidesInView(const WorldData& data, std::uint32_t id) const;
  void drawFirst(const WorldData& data, const View& view, std::span<const InstanceId> last, bool jumped);
  void drawFound(const WorldData& data, const View& view, bool jumped, const IdBits& last_set);
  SurfaceDrawing whatIsLeft(ViewStep step) const;
  std::uint32_t draw(const WorldData& data, const View& view, std::span<const InstanceId> candidates,
                     const SurfaceDrawing& drawing);
  std::uint32_t drawInOrder(const WorldData& data, const View& view, SurfaceDrawing drawing);
  SurfaceStats drawJoin(const WorldData& data, std::uint32_t join, const SurfaceDrawing& drawing);
  SurfaceStats drawAlone(const WorldData& data, std::uint32_t id, const SurfaceDrawing& drawing);
  void listJoins(const WorldData& data, const View& view);
  void takeUseful(const WorldData& data);
  void listAlone(const WorldData& data, const View& view, const SurfaceDrawing& drawing);
  bool waits(const WorldData& data, std::uint32_t id, const SurfaceDrawing& drawing) const;
  void account(const WorldData& data, std::uint32_t id, const SurfaceStats& drawn,
               const SurfaceDrawing& drawing);
  void test(const WorldData& data, bool view_only);
  void test(const hierarchy::DynamicTree& tree, bool view_only);
  void noteHidden(const hierarchy::DynamicTree::Node& node, std::size_t child, const BoxAnswer& answer);
  void testAimedAt();

  WorldCullerSettings settings_;
  EyeSets sets_;
  Plane clip_world_, clip_;     // the second one for coordinates from the origin
  double clip_rounding_ = 0.0;  // of its offset
  DepthPyramid pyramid_;
  culling::LastView last_view_;
  culling::UsualWork usual_work_;
  std::uint32_t frame_ = 0;
  std::vector<Past> pasts_;  // by InstanceId
  // Instances that paid in this frame and in the one before.
  std::vector<Useful> useful_, useful_before_;
  HiddenBoxes hidden_;
  culling::HidingAims<InstanceId> aims_;  // while it has no boxes, surfaces are drawn whatever they hide
  std::uint64_t version_ = 0;             // of the world in the last frame
  WorldCullStats counts_;                 // of this frame
  std::uint32_t work_ = 0;                // of this frame, as SurfaceStats::work: what counts in the budget

  IdBits found_;
  std::vector<InstanceId> shown_, news_;  // found_ as a list, and those of them that are new in this frame
  std::vector<Box> hidden_boxes_;         // scratch for one drawFirst()
  std::vector<Entry> stack_;
  std::vector<BoxAnswer> answers_ = std::vector<BoxAnswer>(hierarchy::DynamicTree::kChildren);
  std::vector<BoxAnswer> aimed_at_answers_;
  std::vector<std::vector<ObjectId>> of_join_;  // by JoinId: members that are drawn
  std::vector<std::uint32_t> alone_;
  std::vector<Box> boxes_;
  std::vector<occlusion::PixelBox> images_;
  std::vector<Candidate> in_order_;
};

// On which side of a plane a box lies: 1 or -1 if all of it does, surely, otherwise 0. Plane(): 1.
// offset_rounding: how far the plane's offset may be off, on top of its own rounding.
int sideOf(const Plane& plane, const Box& box, double offset_rounding = 0.0);

// Adds everything below a node, or nothing if it is kNone.
void addAll(const hierarchy::DynamicTree& tree, std::uint32_t node, IdBits& kept);

}  // namespace sightline::world
