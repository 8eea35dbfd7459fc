#pragma once

// The interface of what brings the parts of a frame into groups, front to back.

#include <cstdint>
#include <span>

#include "src/layers/sort/occluder_source.h"

namespace sightline {

// Keeps its memory from frame to frame. For one thread at a time.
class LayerSortAlgorithm {
 public:
  virtual ~LayerSortAlgorithm() = default;

  // Replaces `order` by the strongly connected components of the parts, each a group, front to back. The
  // parts of a group are in the order of `previous`. previous: every part to be sorted, each once, in about
  // the order in which it will leave. source: answers for these parts alone, all of which are active;
  // afterwards none is.
  virtual void sort(std::span<const std::uint32_t> previous, layers::OccluderSource& source,
                    layers::GroupedOrder& order) = 0;

  // How often the last sort() put a part or group back into its list; 0 for an algorithm that never does.
  virtual std::uint64_t reinsertions() const { return 0; }
};

}  // namespace sightline
