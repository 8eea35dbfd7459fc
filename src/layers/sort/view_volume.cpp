#include "src/layers/sort/view_volume.h"

#include <algorithm>
#include <cmath>

#include "sightline/geometry/tolerance.h"
#include "src/layers/pairs/envelope_pair.h"

namespace sightline::layers {

ViewVolume::ViewVolume(const View& view) : frustum_(frustumOf(view)), eye_(view.eye) {}

bool ViewVolume::isOutside(const PartStore& parts, std::uint32_t part) const {
  if (parts.finite[part] == 0) {
    return false;
  }
  return std::any_of(frustum_.planes.begin(), frustum_.planes.end(), [&](const Plane& plane) {
    // Heights are measured above the eye, which the planes are near. This is above the rounding of the plane
    // there.
    constexpr double kRounding = 0x1p-45;
    const double at_eye = plane.evaluate(eye_);
    const double margin = kRounding * (l1Norm(eye_) + std::abs(plane.offset));
    for (std::uint32_t i = parts.first_hull[part]; i < parts.first_hull[part + 1]; ++i) {
      ConvexSet set;
      set.around = &parts.envelopes[parts.part_hulls[i]];
      set.placement = parts.placements[part];
      if (!(outerHeight(set, plane.normal, eye_) + at_eye + margin < 0.0)) {
        return false;
      }
    }
    return true;
  });
}

}  // namespace sightline::layers
