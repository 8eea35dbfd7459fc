#pragma once

// What the figures are drawn from, and how their pictures are kept.

#include <cstdint>
#include <string>
#include <vector>

#include "scenes/moving_scene.h"
#include "sightline/layers/compositing.h"
#include "sightline/render/layer_renderer.h"
#include "tools/sightline/reproduce/layer_figures.h"

namespace sightline::tool {

// A sorted frame of a moving scene.
struct FigureFrame {
  View view;
  FrameLayers layers;
  std::vector<Mat4> scene_from_stored;  // one a part
};
// aspect: of the picture.
FigureFrame sortedFrame(const MovingScene& scene, const LayerSettings& settings, std::uint32_t frame,
                        double aspect);

// Of pictures without tints by object: what figures colour differs by what they say.
Result<LayerRenderer> figureRenderer(const Scene& scene, const LayerFigureOptions& options, double aspect);

// Where the two differ, the darker the more; white where they do not. Of equal sizes.
Image differenceStrength(const Image& a, const Image& b);

// A figure's pictures, under its heading.
class FigurePictures {
 public:
  FigurePictures(std::uint32_t figure, std::string heading, LayerFigures& figures)
      : figure_(figure), heading_(std::move(heading)), figures_(figures) {}

  void add(const std::string& name, const std::string& caption, const LayerImage& picture) {
    add(name, caption, toImage(picture));
  }
  void add(const std::string& name, const std::string& caption, Image picture);
  // Where the two differ, and by how much: `what` begins the caption.
  PictureDifference addDifference(const std::string& name, const std::string& what, const LayerImage& a,
                                  const LayerImage& b, int decimals = 3);
  void addSvg(const std::string& name, const std::string& caption, std::string svg);

 private:
  void addPicture(const std::string& file, const std::string& caption);

  std::uint32_t figure_;
  std::string heading_;
  LayerFigures& figures_;
};

// Figure 23, and saved rendering.
Status canyonFigures(const LayerFigureOptions& options, LayerFigures& figures);

}  // namespace sightline::tool
