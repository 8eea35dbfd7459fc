#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sightline/math/frustum.h"
#include "sightline/math/mat4.h"
#include "sightline/math/vec3.h"

namespace sightline {

// One viewpoint with its projection, scene space. Right-handed; the camera looks along forward.
struct View {
  Vec3d eye;
  Vec3d right, up, forward;  // orthonormal
  bool orthographic = false;
  double tan_half_fovy = 0.5;  // perspective: tangent of half the vertical angle of view
  double ortho_height = 10.0;  // orthographic: metres from the lower to the upper border
  double aspect = 16.0 / 9.0;  // width / height
  double near = 0.1;           // metres along forward, > 0
  double far = 1000.0;         // metres along forward, > near
};

// right and up from any forward and up hint, also when they are parallel.
void setOrientation(View& view, const Vec3d& forward, const Vec3d& up_hint);

// OpenGL's clip space: x, y, z in [-w, w], z = -w on the near plane.
Mat4 clipFromScene(const View& view);

// The six planes of the view's visible volume, scene space.
Frustum frustumOf(const View& view);

// How far from the eye the farthest point lies that the near plane of a perspective view clips away: a corner
// of it. Metres, rounded up. Of an orthographic view: infinite, since its rays start anywhere.
double nearDistance(const View& view);

struct CameraFrame {
  Vec3d eye;      // world space
  Vec3d forward;  // any length > 0
  Vec3d up;       // hint, any length
};

// A camera with one viewpoint a frame; the JSON form "path". World space.
struct CameraPath {
  std::string name;
  double fovy_deg = 60.0;                    // perspective, when ortho_height is 0
  double ortho_height = 0.0;                 // metres; > 0 makes the camera orthographic
  std::uint32_t width = 1280, height = 720;  // pixels
  double near = 0.1, far = 2000.0;           // metres
  std::vector<CameraFrame> frames;

  // The view of one frame in the space of a scene with this origin.
  View view(std::size_t frame, const Vec3d& scene_origin) const;
};

}  // namespace sightline
