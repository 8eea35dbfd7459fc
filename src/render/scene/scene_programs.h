#pragma once

// The programs that draw the scene, and the uniforms that place a view.

#include <epoxy/gl.h>

#include <array>

#include "sightline/base/result.h"
#include "sightline/math/box.h"
#include "sightline/math/mat4.h"
#include "sightline/render/layer_renderer.h"
#include "sightline/scene/camera.h"

namespace sightline::render {

// Texture units of what the programs read.
inline constexpr GLint kColorsUnit = 0, kPlacesUnit = 1, kBehindUnit = 2;

// A program made of a vertex shader of the scene's and some way to colour.
struct SceneProgram {
  GLuint id = 0;
  GLint clip_from_relative = -1, eye_high = -1, eye_low = -1, lens_offset = -1, haze = -1, depth_scale = -1;
};
// vertex: the scene's vertex shader where none is given.
Result<SceneProgram> makeSceneProgram(const char* name, const char* fragment, const char* geometry = nullptr,
                                      const char* vertex = nullptr);

// From the eye to the lens point, scene space.
Vec3d lensOffset(const View& view, const LensPoint& lens);
// Clip space with depth in [0, w], w on the near plane, from positions relative to the lens point.
Mat4 reversedClipFromRelative(const View& view, const LensPoint& lens);

// Makes the program current and places the view; haze is 1 / (distance of half the haze)^2.
// Everything is pushed away by about 1 - depth_scale of its distance.
void useProgram(const SceneProgram& program, const View& view, float haze, float depth_scale = 1.0f,
                const LensPoint& lens = {});

// Half of the haze at 1.5 times the scene's diagonal, but never nearer than 60 metres.
float hazeFor(const Box& bounds);

// The sky fills the picture before anything else is drawn.
struct SkyProgram {
  GLuint id = 0, vertex_array = 0;
  GLint forward = -1, right = -1, up = -1;
};
Result<SkyProgram> makeSkyProgram(const char* fragment);
// To the current frame buffer, without depth.
void drawSkyBehind(const SkyProgram& sky, const View& view);

// Depth from 1 (near plane) to 0 (far plane), the nearest drawn; clears colour and depth.
void beginPicture(GLuint framebuffer, std::uint32_t width, std::uint32_t height,
                  const std::array<float, 4>& background);

}  // namespace sightline::render
