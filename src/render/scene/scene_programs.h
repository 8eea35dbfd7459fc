#pragma once

// The programs that draw the scene, and the uniforms that place a view.

#include <epoxy/gl.h>

#include <array>
#include <span>

#include "sightline/base/result.h"
#include "sightline/math/box.h"
#include "sightline/math/mat4.h"
#include "sightline/render/layer_renderer.h"
#include "sightline/scene/camera.h"

namespace sightline::render {

// The texture units of the buffers and pictures that the programs read.
inline constexpr GLint kColorsUnit = 0, kPlacesUnit = 1, kBehindUnit = 2;

// A linked program of a vertex shader for the scene and a fragment shader, with its uniforms.
struct SceneProgram {
  GLuint id = 0;
  GLint clip_from_relative = -1, eye_high = -1, eye_low = -1, lens_offset = -1, haze = -1, normal_sign = -1,
        depth_scale = -1;
  GLint cut_count = -1, cut_fronts = -1, cuts = -1;  // of layers: see setSides()
};
// vertex is kSceneVertex if none is given.
Result<SceneProgram> makeSceneProgram(const char* name, const char* fragment, const char* geometry = nullptr,
                                      const char* vertex = nullptr);

// The views given to the functions below have axes of unit length.

// The vector from the eye to the lens point in scene space.
Vec3d lensOffset(const View& view, const LensPoint& lens);
// Takes positions relative to the lens point to clip space. Depth lies in [0, w], w on the near plane.
Mat4 reversedClipFromRelative(const View& view, const LensPoint& lens);

// Makes the program current and sets the view's uniforms, and glFrontFace: fronts are counter-clockwise, and
// clockwise in the mirrored picture of a left-handed view. haze is 1 / d^2, where d is the distance in metres
// at which haze is half. Everything is moved away from the eye by about 1 - depth_scale of its distance.
void useProgram(const SceneProgram& program, const View& view, float haze, float depth_scale = 1.0f,
                const LensPoint& lens = {});

// Sets on which sides of planes (scene space, at most kMaxPieceSides) the current program draws; none: on
// all.
void setSides(const SceneProgram& program, const View& view, const LensPoint& lens,
              std::span<const PieceSide> sides);

// The haze for which d is 1.5 times the scene's diagonal, or 60 metres if that is more.
float hazeFor(const Box& bounds);

// The program that fills the picture with the sky before anything else is drawn.
struct SkyProgram {
  GLuint id = 0, vertex_array = 0;
  GLint forward = -1, right = -1, up = -1;
};
Result<SkyProgram> makeSkyProgram(const char* fragment);
// Draws the sky to the current frame buffer without writing depth.
void drawSkyBehind(const SkyProgram& sky, const View& view);

// Binds the frame buffer, clears colour and depth, and sets the depth test: depth runs from 1 at the near
// plane to 0 at the far plane, and the greatest is drawn.
void beginPicture(GLuint framebuffer, std::uint32_t width, std::uint32_t height,
                  const std::array<float, 4>& background);

}  // namespace sightline::render
