#pragma once

// `layers --layer-file`: keeps the images of a frame's layers and the steps that composite them, and writes
// both to one file.

#include <cstdint>
#include <string>
#include <vector>

#include "sightline/io/layer_file.h"
#include "sightline/render/layer_compositor.h"
#include "tools/sightline/layers/layer_frames.h"

namespace sightline::tool {

class LayerRecorder {
 public:
  void beginFrame();
  // Keeps a group of the frame's layers; groups come front to back.
  void add(const CompositedGroup& group, const SortedFrame& frame, const std::vector<MovingPart>& parts);
  // Keeps the sky, which lies behind everything.
  void addSky(const LayerImage& sky);
  // Writes the picture and everything kept since beginFrame().
  Status write(const std::string& file, const SortedFrame& frame, const LayerImage& picture) const;

 private:
  // Makes the layer's steps part of the frame's program, with numbers from first_image on.
  void addSteps(std::span<const CompositingStep> steps, std::uint32_t first_image);
  void addImage(const std::string& name, const LayerImage& image, Json parts);

  std::vector<FileLayer> layers_;
  Json described_, program_;
};

}  // namespace sightline::tool
