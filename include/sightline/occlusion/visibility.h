#pragma once

#include <cstdint>

namespace sightline {

// A region's state for one viewpoint and one set of occluders. A predicate that cannot tell says "not
// hidden".
enum class Visibility : std::uint8_t { kHidden, kPartial, kVisible };

// The state of a union of two parts (Bittner et al. 1998, table 1).
constexpr Visibility combine(Visibility a, Visibility b) {
  return a == b ? a : Visibility::kPartial;
}

}  // namespace sightline
