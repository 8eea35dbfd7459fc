#pragma once

// The difference of two pictures of a frame as JSON, text and picture.

#include <string>

#include "sightline/base/result.h"
#include "sightline/render/layer_image.h"
#include "tools/sightline/command_line/json_output.h"

namespace sightline::tool {

// Difference, of 255, above which a pixel counts as different; see measureDifference().
inline constexpr double kDifferenceTolerance = 4.0;

Json differenceJson(const PictureDifference& difference);
std::string differenceText(const PictureDifference& difference);
// Writes a PNG file with our picture, theirs, and their difference side by side.
Status writeComparison(const LayerImage& ours, const LayerImage& theirs, const std::string& file);

}  // namespace sightline::tool
