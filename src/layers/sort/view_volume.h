#pragma once

// The part of space that a view shows.

#include <cstdint>

#include "sightline/math/frustum.h"
#include "sightline/scene/camera.h"
#include "src/layers/pairs/part_store.h"

namespace sightline::layers {

class ViewVolume {
 public:
  explicit ViewVolume(const View& view);

  // Whether all hulls of the part lie beyond one plane of the view, by their envelopes. True is certain; a
  // part that is not finite is not outside.
  bool isOutside(const PartStore& parts, std::uint32_t part) const;

 private:
  Frustum frustum_;
  Vec3d eye_;
};

}  // namespace sightline::layers
