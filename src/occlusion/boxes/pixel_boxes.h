#pragma once

// Projects boxes and points into a depth buffer, many at once.

#include <cstdint>
#include <span>

#include "sightline/math/box.h"
#include "sightline/occlusion/depth_pyramid.h"
#include "src/scene/pixel_view.h"

namespace sightline::occlusion {

enum class BoxPlace : std::uint8_t {
  kOutside,    // wholly off the buffer, before the near plane or beyond the far plane
  kUnbounded,  // reaches the near plane, or is not well formed: no rectangle is known
  kOnBuffer,   // some of it may lie on the buffer; its rectangle is known
};

// A box's image, rounded outwards: every point of the box that lies within the view's volume projects into
// the rectangle, and none is nearer than `nearest` or farther than `farthest`.
struct PixelBox {
  BoxPlace place = BoxPlace::kUnbounded;
  bool whole = false;  // all of it surely lies within the view's volume
  // First and last pixels, cut at the buffer's borders; for kOnBuffer.
  std::uint16_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  float nearest = 0.0f, farthest = 0.0f;  // reciprocal depth, see PixelView; for kOnBuffer
  friend bool operator==(const PixelBox&, const PixelBox&) = default;

  BoxAnswer answer(Visibility visibility) const {
    return {visibility, whole, place == BoxPlace::kOnBuffer, static_cast<std::uint16_t>((x0 + x1) / 2),
            static_cast<std::uint16_t>((y0 + y1) / 2)};
  }
};

// The image of a point.
struct PointImage {
  static constexpr std::int32_t kUnknown = -1;

  // The pixel in which it surely lies. Both are kUnknown for a point that may be outside the view, or whose
  // pixel rounding leaves in doubt.
  std::int32_t x = kUnknown, y = kUnknown;
  float farthest = 0.0f;  // at most its reciprocal depth, see PixelView
  friend bool operator==(const PointImage&, const PointImage&) = default;
};

// What the projection of boxes needs of a view and the size of a buffer, computed once a view.
struct BoxProjection {
  // A direction, or the normal of a plane through the eye, rounded to single precision.
  struct Axis {
    float x = 0.0f, y = 0.0f, z = 0.0f;
  };

  BoxProjection() = default;  // every box is kUnbounded
  BoxProjection(const scene::PixelView& view, std::uint32_t width, std::uint32_t height);

  bool usable = false;  // finite, and of sizes that cannot overflow
  bool orthographic = false;
  Axis eye_high, eye_low;  // their sum is the eye
  Axis right, up, forward;
  Axis sides[4];           // planes of the view's volume through the eye, normals inwards; perspective
  float side_size = 0.0f;  // a bound of the length of these normals
  float near_min = 0.0f, near_max = 0.0f, far_min = 0.0f, far_max = 0.0f;  // rounded down and up
  float scale_x = 0.0f, scale_y = 0.0f, middle_x = 0.0f, middle_y = 0.0f;  // see PixelView
  float width = 0.0f, height = 0.0f;
  float eye_rounding = 0.0f;  // bound of the error of a coordinate relative to the eye, metres
};

// images: as many as boxes. Every instruction set gives the same bits.
void projectBoxes(const BoxProjection& projection, std::span<const Box> boxes, std::span<PixelBox> images);
void projectBoxes(const scene::PixelView& view, std::uint32_t width, std::uint32_t height,
                  std::span<const Box> boxes, std::span<PixelBox> images);
// images: as many as points. Every instruction set gives the same bits.
void projectPoints(const BoxProjection& projection, std::span<const Vec3f> points,
                   std::span<PointImage> images);

}  // namespace sightline::occlusion
