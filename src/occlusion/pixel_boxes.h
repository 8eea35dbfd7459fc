#pragma once

// Where boxes lie in a map of pixels, many at once.

#include <cstdint>
#include <span>

#include "scene/pixel_view.h"
#include "sightline/math/box.h"

namespace sightline::occlusion_detail {

enum class BoxPlace : std::uint8_t {
  kOutside,    // wholly off the map, before the near plane or beyond the far plane
  kUnbounded,  // reaches the near plane, or is not well formed: no rectangle is known
  kOnMap,      // some of it may lie on the map; its rectangle is known
};

// A box's image. Rounded outwards: every point of the box that lies within the view's volume projects into
// the rectangle, no point is nearer than `nearest` nor, if `whole`, farther than `farthest`.
struct PixelBox {
  BoxPlace place = BoxPlace::kUnbounded;
  bool whole = false;  // all of it surely lies within the view's volume
  std::uint16_t x0 = 0, y0 = 0, x1 = 0,
                y1 = 0;                   // first and last pixels, cut at the map's borders; for kOnMap
  float nearest = 0.0f, farthest = 0.0f;  // nearness, see PixelView; for kOnMap
};

// As many images as boxes. Every instruction set gives the same bits.
void projectBoxes(const PixelView& view, std::uint32_t width, std::uint32_t height,
                  std::span<const Box> boxes, std::span<PixelBox> images);

}  // namespace sightline::occlusion_detail
