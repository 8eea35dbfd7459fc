#pragma once

// `layers --split-cycles`: parts in cycles, divided by planes while the walk goes on.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/layers/cycle_splitter.h"
#include "sightline/render/layer_renderer.h"
#include "tools/sightline/layers/layer_eyes.h"
#include "tools/sightline/layers/layer_frames.h"

namespace sightline::tool {

// The pieces of a sorted frame as a renderer draws them; empty if nothing is divided.
// scene_from_part: one rigid transform per part; empty: parts are in scene space.
std::vector<ObjectPiece> objectPieces(std::span<const PartPiece> pieces,
                                      std::span<const Mat4> scene_from_part);

// Sorts the frames of a walk as EyeSorter does, with parts divided.
class CycleWalk {
 public:
  // fixed: parts that stay whole. triangles: whether pieces take the hulls of their triangles, as the parts
  // of a scene that does not move may.
  CycleWalk(const LayerEyeOptions& eyes, const LayerLensOptions& lens, const LayerInput& input,
            const LayerSettings& settings, std::uint32_t max_pieces, const std::vector<std::uint32_t>& fixed,
            bool triangles);
  CycleWalk(const CycleWalk&) = delete;  // the splitter has the address of the sorter

  void place(std::uint32_t frame, const View& view) { sorter_.place(frame, view); }
  const LayerOrder& sort(const View& view) { return splitter_.update(view, sorter_.moreEyes()); }
  std::span<const PartPiece> pieces() const { return splitter_.pieces(); }
  // Keeps the figures of the frame last sorted and returns them: the key "split" of a frame.
  Json figures(const LayerOrder& whole, const LayerOrder& divided, double split_us);
  void print() const;

 private:
  struct Frame {
    double largest_whole = 0.0, largest = 0.0, most_parts = 0.0, grouped_whole = 0.0, grouped = 0.0;
    double divided = 0.0, pieces = 0.0, cuts = 0.0, joins = 0.0, trials = 0.0, split_us = 0.0;
  };
  double mean(double Frame::*value) const;

  EyeSorter sorter_;
  CycleSplitter splitter_;
  std::vector<Frame> frames_;
};

}  // namespace sightline::tool
