#pragma once

// The legend below a picture whose colours are depths.

#include <cstdint>
#include <span>
#include <string>

#include "sightline/io/image.h"
#include "tools/sightline/report/depth_colors.h"

namespace sightline::tool {

// 0.35 -> "0.35 m", 7.25 -> "7.3 m", 310.4 -> "310 m", 12000 -> "12 km"
std::string depthText(double metres);

// Returns the picture with a strip below it: a bar of each ramp, one above the other, the nearest depth at
// the left, and round depths in metres. Letters grow with the width, from 480 pixels on.
Image withDepthLegend(const Image& picture, const DepthScale& scale,
                      std::span<const std::span<const DepthColor>> ramps);

}  // namespace sightline::tool
