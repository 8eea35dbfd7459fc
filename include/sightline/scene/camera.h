#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sightline/base/result.h"
#include "sightline/math/frustum.h"
#include "sightline/math/mat4.h"
#include "sightline/math/vec3.h"

namespace sightline {

// One viewpoint with its projection, scene space. The camera looks along forward. See validate().
struct View {
  Vec3d eye{};
  Vec3d right{}, up{}, forward{};  // orthonormal, right-handed: forward = up x right
  bool orthographic = false;
  double tan_half_fovy = 0.5;  // perspective: tangent of half the vertical angle of view
  double ortho_height = 10.0;  // orthographic: metres from the lower to the upper border
  double aspect = 16.0 / 9.0;  // width / height
  double near = 0.1;           // metres along forward, >= 0
  double far = 1000.0;         // metres along forward, > near; may be infinite
};

// The view as the library takes it: axes of other lengths become unit vectors, and a left-handed basis is
// mirrored (right becomes -right), which leaves what is visible as it is. An error names the member that
// makes no view and what it must be: something is not finite, an axis is zero, axes are not perpendicular
// (beyond what single precision does to them), the angle of view, height or aspect is not positive, near is
// negative, or far is not beyond near. All that takes a view does this by itself, and with a view that is in
// error calls everything visible; so this is for those who want to know.
Result<View> validate(const View& view);

// right and up from any forward and up hint, also when they are parallel.
void setOrientation(View& view, const Vec3d& forward, const Vec3d& up_hint);

// OpenGL's clip space: x, y, z in [-w, w], z = -w on the near plane. The view must be one that validate()
// accepts. With far infinite, points at infinity have z = w; an orthographic depth buffer then, or any with
// near = 0, tells no depths apart.
Mat4 clipFromScene(const View& view);

// The six planes of the view's visible volume, scene space. Of a view that validate() refuses: planes that
// hold all of space.
Frustum frustumOf(const View& view);

// How far from the eye the farthest point lies that the near plane of a perspective view clips away: a corner
// of it. Metres, rounded up. Of an orthographic view: infinite, since its rays start anywhere.
double nearDistance(const View& view);

struct CameraFrame {
  Vec3d eye{};      // world space
  Vec3d forward{};  // any length > 0
  Vec3d up{};       // hint, any length
};

// A camera with one viewpoint a frame; the JSON form "path". World space.
struct CameraPath {
  std::string name{};
  double fovy_deg = 60.0;                    // perspective, when ortho_height is 0
  double ortho_height = 0.0;                 // metres; > 0 makes the camera orthographic
  std::uint32_t width = 1280, height = 720;  // pixels
  double near = 0.1, far = 2000.0;           // metres
  std::vector<CameraFrame> frames{};

  // The view of one frame in the space of a scene with this origin.
  View view(std::size_t frame, const Vec3d& scene_origin) const;
};

}  // namespace sightline
