#pragma once

#include <span>

#include "sightline/base/ids.h"
#include "sightline/math/vec3.h"

namespace sightline {

// Lists of occluders that were made ahead: which ones may matter at a place, in a direction. Safe to share
// between threads.
class OccluderLists {
 public:
  virtual ~OccluderLists() = default;

  // The list for the place and direction (scene space; the direction need not have a length of 1). Valid as
  // long as this is.
  virtual std::span<const OccluderId> find(const Vec3d& eye, const Vec3d& direction) const = 0;
  // Whether the best come first, so that the first ones in view are taken; otherwise they are ranked anew for
  // each view.
  virtual bool inOrder() const = 0;
};

}  // namespace sightline
