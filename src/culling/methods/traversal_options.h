#pragma once

// What all methods that use the hierarchical traversal tell it.

#include "sightline/culling/culling_method.h"
#include "src/culling/hierarchical_traversal.h"

namespace sightline::culling {

// skip_partial: nodes that were partly visible in the last frame are not tested.
inline TraversalOptions optionsOf(const CullingFrame& frame, bool skip_partial) {
  return {frame.min_node_cost, skip_partial, frame.test_objects, frame.filter};
}

// A structure that hides nothing: what is left is view-frustum culling.
inline auto seeEverything() {
  return AskAll{[](const TraversalBox&) { return Visibility::kVisible; }};
}

}  // namespace sightline::culling
