#pragma once

// One view of a World: its depth buffer, and what it remembers from frame to frame.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/occlusion/depth_pyramid.h"
#include "sightline/world/world_culler.h"
#include "src/culling/last_view.h"
#include "src/culling/usual_work.h"
#include "src/occlusion/pixel_boxes.h"
#include "src/world/id_bits.h"
#include "src/world/world_data.h"

namespace sightline::world {

class WorldEye {
 public:
  explicit WorldEye(const WorldCullerSettings& settings) : settings_(settings), pyramid_({settings.raster}) {}

  // view: a usable one. last: what the last frame kept, as a list and as a set. Adds what may be seen to
  // kept, which is as large as the world, and to the counts of stats.
  void cull(const WorldData& data, const View& view, std::span<const InstanceId> last, const IdBits& last_set,
            IdBits& kept, WorldCullStats& stats);
  // Forgets the last frame.
  void forget() { last_view_.forget(); }

  const DepthPyramid& pyramid() const { return pyramid_; }

 private:
  struct Entry {
    std::uint32_t node;
    bool view_only;  // nothing that was drawn hides any of it
  };
  // An instance whose own surfaces may be drawn.
  struct Candidate {
    std::uint32_t id;
    float nearest;  // reciprocal depth
  };
  // What is not worth its cost is left out for some frames.
  struct Rest {
    std::uint64_t born = 0;    // of the instance for which it holds
    std::uint32_t until = 0;   // number of the frame in which it is drawn again
    std::uint32_t length = 0;  // frames
  };

  void draw(const WorldData& data, const View& view, std::span<const InstanceId> candidates, ViewStep step);
  void drawJoins(const WorldData& data, SurfaceDrawing& drawing);
  void drawAlone(const WorldData& data, const View& view, SurfaceDrawing& drawing);
  void listNearFirst(const WorldData& data, const View& view, const SurfaceDrawing& drawing);
  void test(const WorldData& data, bool view_only);
  void test(const hierarchy::DynamicTree& tree, bool view_only);

  WorldCullerSettings settings_;
  DepthPyramid pyramid_;
  culling::LastView last_view_;
  culling::UsualWork usual_work_;
  std::uint32_t frame_ = 0;
  std::vector<Rest> rests_;  // by InstanceId
  WorldCullStats counts_;    // of this frame

  IdBits found_;
  std::vector<InstanceId> listed_;  // scratch: what is drawn
  std::vector<Entry> stack_;
  std::vector<BoxAnswer> answers_ = std::vector<BoxAnswer>(hierarchy::DynamicTree::kChildren);
  std::vector<std::vector<ObjectId>> of_join_;  // by JoinId: members that are drawn
  std::vector<std::uint32_t> alone_;
  std::vector<Box> boxes_;
  std::vector<occlusion::PixelBox> images_;
  std::vector<Candidate> near_first_;
};

// Adds everything below a node, or nothing if it is kNone.
void addAll(const hierarchy::DynamicTree& tree, std::uint32_t node, IdBits& kept);

}  // namespace sightline::world
