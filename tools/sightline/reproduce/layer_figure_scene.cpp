#include "tools/sightline/reproduce/layer_figure_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace sightline::tool {

FigureFrame sortedFrame(const MovingScene& scene, const LayerSettings& settings, std::uint32_t frame,
                        double aspect) {
  FigureFrame sorted;
  sorted.view = scene.scene.paths.front().view(frame, scene.scene.origin);
  sorted.view.aspect = aspect;
  LayerSorter sorter = makeSorter(scene, settings);
  std::vector<Mat4> poses;
  pose(scene, frame, poses, sorter);
  LayerMerger merger;
  sorted.layers = merger.merge(sorter.update(sorted.view));
  placements(scene, frame, sorted.scene_from_stored);
  return sorted;
}

Result<LayerRenderer> figureRenderer(const Scene& scene, const LayerFigureOptions& options, double aspect) {
  return LayerRenderer::create(scene.view(),
                               {.width = static_cast<std::uint32_t>(std::lround(options.height * aspect)),
                                .height = options.height,
                                .samples = options.samples,
                                .tints = false});
}

Image differenceStrength(const Image& a, const Image& b) {
  constexpr int kGain = 4;  // makes a difference of 64 of 255 black
  Image result{a.width, a.height, std::vector<std::uint8_t>(a.rgba.size(), 255)};
  for (std::size_t pixel = 0; pixel < a.rgba.size(); pixel += 4) {
    int largest = 0;
    for (std::size_t channel = pixel; channel < pixel + 4; ++channel) {
      largest = std::max(largest, std::abs(int{a.rgba[channel]} - int{b.rgba[channel]}));
    }
    std::fill_n(&result.rgba[pixel], 3, static_cast<std::uint8_t>(255 - std::min(255, kGain * largest)));
  }
  return result;
}

void FigurePictures::add(const std::string& name, const std::string& caption, Image picture) {
  figures_.files.push_back({name + ".png", std::move(picture), {}});
  addPicture(name + ".png", caption);
}

PictureDifference FigurePictures::addDifference(const std::string& name, const std::string& what,
                                                const LayerImage& a, const LayerImage& b, int decimals) {
  const PictureDifference difference = measureDifference(a, b);
  add(name,
      fmt::format("{} {:.{}f} of 255 in the mean, {:.{}f} % of the pixels beyond 4", what, difference.mean,
                  decimals, 100.0 * difference.share_beyond, decimals - 1),
      differenceStrength(toImage(a), toImage(b)));
  return difference;
}

void FigurePictures::addSvg(const std::string& name, const std::string& caption, std::string svg) {
  figures_.files.push_back({name + ".svg", {}, std::move(svg)});
  addPicture(name + ".svg", caption);
}

void FigurePictures::addPicture(const std::string& file, const std::string& caption) {
  figures_.pictures.push_back({file, caption, figure_, false, heading_});
}

}  // namespace sightline::tool
