#pragma once

// `layers --svg` and `--pdf`: hidden-line drawings of frames.

#include <memory>
#include <string>

#include "sightline/drawing/feature_edges.h"
#include "tools/sightline/layers/layer_frames.h"

namespace sightline::tool {

struct LayerDrawingOptions {
  std::string svg, pdf, line_picture;  // files; empty: none
  bool plot = false;
  double crease_deg = 30.0;
  bool no_creases = false, no_silhouettes = false, no_boundaries = false;
  double stroke_width = 1.0;  // page units: pixels of the pictures, points in PDF

  bool operator==(const LayerDrawingOptions&) const = default;
};
void addLayerDrawingOptions(CLI::App& command, LayerDrawingOptions& options);

FeatureSettings featuresOf(const LayerDrawingOptions& options);
// Checks that no number is NaN and that some kind of line is to be drawn.
Status checkLines(const LayerDrawingOptions& options);

// Whether the sorter must find the arcs of all pairs (LayerArcs::kAll).
bool needAllArcs(const LayerDrawingOptions& options);

// Makes a hidden-line drawing of each frame. The page is as high as the pictures in pixels and has the view's
// aspect. Objects keep their names. Parts of a moving scene are drawn at their place in the frame.
Result<std::unique_ptr<FrameMaker>> makeLayerDrawings(const LayerDrawingOptions& options,
                                                      const FrameMakerInput& input);

}  // namespace sightline::tool
