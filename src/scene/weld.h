#pragma once

// Numbers positions, equal ones with the same number.

#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "sightline/base/large_vector.h"
#include "sightline/math/vec3.h"
#include "src/base/hash_slots.h"

namespace sightline::scene {

// A table of positions in the order in which they were first asked for, so that what lies together in the
// input does so in the result. -0 equals 0; NaN equals a NaN of the same bits.
class PositionNumbers {
 public:
  // most: no more different positions than that are asked for.
  explicit PositionNumbers(std::size_t most) : slots_(std::bit_ceil(most * 2 + 2), kFree) {
    positions_.reserve(most);
  }

  std::uint32_t numberOf(const Vec3f& position) {
    const Key key = keyOf(position);
    const std::size_t slot = base::probeSlots(
        slots_, hashOf(key), [&](std::uint32_t at) { return at == kFree || keyOf(positions_[at]) == key; });
    if (slots_[slot] == kFree) {
      slots_[slot] = static_cast<std::uint32_t>(positions_.size());
      positions_.push_back({position.x + 0.0f, position.y + 0.0f, position.z + 0.0f});
    }
    return slots_[slot];
  }

  // The positions by number. Ends the use of this.
  LargeVector<Vec3f> take() && { return std::move(positions_); }

 private:
  static constexpr std::uint32_t kFree = 0xffffffffu;
  struct Key {
    std::uint32_t x, y, z;
    friend bool operator==(const Key&, const Key&) = default;
  };

  static Key keyOf(const Vec3f& p) {
    // Adding zero turns -0 into +0, so that equal coordinates have equal bits.
    return {std::bit_cast<std::uint32_t>(p.x + 0.0f), std::bit_cast<std::uint32_t>(p.y + 0.0f),
            std::bit_cast<std::uint32_t>(p.z + 0.0f)};
  }
  static std::uint64_t hashOf(const Key& key) {
    std::uint64_t h = key.x * 0x9e3779b97f4a7c15ull;
    h = (h ^ (h >> 29) ^ key.y) * 0xbf58476d1ce4e5b9ull;
    h = (h ^ (h >> 32) ^ key.z) * 0x94d049bb133111ebull;
    return h ^ (h >> 31);
  }

  LargeVector<std::uint32_t> slots_;  // numbers of positions
  LargeVector<Vec3f> positions_;
};

}  // namespace sightline::scene
