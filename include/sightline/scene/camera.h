#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sightline/base/result.h"
#include "sightline/math/frustum.h"
#include "sightline/math/mat4.h"
#include "sightline/math/vec3.h"

namespace sightline {

// A viewpoint with its projection, in the space of what is seen: scene space for a scene, so for a Culler,
// and world space for a World. The camera looks along `forward`. See validate().
struct View {
  Vec3d eye{};
  Vec3d right{}, up{}, forward{};  // orthonormal, right-handed: forward = up x right
  bool orthographic = false;
  double tan_half_fovy = 0.5;  // perspective: tangent of half the vertical angle of view
  // Orthographic: height of the view in metres, from the lower to the upper border.
  double ortho_height = 10.0;
  double aspect = 16.0 / 9.0;  // width / height
  // Where the middle of the picture lies off the forward axis: half widths to the right and half heights up,
  // at most kMaxShift. Both are 0 in a symmetric view. With 1, the axis is at the left or lower border of
  // the picture; beyond, outside of it. In the terms of glFrustum() and glOrtho(), shift_x is (right + left)
  // / (right - left), and shift_y is (top + bottom) / (top - bottom).
  double shift_x = 0.0, shift_y = 0.0;
  static constexpr double kMaxShift = 1000.0;
  double z_near = 0.1;    // metres along forward, >= 0
  double z_far = 1000.0;  // metres along forward, > z_near; may be infinite
};

// Returns the view as the library uses it: axes of other lengths are normalised, and a left-handed basis is
// mirrored (right becomes -right, shift_x becomes -shift_x), which does not change what is visible. The error
// names the invalid member and what it must be: a value is not finite, an axis is zero, axes are not
// perpendicular (beyond single-precision rounding), the angle of view, height or aspect is not positive, a
// shift is too large, z_near is negative, or z_far is not beyond z_near. All functions that take a view
// validate it themselves and treat everything as visible if it is invalid; call this to learn the reason.
Result<View> validate(const View& view);

// Sets right and up from any forward and up hint, even if they are parallel.
void setOrientation(View& view, const Vec3d& forward, const Vec3d& up_hint);

// OpenGL's clip space, from the view's own space: x, y, z in [-w, w], z = -w on the near plane. Of a view in
// world space this is clip_from_world. The view must be one that validate() accepts. If z_far is infinite,
// points at infinity have z = w. A depth buffer then cannot distinguish depths in an orthographic view; nor
// can it in any view with z_near = 0.
Mat4 clipFromScene(const View& view);

// The six frustum planes of the view, in its own space, each moved outwards by what the eye's coordinates
// round its offset and its normal by. What the normal's rounding is worth at a point beside it is left to
// those who test: classify() does. For a view that validate() rejects: planes that contain all of space.
Frustum frustumOf(const View& view);

// Maximum distance in metres from the eye to a point that the near plane of a perspective view clips (a
// corner of the near plane; the farthest one), rounded up. Infinite for an orthographic view, whose rays
// start anywhere, and for one that validate() rejects.
double nearDistance(const View& view);

struct CameraFrame {
  Vec3d eye{};      // world space
  Vec3d forward{};  // any length > 0
  Vec3d up{};       // approximate up direction, any length > 0
};

// A camera with one viewpoint per frame, in world space; stored in JSON as a camera path.
struct CameraPath {
  std::string name{};
  double fovy_deg = 60.0;                    // perspective only; used if ortho_height is 0
  double ortho_height = 0.0;                 // metres; > 0 makes the camera orthographic
  std::uint32_t width = 1280, height = 720;  // pixels
  double shift_x = 0.0, shift_y = 0.0;       // of each view, see View
  double z_near = 0.1, z_far = 2000.0;       // metres, finite
  std::vector<CameraFrame> frames{};

  // The view of one frame, in the scene space of a scene with this origin; with {}, in world space, as a
  // World needs it.
  View view(std::size_t frame, const Vec3d& scene_origin) const;
};

}  // namespace sightline
