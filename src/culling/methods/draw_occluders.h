#pragma once

#include <cstddef>

#include "sightline/culling/culling_method.h"

namespace sightline::culling {

// Draws the occluders into a depth buffer. Returns how many of the buffer's occluders are of the scene's own
// set: those that move have ids of their own.
template <typename Buffer>
std::size_t drawOccluders(Buffer& buffer, std::span<const ChosenOccluders> sets,
                          const ParallelFor& parallel_for) {
  std::size_t own = 0;
  for (std::size_t i = 0; i < sets.size(); ++i) {
    buffer.draw(*sets[i].set, sets[i].chosen, parallel_for);
    own = i == 0 ? buffer.occluders().size() : own;
  }
  return own;
}

}  // namespace sightline::culling
