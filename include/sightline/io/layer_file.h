#pragma once

// Files of layers: a picture and the layers that it was composited from, each with opacity and depths, as
// programs for compositing read them.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sightline/base/result.h"

namespace sightline {

// One picture of a file, cropped to a rectangle of the whole, rows from the top.
struct FileLayer {
  std::string name{};                   // any text; the file has only one picture of each name
  std::uint32_t left = 0, top = 0;      // where the rectangle begins, in pixels of the whole
  std::uint32_t width = 0, height = 0;  // its size; 0: transparent everywhere
  std::vector<float> rgba{};            // 4 * width * height: linear light, times opacity
  std::vector<float> depths{};          // width * height, metres; empty: none are written
};

// Crops a picture of width * height pixels to what is not transparent.
// rgba: 4 * width * height. depths: width * height, or empty.
FileLayer croppedLayer(std::string name, std::uint32_t width, std::uint32_t height,
                       std::span<const float> rgba, std::span<const float> depths);

// Writes an OpenEXR file with a part for each layer: channels R, G, B and A, and Z for depths, all of 32 bits
// and exactly the given values.
// layers: at least one; the first one is what programs show that read a single picture. description: text
// (JSON, say) for the attribute "sightline" of the first part.
// Errors: no layers; a size of 0 or above 2^15; a layer outside the picture or with the wrong number of
// values; a name twice; the file cannot be written; the library was built without OpenEXR.
Result<void> writeLayerFile(const std::string& file, std::uint32_t width, std::uint32_t height,
                            std::span<const FileLayer> layers, const std::string& description);

}  // namespace sightline
