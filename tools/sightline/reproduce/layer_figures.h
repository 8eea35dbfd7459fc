#pragma once

// The figures of Snyder and Lengyel 1997 that are pictures: 16 and 22 (depth of field), 17 (hidden lines), 23
// (the canyon from layers), and one that the paper has no room for: saved rendering.

#include <cstdint>
#include <vector>

#include "tools/sightline/reproduce/reproduction.h"

namespace sightline::tool {

struct LayerFigureOptions {
  std::uint32_t height = 400;  // of the pictures, pixels
  std::uint32_t samples = 2;   // LayerRendererOptions::samples
  std::uint32_t passes = 21;   // of the accumulation that pictures are compared with
  std::uint32_t toothpicks = 800;
  std::uint32_t reused_frames = 20;  // through which images of layers are kept, for the last one's picture
};

// The options of `reproduce`: small pictures where it asks for few frames and no height.
LayerFigureOptions layerFigureOptions(const ReproduceOptions& options);

struct LayerFigures {
  std::vector<Experiment> experiments{};
  std::vector<ReportPicture> pictures{};
  std::vector<ReportFile> files{};  // of the pictures
};

// Figure 17, as SVG: table "hidden_lines".
LayerFigures hiddenLineFigure(const LayerFigureOptions& options);

// Figures 16, 17 (shaded), 22 and 23, and saved rendering: table "depth_of_field". Errors: pictures cannot be
// made on this machine.
Result<LayerFigures> layerFigures(const LayerFigureOptions& options);

}  // namespace sightline::tool
