#include "sightline/culling/culling_method.h"

#include <algorithm>

namespace sightline {

void CullingMethod::classify(std::span<const MovingBox>, std::span<Visibility> states) {
  std::fill(states.begin(), states.end(), Visibility::kVisible);
}

void CullingMethod::seesPoints(std::span<const Vec3f>, std::span<std::uint8_t> seen) const {
  std::fill(seen.begin(), seen.end(), std::uint8_t{0});
}

}  // namespace sightline
