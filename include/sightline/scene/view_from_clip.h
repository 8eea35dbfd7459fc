#pragma once

// Views of programs that have matrices instead.

#include <cstdint>

#include "sightline/base/result.h"
#include "sightline/math/mat4.h"
#include "sightline/math/plane.h"
#include "sightline/scene/camera.h"

namespace sightline {

// z / w on the near and on the far plane.
enum class ClipDepth : std::uint8_t {
  kMinusOneToOne,  // OpenGL
  kZeroToOne,      // Direct3D, Vulkan, Metal
  kOneToZero,      // reversed depth with these
};

struct ClipSpace {
  ClipDepth depth = ClipDepth::kMinusOneToOne;
  bool y_down = false;  // Vulkan: y = -w at the upper border of the picture
  // Greater than 0: the distance of the near plane, as View::z_near has it, so in the units of the space that
  // the matrix takes, also where a view matrix scales. viewFromClip() refuses a perspective matrix whose near
  // plane is more than 1 % off, as it is where `depth` is wrong. Has no effect on orthographic matrices, nor
  // in obliqueViewFromClip().
  double z_near = 0.0;
};

// Returns the view of a projection matrix times a view matrix:
// `viewFromClip(clip_from_view * view_from_scene, {...})`. The matrix transforms points of scene space, or of
// world space, in which the view then is, given as columns (see Mat4), to clip space, where a point is inside
// if |x| <= w, |y| <= w, and z is between its values on the near and on the far plane. Perspective and
// orthographic, off-centre and jittered projections are views, also with an infinite far distance, of either
// handedness, and with a view matrix that scales. Without y_down a matrix of Vulkan gives the same frustum,
// with the view upside down.
//
// The matrix is taken as exact; so are matrices of single precision. The sides of the frustum are those of
// the matrix to within 1e-12 of the distance from the eye and of the eye's coordinates. The far plane is
// where the depth range of the matrix ends. Rounding in the matrix tilts it, by the more the larger z_far /
// z_near is; z_far is the depth of its farthest corner, known to a fraction of 1e-15 (z_far + |eye|) / z_near
// of itself, and infinite where a corner lies at infinity or beyond. That the near plane is tilted, by less
// than 1e-6, is left out of account. In an orthographic view the matrix does not tell where the eye is: it is
// put on the middle of the near plane, so that z_near and both shifts are 0. Otherwise the result is the
// inverse of clipFromScene().
//
// Give the right ClipSpace::depth: only planes in the wrong order are noticed. With a wrong one the view has
// another near plane. A matrix of OpenGL that is read as kZeroToOne has it about twice as far away, and
// objects before it are culled although they are visible; a matrix of Direct3D that is read as
// kMinusOneToOne has it nearer, and what the program's near plane clips hides what is behind it. With
// ClipSpace::z_near that is an error of a perspective matrix; nothing notices it in an orthographic one. A
// wrong y_down only turns the view upside down.
//
// The error says what is wrong: the matrix is not finite or not a projection, the near plane is tilted
// (oblique) or not in front of the eye, the planes are in the other order, borders of the picture are not at
// right angles, or validate() rejects the view.
Result<View> viewFromClip(const Mat4& clip_from_scene, const ClipSpace& clip_space);

// A perspective view whose near plane is tilted, as those of mirrors and portals are.
struct ObliqueView {
  View view{};         // z_near: of the nearest point that is drawn; z_far: infinite
  Plane near_plane{};  // unit normal, towards what is drawn; in the space of the view
};

// The same for such a matrix (E. Lengyel. Oblique View Frustum Depth Projection and Clipping. Journal of Game
// Development 1, 2005). Its far plane, which follows from the near plane and is of no use, is left out. Where
// the eye is on the drawn side of the near plane, view.z_near is 0, and hardly anything can hide.
//
//   culler.setClipPlane(oblique->near_plane);  // a WorldCuller
//   culler.cull(world, oblique->view);
Result<ObliqueView> obliqueViewFromClip(const Mat4& clip_from_scene, const ClipSpace& clip_space);

}  // namespace sightline
