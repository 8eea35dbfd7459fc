#pragma once

// What the culler asks of an occluder database: the good occluders for a viewpoint and a viewing direction.

#include <span>

#include "sightline/base/ids.h"
#include "sightline/math/vec3.h"

namespace sightline {

// Lists of occluders that were chosen in advance. Implementations do not change once they are built, so that
// any number of threads may ask them at the same time.
class OccluderLists {
 public:
  virtual ~OccluderLists() = default;

  // The list for an eye (scene space) that looks along `direction` (any length > 0), best first. Every eye
  // has a list, also one that is not finite. Allocates nothing. The list lives as long as the database.
  virtual std::span<const OccluderId> find(const Vec3d& eye, const Vec3d& direction) const = 0;

  // True: the first occluders that are in view are taken, in the order of the list. False: the occluders of
  // the list are ranked by their area-angle for the view.
  virtual bool inOrder() const = 0;

 protected:
  // Implementations are values that may be copied; this part of them is not copied alone.
  OccluderLists() = default;
  OccluderLists(const OccluderLists&) = default;
  OccluderLists& operator=(const OccluderLists&) = default;
};

}  // namespace sightline
