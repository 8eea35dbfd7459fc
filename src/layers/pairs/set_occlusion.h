#pragma once

// Whether convex sets that are parts of no sorter occlude each other: a trial before parts are made of them.

#include <span>

#include "sightline/scene/camera.h"
#include "src/layers/pairs/convex_pair.h"

namespace sightline::layers {

class SetOcclusion {
 public:
  // more_eyes: as LayerSorter::update() takes them; must stay as long as this.
  SetOcclusion(const View& view, std::span<const Vec3d> more_eyes) : view_(view), more_eyes_(more_eyes) {}

  // Whether some set in front occludes some set behind. All are placed hulls; true if it is not certain.
  bool occludes(std::span<const ConvexSet> front, std::span<const ConvexSet> back) const;

 private:
  bool occludes(const ConvexSet& front, const ConvexSet& back) const;

  View view_;
  std::span<const Vec3d> more_eyes_;
};

}  // namespace sightline::layers
