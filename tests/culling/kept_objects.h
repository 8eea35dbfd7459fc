#pragma once

#include <algorithm>
#include <vector>

#include "sightline/base/ids.h"
#include "sightline/culling/culler.h"

namespace sightline::kept_objects {

using Objects = std::vector<ObjectId>;

// The objects that the culler keeps for the view.
inline Objects visibleOf(Culler& culler, const View& view) {
  culler.cull(view);
  return {culler.visible().begin(), culler.visible().end()};
}

inline bool isKept(const Culler& culler, ObjectId object) {
  return std::binary_search(culler.visible().begin(), culler.visible().end(), object);
}

// Whether the large list has all of the small one. Precondition: both are sorted.
inline bool includesAll(const Objects& large, const Objects& small) {
  return std::includes(large.begin(), large.end(), small.begin(), small.end());
}

}  // namespace sightline::kept_objects
