#pragma once

// How two pictures of a frame differ, as `layers` tells and shows it.

#include <string>

#include "sightline/base/result.h"
#include "sightline/render/layer_image.h"
#include "tools/sightline/methods/method_options.h"

namespace sightline::tool {

// Pixels count as different beyond it, of 255; see measureDifference.
inline constexpr double kDifferenceTolerance = 4.0;

Json differenceJson(const PictureDifference& difference);
std::string differenceText(const PictureDifference& difference);
// Ours, theirs, and where they differ, side by side, as a PNG file.
Status writeComparison(const LayerImage& ours, const LayerImage& theirs, const std::string& file);

}  // namespace sightline::tool
