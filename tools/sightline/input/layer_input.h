#pragma once

// Loads what layers are sorted from: parts that may move, and a camera path.

#include <span>
#include <string>
#include <vector>

#include "scenes/moving_scene.h"
#include "tools/sightline/command_line/options.h"
#include "tools/sightline/input/load.h"

namespace sightline::tool {

struct LayerInput {
  MovingScene moving;  // if the scene does not move, each object is a static part of one hull or of pieces
  Walk walk;
};

// The parts, by index, that are drawn behind or in front of all others.
struct LayerPlaces {
  std::vector<std::uint32_t> backdrops, overlays;
};

// How objects of a scene that does not move become parts.
struct LayerDivision {
  std::uint32_t max_pieces = 1;  // hulls of each object, at most; 1: its hull
  // Metres: opaque objects that are wider are cut by a grid of this width into overlapping parts first; 0:
  // none is.
  double split_width = 0.0;
  double split_overlap = 0.2;  // of neighbours, as a fraction of the width
};

// Loads a scene and a walk. If the scene moves, frame i of the walk shows frame i of the motion; a camera
// path of the user's own may be longer than the motion. Parts of objects that are cut are numbered anew.
Result<LayerInput> loadLayerInput(const std::string& scene_name, const PathOptions& path,
                                  const LayerPlaces& places = {}, const LayerDivision& division = {});

}  // namespace sightline::tool
