#include "sightline/scene/scene.h"

#include <utility>

#include "src/scene/weld.h"

namespace sightline {
Box sceneBounds(const SceneView& scene) {
  Box bounds;
  for (const Object& object : scene.objects) {
    bounds.extend(object.bounds);
  }
  return bounds;
}

void weldPositions(Scene& scene) {
  constexpr std::uint32_t kUnknown = 0xffffffffu;
  std::vector<std::uint32_t> number_of(scene.positions.size(), kUnknown);
  scene::PositionNumbers numbers(scene.positions.size());
  for (std::uint32_t& index : scene.indices) {
    std::uint32_t& number = number_of[index];
    number = number == kUnknown ? numbers.numberOf(scene.positions[index]) : number;
    index = number;
  }
  const LargeVector<Vec3f> kept = std::move(numbers).take();
  scene.positions.assign(kept.begin(), kept.end());
}

void updateBounds(Scene& scene) {
  for (Object& object : scene.objects) {
    object.bounds = Box{};
    for (std::uint32_t i = 0; i < object.index_count; ++i) {
      object.bounds.extend(scene.positions[scene.indices[object.first_index + i]]);
    }
  }
}

}  // namespace sightline
