#pragma once

// The exact shape of a box's image: its outline, and how near it is at each place of the buffer.

#include <cstdint>

#include "sightline/math/box.h"
#include "src/scene/pixel_view.h"

namespace sightline::occlusion {

// A function of the pixels x, y from a place of the buffer: along_x x + along_y y + at_origin, rounded up.
struct PixelFunction {
  float along_x = 0.0f, along_y = 0.0f, at_origin = 0.0f;
};

struct BoxOutline {
  // Each is >= 0 within the convex hull of the box's image: the plane through the eye and an edge between a
  // face that is seen and one that is not.
  PixelFunction edges[6];
  std::uint32_t edge_count = 0;  // up to 6; functions that are too large are left out
  // Planes of the faces that are seen. Where a ray intersects the box, no point of it before the eye has a
  // greater reciprocal depth than the least of these.
  PixelFunction faces[3];
  std::uint32_t face_count = 0;
};

// Returns the outline of a well-formed box, as far as it lies before the eye. Functions are of pixels from
// (x, y). They are upper bounds, with all rounding of their evaluation in single precision, up to `reach`
// pixels from there along each axis.
BoxOutline outlineOf(const PixelView& view, const Box& box, std::uint32_t x, std::uint32_t y, double reach);

}  // namespace sightline::occlusion
