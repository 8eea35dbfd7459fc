#include "sightline/scene/scene.h"

#include <utility>

#include "src/scene/weld.h"

namespace sightline {

Box sceneBounds(const SceneView& scene) {
  Box bounds;
  for (const Object& object : scene.objects) {
    if (object.bounds.wellFormed()) {
      bounds.extend(object.bounds);
    }
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

void updateBounds(std::span<const Vec3f> positions, std::span<const std::uint32_t> indices,
                  std::span<Object> objects) {
  for (Object& object : objects) {
    object.bounds = Box{};
    for (const std::uint32_t index : indices.subspan(object.first_index, object.index_count)) {
      if (!isFinite(positions[index])) {
        object.bounds = Box{};
        break;
      }
      object.bounds.extend(positions[index]);
    }
  }
}

void updateBounds(Scene& scene) {
  updateBounds(scene.positions, scene.indices, scene.objects);
}

}  // namespace sightline
