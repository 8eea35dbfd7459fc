#include "sightline/scene/scene.h"

#include <algorithm>
#include <bit>
#include <numeric>

#include "src/base/hash_slots.h"

namespace sightline {
namespace {

struct PositionKey {
  std::uint32_t x, y, z;
  friend bool operator==(const PositionKey&, const PositionKey&) = default;
};

PositionKey keyOf(const Vec3f& p) {
  // Adding zero turns -0 into +0, so that equal coordinates have equal bits.
  return {std::bit_cast<std::uint32_t>(p.x + 0.0f), std::bit_cast<std::uint32_t>(p.y + 0.0f),
          std::bit_cast<std::uint32_t>(p.z + 0.0f)};
}

std::size_t hashOf(const PositionKey& key) {
  std::uint64_t h = key.x * 0x9e3779b97f4a7c15ull;
  h = (h ^ (h >> 29) ^ key.y) * 0xbf58476d1ce4e5b9ull;
  h = (h ^ (h >> 32) ^ key.z) * 0x94d049bb133111ebull;
  return static_cast<std::size_t>(h ^ (h >> 31));
}

}  // namespace

Box sceneBounds(const SceneView& scene) {
  Box bounds;
  for (const Object& object : scene.objects) {
    bounds.extend(object.bounds);
  }
  return bounds;
}

void weldPositions(Scene& scene) {
  // Open-addressing table of the kept positions, in order of first use by an index: deterministic, in one
  // pass.
  constexpr std::uint32_t kFree = 0xffffffffu;
  const std::size_t capacity = std::bit_ceil(scene.positions.size() * 2 + 2);
  std::vector<std::uint32_t> table(capacity, kFree);
  std::vector<std::uint32_t> new_index(scene.positions.size(), kFree);
  std::vector<Vec3f> kept;
  kept.reserve(scene.positions.size());
  for (std::uint32_t& index : scene.indices) {
    std::uint32_t& renamed = new_index[index];
    if (renamed == kFree) {
      const Vec3f& position = scene.positions[index];
      const PositionKey key = keyOf(position);
      const std::size_t slot = base::probeSlots(
          table, hashOf(key), [&](std::uint32_t at) { return at == kFree || keyOf(kept[at]) == key; });
      if (table[slot] == kFree) {
        table[slot] = static_cast<std::uint32_t>(kept.size());
        kept.push_back({position.x + 0.0f, position.y + 0.0f, position.z + 0.0f});
      }
      renamed = table[slot];
    }
    index = renamed;
  }
  kept.shrink_to_fit();
  scene.positions = std::move(kept);
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
