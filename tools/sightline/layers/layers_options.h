#pragma once

// The options of `layers`.

#include <cstdint>
#include <string>

#include "tools/sightline/command_line/options.h"
#include "tools/sightline/layers/layer_drawings.h"
#include "tools/sightline/layers/layer_eyes.h"
#include "tools/sightline/layers/layer_frames.h"
#include "tools/sightline/layers/layer_lens.h"
#include "tools/sightline/layers/layer_pictures.h"
#include "tools/sightline/layers/layer_sort_options.h"

namespace sightline::tool {

struct LayersOptions {
  SceneOptions common;
  PathOptions path;
  LayerPlaces places;
  LayerDivision division;
  std::uint32_t split_cycles = 0;  // pieces of parts in cycles, at most; 0: parts stay whole
  std::string parts;               // a name of kPartChoices; empty: chosen by partChoiceOf()
  LayerSortOptions sort;
  LayerEyeOptions eyes;
  std::string tints = "on";
  bool no_times = false;
  PictureOptions size;
  std::uint32_t samples = 1;
  LayerPictureOptions pictures;
  LayerLensOptions lens;
  LayerDrawingOptions drawings;
};

}  // namespace sightline::tool
