#pragma once

// The exact shape of a box's image: its outline, and how near it is at each place of the map.

#include <cstdint>

#include "sightline/math/box.h"
#include "src/scene/pixel_view.h"

namespace sightline::occlusion {

// x, y pixels from a place of the map -> along_x x + along_y y + at_origin, rounded up.
struct MapFunction {
  float along_x = 0.0f, along_y = 0.0f, at_origin = 0.0f;
};

struct BoxOutline {
  // Within the convex hull of the box's image every one is >= 0: an edge between a face that is seen and one
  // that is not, with the eye.
  MapFunction edges[6];
  std::uint32_t edge_count = 0;  // 4 or 6; 0: no outline is known
  // Where a ray meets the box, its reciprocal depth there is the least of these: the planes of the faces that
  // are seen.
  MapFunction faces[3];
  std::uint32_t face_count = 0;
};

// Of a well-formed box that lies beyond the near plane. Functions are of pixels from (x, y), and bound what
// they say, with all rounding of their evaluation in single precision, up to `reach` pixels from there along
// each axis.
BoxOutline outlineOf(const PixelView& view, const Box& box, std::uint32_t x, std::uint32_t y, double reach);

}  // namespace sightline::occlusion
