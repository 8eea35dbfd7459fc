#include "src/occlusion/surface_aims.h"

#include <algorithm>
#include <cstring>

namespace sightline::occlusion {

void SurfaceAims::aim(std::span<const Box> boxes, const PixelView& view, const DepthTarget& target,
                      WindingMap& map) {
  if (isAimedAt(boxes)) {
    return;
  }
  boxes_.assign(boxes.begin(), boxes.end());
  if (!boxes.empty()) {
    setNeeds(view, target);
  }
  map.aimAt(boxes.empty() ? nullptr : &needs_);
  known_ = true;
}

// Compares bits: boxes that have the same value in other bits, or that are not numbers, may count as others.
bool SurfaceAims::isAimedAt(std::span<const Box> boxes) const {
  return known_ && boxes.size() == boxes_.size() &&
         (boxes.empty() || std::memcmp(boxes.data(), boxes_.data(), boxes.size_bytes()) == 0);
}

// Sets needs_ to what boxes_ need, as far as they lie beyond the clip depth.
void SurfaceAims::setNeeds(const PixelView& view, const DepthTarget& target) {
  needs_.clear(target);
  if (!view.sane()) {
    return;
  }
  Box all;
  for (const Box& box : boxes_) {
    all.extend(box);
  }
  extents_.begin(view, all, target);
  extents_.project(boxes_, images_);
  for (std::size_t i = 0; i < boxes_.size(); ++i) {
    BoxExtent extent;
    if (extents_.of(boxes_[i], images_[i], extent) && !extent.cut) {
      needs_.add(extent.rectangle, extents_.nearestOf(extent));
    }
  }
}

}  // namespace sightline::occlusion
