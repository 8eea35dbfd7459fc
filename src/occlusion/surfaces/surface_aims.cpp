#include "src/occlusion/surfaces/surface_aims.h"

#include <algorithm>
#include <cstring>

namespace sightline::occlusion {

void SurfaceAims::begin(const scene::PixelView& view, const DepthTarget& target) {
  extents_.begin(view, Box(), target);
  known_ = false;
}

void SurfaceAims::aim(std::span<const Box> boxes, WindingMap& map) {
  if (isAimedAt(boxes)) {
    return;
  }
  boxes_.assign(boxes.begin(), boxes.end());
  if (!boxes.empty()) {
    setNeeds(map.target());
  }
  map.aimAt(boxes.empty() ? nullptr : &needs_);
  known_ = true;
}

bool SurfaceAims::mayUse(const Box& box, const WindingMap& map) const {
  BoxExtent extent;
  return extents_.of(box, extent) ? map.wanted(extent.rectangle, extents_.nearestOf(extent)) > 0
                                  : extent.inexact;
}

// Compares bits: boxes that have the same value in other bits, or that are not numbers, may count as others.
bool SurfaceAims::isAimedAt(std::span<const Box> boxes) const {
  return known_ && boxes.size() == boxes_.size() &&
         (boxes.empty() || std::memcmp(boxes.data(), boxes_.data(), boxes.size_bytes()) == 0);
}

// Sets needs_ to what boxes_ need, as far as they lie beyond the clip depth.
void SurfaceAims::setNeeds(const DepthTarget& target) {
  needs_.clear(target);
  if (!extents_.view().sane()) {
    return;
  }
  Box all;
  for (const Box& box : boxes_) {
    all.extend(box);
  }
  extents_.begin(scene::PixelView(extents_.view()), all, target);
  extents_.project(boxes_, images_);
  for (std::size_t i = 0; i < boxes_.size(); ++i) {
    BoxExtent extent;
    if (extents_.of(boxes_[i], images_[i], extent) && !extent.cut) {
      needs_.add(extent.rectangle, extents_.nearestOf(extent));
    }
  }
}

}  // namespace sightline::occlusion
