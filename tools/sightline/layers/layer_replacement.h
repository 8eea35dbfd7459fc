#pragma once

// `layers --replace`: pictures from files in place of layers, one for all frames or one for each.

#include <cstdint>
#include <string>
#include <vector>

#include "sightline/io/image.h"
#include "sightline/render/layer_image.h"
#include "tools/sightline/input/layer_input.h"

namespace sightline::tool {

// A part's file, or its sequence of files, and the image that takes the layer's place in a frame.
struct LayerReplacementFile {
  std::uint32_t part = 0;
  std::string pattern;  // with a run of # for the frame's number, if it is a sequence
  std::string read_from;
  Image file;  // what read_from holds
  LayerImage image;

  // Reads the file of a frame, unless it has been read already.
  Status read(std::uint32_t frame);
  bool hasSize(std::uint32_t width, std::uint32_t height) const;
  // Puts the file into an image of its size.
  void fill(LayerImage& to) const;
  // Stretches the file over the rectangle of all pixels of an image that are not transparent, with the
  // nearest pixel for each, and makes the others transparent.
  void fitOver(LayerImage& to) const;
};

// Returns the file of a frame: the pattern with its run of # replaced by the frame's number, with zeros in
// front. A pattern without # is the file. So is one that names an existing file.
std::string replacementFile(const std::string& pattern, std::uint32_t frame);

// Converts a pixel of an sRGB picture to linear light, times opacity.
ShapedPixel linearPixel(const Image& image, std::uint32_t x, std::uint32_t y);

// Error if the scene has no such part.
Status checkPartNumber(const std::string& option, std::uint32_t part, std::size_t parts);

// Reads the texts of --replace. Checks that each frame's file is there, and reads those of the first frame.
// without: the parts of --without, which must not be replaced too.
Result<std::vector<LayerReplacementFile>> replacementFiles(const std::vector<std::string>& texts,
                                                           const std::vector<std::uint32_t>& without,
                                                           const LayerInput& input);

}  // namespace sightline::tool
