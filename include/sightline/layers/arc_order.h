#pragma once

// Sorts parts by arcs that the caller knows, for example from what is seen in the pixels of a picture,
// instead of by the hulls of a LayerSorter.

#include <memory>
#include <span>

#include "sightline/layers/layer_sorter.h"

namespace sightline {

class ArcSorter {
 public:
  ArcSorter();
  ~ArcSorter();
  ArcSorter(ArcSorter&&) noexcept;
  ArcSorter& operator=(ArcSorter&&) noexcept;

  // Returns an order in which the sorted parts of `order` are grouped and ordered by these arcs alone; a
  // group of several parts is a strongly connected component. Parts that no arc orders keep to their places
  // as far as they can. Overlays, depth-buffered parts and backdrops stay where they are, and arcs of them or
  // of parts that the order lacks are ignored. The result has the given arcs, ascending, each once, and the
  // order's collisions; it is valid until the next call and no longer than `order`. Both may be of the last
  // result.
  // The order is right where the arcs are: a missing arc may let what is behind cover what is in front.
  const LayerOrder& sort(const LayerOrder& order, std::span<const LayerArc> arcs);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sightline
