#pragma once

// The figures of Snyder and Lengyel 1997 that are pictures: 16 and 22 (depth of field), 17 (hidden lines) and
// 23 (the canyon from layers), and a figure of saved rendering, which the paper lacks.

#include <cstdint>
#include <vector>

#include "tools/sightline/reproduce/reproduction.h"

namespace sightline::tool {

struct LayerFigureOptions {
  std::uint32_t height = 400;  // of the pictures, in pixels
  std::uint32_t samples = 2;   // LayerRendererOptions::samples
  std::uint32_t passes = 21;   // of the accumulated reference pictures
  std::uint32_t toothpicks = 800;
  std::uint32_t reused_frames = 20;  // frames over which images of layers are reused; the last one is shown
};

// The options for those of `reproduce`: small pictures if these ask for few frames and no height.
LayerFigureOptions layerFigureOptions(const ReproduceOptions& options);

struct LayerFigures {
  std::vector<Experiment> experiments{};
  std::vector<Finding> findings{};  // about pictures that have no table
  std::vector<ReportPicture> pictures{};
  std::vector<ReportFile> files{};  // of the pictures
};

// Figure 17 as SVG, with the table "hidden_lines".
LayerFigures hiddenLineFigure(const LayerFigureOptions& options);

// Figures 16, 17 (shaded), 22 and 23 and saved rendering, with the table "depth_of_field". Error if this
// machine cannot draw pictures.
Result<LayerFigures> layerFigures(const LayerFigureOptions& options);

}  // namespace sightline::tool
