#pragma once

// Rings of grid points as paths of Clipper, which clips polygons in whole numbers, and its failures.

#include <cstdint>
#include <polyclipping/clipper.hpp>

#include "src/drawing/outline_chain.h"

namespace sightline::drawing {

// Calls act(), which returns whether Clipper did its work. False also if Clipper throws, as it does when its
// sweep reaches an invalid state.
template <typename Act>
bool clipSafely(Act&& act) {
  try {
    return act();
  } catch (const ClipperLib::clipperException&) {
    return false;
  }
}

// Drops the lowest bits of all coordinates.
inline ClipperLib::Path clipperPath(const GridPath& ring, int dropped_bits = 0) {
  ClipperLib::Path path;
  for (const GridPoint& p : ring) {
    path.emplace_back(p.x >> dropped_bits, p.y >> dropped_bits);
  }
  return path;
}

inline GridPath gridPath(const ClipperLib::Path& path, int dropped_bits = 0) {
  const std::int64_t cell = std::int64_t{1} << dropped_bits;
  GridPath ring;
  for (const ClipperLib::IntPoint& p : path) {
    ring.push_back({p.X * cell, p.Y * cell});
  }
  return ring;
}

}  // namespace sightline::drawing
