#pragma once

// Chooses the occluders of a frame from precomputed lists, or from the objects that the last frame kept.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/culling/culler.h"
#include "sightline/occluders/choose_occluders.h"
#include "src/culling/hierarchical_traversal.h"
#include "src/culling/set_filter.h"

namespace sightline::culling {

// The input of OccluderChoice for one frame.
struct ChoiceFrame {
  const View& view;
  const Frustum& frustum;
  bool jumped;       // the view is not coherent with that of the last frame, see LastView::jumpsTo
  double last_step;  // metres, see LastView::step
  std::span<const ObjectId> last_visible;
  const SetFilter* filter;  // null: no filter
  bool bodies;              // choose convex bodies as a whole, see CullingMethod::drawsBodies
};

class OccluderChoice {
 public:
  OccluderChoice(const CullingScene& scene, const OccluderChoiceSettings& settings)
      : scene_(scene), settings_(settings), search_(*scene.hierarchy, scene.object_bounds) {}

  // Returns at most settings.count occluders of the scene's set, valid until the next call.
  std::span<const OccluderId> choose(const ChoiceFrame& frame);

 private:
  std::span<const OccluderId> chooseAmongSeen(const ChoiceFrame& frame, ChoiceSettings choice);

  CullingScene scene_;
  OccluderChoiceSettings settings_;
  HierarchicalTraversal search_;  // finds the objects in the frustum, whose occluders are the candidates
  OccluderChooser chooser_;
  std::vector<ObjectId> candidates_;
  std::uint32_t frames_since_search_ = 0, frames_between_searches_ = 0;
};

}  // namespace sightline::culling
