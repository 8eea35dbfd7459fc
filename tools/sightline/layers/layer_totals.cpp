#include "tools/sightline/layers/layer_totals.h"

#include <algorithm>

namespace sightline::tool {

void LayerTotals::add(const LayerOrder& order, double layers, double operations, double sort_us) {
  const bool buffers = order.depth_buffered != LayerOrder::kNone;
  Frame frame{.groups = static_cast<double>(order.groups() - (buffers ? 1 : 0)),
              .depth_buffered = buffers ? static_cast<double>(order.group(order.depth_buffered).size()) : 0.0,
              .outside = static_cast<double>(order.stats.outside),
              .layers = layers,
              .operations = operations,
              .arcs = static_cast<double>(order.arcs.size()),
              .collisions = static_cast<double>(order.collisions.size()),
              .pair_queries = static_cast<double>(order.stats.pair_queries),
              .reinsertions = static_cast<double>(order.stats.reinsertions),
              .sort_us = sort_us};
  double parts_in_groups = 0.0;
  for (std::size_t i = 0; i < order.groups(); ++i) {
    if (i == order.depth_buffered) {
      continue;
    }
    const auto size = static_cast<double>(order.group(i).size());
    frame.largest = std::max(frame.largest, size);
    if (size > 1.0) {
      frame.grouped += 1.0;
      parts_in_groups += size;
    }
  }
  if (frame.groups > 0.0) {
    frame.grouped_share = frame.grouped / frame.groups;
    frame.parts_in_groups_share =
        parts_in_groups / (static_cast<double>(order.parts.size()) - frame.depth_buffered);
    frame.grouped_size = frame.grouped > 0.0 ? parts_in_groups / frame.grouped : 0.0;
  }
  frames_.push_back(frame);
}

double LayerTotals::mean(double Frame::*value) const {
  double sum = 0.0;
  for (const Frame& frame : frames_) {
    sum += frame.*value;
  }
  return frames_.empty() ? 0.0 : sum / static_cast<double>(frames_.size());
}

double LayerTotals::largest(double Frame::*value) const {
  double max = 0.0;
  for (const Frame& frame : frames_) {
    max = std::max(max, frame.*value);
  }
  return max;
}

double LayerTotals::largestAfterFirst(double Frame::*value) const {
  if (frames_.size() < 2) {
    return largest(value);
  }
  double max = 0.0;
  for (std::size_t i = 1; i < frames_.size(); ++i) {
    max = std::max(max, frames_[i].*value);
  }
  return max;
}

void LayerTotals::keepFaster(const LayerTotals& again) {
  for (std::size_t i = 0; i < std::min(frames_.size(), again.frames_.size()); ++i) {
    frames_[i].sort_us = std::min(frames_[i].sort_us, again.frames_[i].sort_us);
  }
}

double LayerTotals::meanGroupedSize() const {
  double parts = 0.0, groups = 0.0;
  for (const Frame& frame : frames_) {
    parts += frame.grouped * frame.grouped_size;
    groups += frame.grouped;
  }
  return groups > 0.0 ? parts / groups : 0.0;
}

}  // namespace sightline::tool
