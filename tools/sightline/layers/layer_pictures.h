#pragma once

// `layers --image`, `--layer-file` and `--by-distance`: pictures composited from layers, and their difference
// from other methods.

#include <memory>
#include <string>
#include <vector>

#include "tools/sightline/layers/layer_frames.h"

namespace sightline::tool {

struct LayerPictureOptions {
  std::string image, by_distance, layer_file;  // files; empty: none
  std::string peel = "where-needed";
  std::vector<std::uint32_t> without;  // parts
  std::vector<std::string> replace;    // PART=FILE.png or PART=FILE_####.png

  bool operator==(const LayerPictureOptions&) const = default;
};
void addLayerPictureOptions(CLI::App& command, LayerPictureOptions& options);

Result<std::unique_ptr<FrameMaker>> makeLayerPictures(const LayerPictureOptions& options,
                                                      const FrameMakerInput& input);

}  // namespace sightline::tool
