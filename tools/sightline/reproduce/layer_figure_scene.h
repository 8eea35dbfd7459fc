#pragma once

// Sorted frames that figures are drawn from, and the collection of their pictures.

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
  std::vector<Mat4> scene_from_stored;  // one for each part
};
// Sorts one frame of the scene for a picture of this aspect.
FigureFrame sortedFrame(const MovingScene& scene, const LayerSettings& settings, std::uint32_t frame,
                        double aspect);

// A renderer without tints, so that colours in figures differ only where they mean something.
Result<LayerRenderer> figureRenderer(const Scene& scene, const LayerFigureOptions& options, double aspect);

// A picture that is white where the two are equal and darker the more they differ. Precondition: equal sizes.
Image differenceStrength(const Image& a, const Image& b);

// Collects the pictures of one figure under its heading.
class FigurePictures {
 public:
  FigurePictures(std::uint32_t figure, std::string heading, LayerFigures& figures)
      : figure_(figure), heading_(std::move(heading)), figures_(figures) {}

  void add(const std::string& name, const std::string& caption, const LayerImage& picture) {
    add(name, caption, toImage(picture));
  }
  void add(const std::string& name, const std::string& caption, Image picture);
  // Adds a picture of where the two differ. The caption begins with `what` and tells by how much.
  PictureDifference addDifference(const std::string& name, const std::string& what, const LayerImage& a,
                                  const LayerImage& b, int decimals = 3);
  void addSvg(const std::string& name, const std::string& caption, std::string svg);

 private:
  void addPicture(const std::string& file, const std::string& caption);

  std::uint32_t figure_;
  std::string heading_;
  LayerFigures& figures_;
};

// Adds figure 23 and the figure of saved rendering.
Status canyonFigures(const LayerFigureOptions& options, LayerFigures& figures);

}  // namespace sightline::tool
