#pragma once

#include <algorithm>
#include <vector>

#include "sightline/base/ids.h"
#include "tests/support/any_culler.h"

namespace sightline::kept_objects {

using Objects = std::vector<ObjectId>;

// The objects that the culler keeps for the view.
inline Objects visibleOf(AnyCuller& culler, const View& view) {
  culler.cull(view);
  return {culler.visible().begin(), culler.visible().end()};
}

// Whether the large list has all of the small one. Precondition: both are sorted.
inline bool includesAll(const Objects& large, const Objects& small) {
  return std::includes(large.begin(), large.end(), small.begin(), small.end());
}

}  // namespace sightline::kept_objects
