#pragma once

// What layers are sorted from: parts that may move, along a camera's path.

#include <span>
#include <string>
#include <vector>

#include "scenes/moving_scene.h"
#include "tools/sightline/command_line/options.h"
#include "tools/sightline/input/load.h"

namespace sightline::tool {

struct LayerInput {
  MovingScene moving;  // of a scene that does not move: each object is a part, static, where it is
  Walk walk;
};

// backdrops, overlays: parts by number.
struct LayerPlaces {
  std::vector<std::uint32_t> backdrops, overlays;
};

// Where the scene moves, a frame of the walk is a frame of the motion; a path of the user's own may be
// longer.
Result<LayerInput> loadLayerInput(const std::string& scene_name, const PathOptions& path,
                                  const LayerPlaces& places = {});

}  // namespace sightline::tool
