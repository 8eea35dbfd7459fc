#pragma once

// What all methods that use the hierarchical traversal tell it.

#include "sightline/culling/culling_method.h"
#include "src/culling/hierarchical_traversal.h"

namespace sightline::culling {

// skip_partial: nodes that were partly visible in the last frame are not tested.
inline TraversalOptions optionsOf(const CullingFrame& frame, bool skip_partial) {
  return {frame.min_node_cost, skip_partial, frame.test_objects, frame.filter};
}

}  // namespace sightline::culling
