#pragma once

// The programs that draw the scene, and the uniforms that place a view.

#include <epoxy/gl.h>

#include <array>

#include "sightline/base/result.h"
#include "sightline/scene/camera.h"

namespace sightline {

// A program made of the scene's vertex shader and some way to colour.
struct SceneProgram {
  GLuint id = 0;
  GLint clip_from_relative = -1, eye_high = -1, eye_low = -1, haze = -1, depth_scale = -1;
};
Result<SceneProgram> makeSceneProgram(const char* name, const char* fragment, const char* geometry = nullptr);

// Makes the program current and places the view; haze is 1 / (distance of half the haze)^2.
// Everything is pushed away by about 1 - depth_scale of its distance.
void useProgram(const SceneProgram& program, const View& view, float haze, float depth_scale = 1.0f);

// Depth from 1 (near plane) to 0 (far plane), the nearest drawn; clears colour and depth.
void beginPicture(GLuint framebuffer, std::uint32_t width, std::uint32_t height,
                  const std::array<float, 4>& background);

}  // namespace sightline
