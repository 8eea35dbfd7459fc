#pragma once

// What layers come to over the frames of a walk.

#include <cstddef>
#include <vector>

#include "sightline/layers/layer_sorter.h"

namespace sightline::tool {

class LayerTotals {
 public:
  struct Frame {
    double groups = 0.0, grouped = 0.0, grouped_share = 0.0;  // groups of more than one part
    double parts_in_groups_share = 0.0;                       // in those
    double grouped_size = 0.0;                                // mean size of those; 0: there are none
    double largest = 0.0;
    double layers = 0.0, operations = 0.0;
    double arcs = 0.0, collisions = 0.0, pair_queries = 0.0, reinsertions = 0.0, sort_us = 0.0;
  };

  void add(const LayerOrder& order, double layers, double operations, double sort_us);

  std::size_t frames() const { return frames_.size(); }
  double mean(double Frame::*value) const;
  double largest(double Frame::*value) const;
  // Of the groups with more than one part in all frames.
  double meanGroupedSize() const;

 private:
  std::vector<Frame> frames_;
};

}  // namespace sightline::tool
