#pragma once

// What surfaces are drawn for in a view: boxes that they are to hide, whatever set they are of.

#include <span>
#include <vector>

#include "sightline/math/box.h"
#include "src/occlusion/boxes/pixel_boxes.h"
#include "src/occlusion/surfaces/box_extents.h"
#include "src/occlusion/surfaces/need_map.h"
#include "src/occlusion/surfaces/winding_map.h"
#include "src/scene/pixel_view.h"

namespace sightline::occlusion {

// Pixels that what is drawn must change for each unit of its work, or it is not worth it. Fewer are enough
// where only pixels count in which something is to be hidden: these are few, but worth more.
constexpr double leastGain(bool aims) {
  return aims ? 0.075 : 0.3;
}

// Many sets may be drawn for the same boxes. What these need is found once, and kept up to date in between.
class SurfaceAims {
 public:
  // A view begins, or nothing is aimed at any more. view: of scene space.
  void begin(const scene::PixelView& view, const DepthTarget& target);
  // Has the map aim at these boxes of scene space, or if there are none, at everything. It stays the same map
  // until begin().
  void aim(std::span<const Box> boxes, WindingMap& map);
  // False: surfaces that lie in this box of scene space are of no use.
  bool mayUse(const Box& box, const WindingMap& map) const;

 private:
  bool isAimedAt(std::span<const Box> boxes) const;
  void setNeeds(const DepthTarget& target);

  bool known_ = false;  // the map aims at boxes_
  std::vector<Box> boxes_;
  NeedMap needs_;
  BoxExtents extents_;
  std::vector<PixelBox> images_;
};

}  // namespace sightline::occlusion
