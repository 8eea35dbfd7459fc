#pragma once

// Means and maxima of the sort over the frames of a camera path.

#include <cstddef>
#include <vector>

#include "sightline/layers/layer_sorter.h"

namespace sightline::tool {

class LayerTotals {
 public:
  struct Frame {
    double groups = 0.0;                        // of parts that are not left to the depth buffer
    double depth_buffered = 0.0;                // parts that are
    double outside = 0.0;                       // parts outside the view, if those are left out
    double grouped = 0.0, grouped_share = 0.0;  // number and share of groups of more than one part
    double parts_in_groups_share = 0.0;         // share of the parts that are in those groups
    double grouped_size = 0.0;                  // mean size of those groups; 0: there are none
    double largest = 0.0;                       // size of the largest group
    double layers = 0.0, operations = 0.0;
    double arcs = 0.0, collisions = 0.0, pair_queries = 0.0, reinsertions = 0.0, sort_us = 0.0;
  };

  void add(const LayerOrder& order, double layers, double operations, double sort_us);

  std::size_t frames() const { return frames_.size(); }
  double mean(double Frame::*value) const;
  double largest(double Frame::*value) const;
  // These are of the frames after the first, whose sort starts from nothing; of the first if there is no
  // other.
  double largestAfterFirst(double Frame::*value) const;
  // Takes each frame's sort_us from `again`, the same frames sorted once more, where that is less.
  void keepFaster(const LayerTotals& again);
  // Returns the mean size of the groups of more than one part in all frames.
  double meanGroupedSize() const;

 private:
  std::vector<Frame> frames_;
};

}  // namespace sightline::tool
