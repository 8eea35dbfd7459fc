#pragma once

// Where boxes lie in a map of pixels, many at once.

#include <cstdint>
#include <span>

#include "sightline/math/box.h"
#include "sightline/occlusion/depth_pyramid.h"
#include "src/scene/pixel_view.h"

namespace sightline::occlusion {

enum class BoxPlace : std::uint8_t {
  kOutside,    // wholly off the map, before the near plane or beyond the far plane
  kUnbounded,  // reaches the near plane, or is not well formed: no rectangle is known
  kOnMap,      // some of it may lie on the map; its rectangle is known
};

// A box's image. Rounded outwards: every point of the box that lies within the view's volume projects into
// the rectangle, no point is nearer than `nearest` nor farther than `farthest`.
struct PixelBox {
  BoxPlace place = BoxPlace::kUnbounded;
  bool whole = false;  // all of it surely lies within the view's volume
  std::uint16_t x0 = 0, y0 = 0, x1 = 0,
                y1 = 0;                   // first and last pixels, cut at the map's borders; for kOnMap
  float nearest = 0.0f, farthest = 0.0f;  // reciprocal depth, see PixelView; for kOnMap
  friend bool operator==(const PixelBox&, const PixelBox&) = default;

  BoxAnswer answer(Visibility visibility) const {
    return {visibility, whole, place == BoxPlace::kOnMap, static_cast<std::uint16_t>((x0 + x1) / 2),
            static_cast<std::uint16_t>((y0 + y1) / 2)};
  }
};

// What the projection of boxes takes from a view and a map's size, made once a view.
struct BoxProjection {
  // A direction, or the normal of a plane through the eye, rounded to single precision.
  struct Axis {
    float x = 0.0f, y = 0.0f, z = 0.0f;
  };

  BoxProjection() = default;  // every box is kUnbounded
  BoxProjection(const PixelView& view, std::uint32_t width, std::uint32_t height);

  bool usable = false;  // finite, and of sizes that cannot overflow
  bool orthographic = false;
  Axis eye_high, eye_low;  // their sum is the eye
  Axis right, up, forward;
  Axis sides[4];           // planes of the view's volume through the eye, normals inwards; perspective
  float side_size = 0.0f;  // the largest normal's, at least
  float near_min = 0.0f, near_max = 0.0f, far_min = 0.0f, far_max = 0.0f;  // rounded down and up
  float scale_x = 0.0f, scale_y = 0.0f, middle_x = 0.0f, middle_y = 0.0f;  // see PixelView
  float width = 0.0f, height = 0.0f;
  float eye_rounding = 0.0f;  // metres that a coordinate relative to the eye may be off
};

// As many images as boxes. Every instruction set gives the same bits.
void projectBoxes(const BoxProjection& projection, std::span<const Box> boxes, std::span<PixelBox> images);
void projectBoxes(const PixelView& view, std::uint32_t width, std::uint32_t height,
                  std::span<const Box> boxes, std::span<PixelBox> images);

}  // namespace sightline::occlusion
