#include "scene_programs.h"

#include <array>

#include "gl_context.h"
#include "shaders.h"

namespace sightline {
namespace {

// Clip space with depth in [0, w], w on the near plane, from positions relative to the eye. In double
// precision the eye's translation cancels to rounding, so single precision never sees large coordinates.
std::array<float, 16> reversedClipFromRelative(const View& view) {
  Mat4 scene_from_relative;
  scene_from_relative(0, 3) = view.eye.x;
  scene_from_relative(1, 3) = view.eye.y;
  scene_from_relative(2, 3) = view.eye.z;
  Mat4 reverse;  // z' = (w - z) / 2
  reverse(2, 2) = -0.5;
  reverse(2, 3) = 0.5;
  const Mat4 clip_from_relative = reverse * (clipFromScene(view) * scene_from_relative);
  std::array<float, 16> m{};
  for (std::size_t i = 0; i < m.size(); ++i) {
    m[i] = static_cast<float>(clip_from_relative.m[i]);
  }
  return m;
}

}  // namespace

Result<SceneProgram> makeSceneProgram(const char* name, const char* fragment, const char* geometry) {
  const Result<GLuint> id = makeProgram(name, shaders::kSceneVertex, fragment, geometry);
  if (!id) {
    return id.error();
  }
  return SceneProgram{.id = *id,
                      .clip_from_relative = glGetUniformLocation(*id, "clip_from_relative"),
                      .eye_high = glGetUniformLocation(*id, "eye_high"),
                      .eye_low = glGetUniformLocation(*id, "eye_low"),
                      .haze = glGetUniformLocation(*id, "haze"),
                      .depth_scale = glGetUniformLocation(*id, "depth_scale")};
}

void useProgram(const SceneProgram& program, const View& view, float haze, float depth_scale) {
  const Vec3f high(view.eye);
  const Vec3f low(view.eye - Vec3d(high));
  glUseProgram(program.id);
  glUniformMatrix4fv(program.clip_from_relative, 1, GL_FALSE, reversedClipFromRelative(view).data());
  glUniform3f(program.eye_high, high.x, high.y, high.z);
  glUniform3f(program.eye_low, low.x, low.y, low.z);
  glUniform1f(program.haze, haze);
  glUniform1f(program.depth_scale, depth_scale);
}

void beginPicture(GLuint framebuffer, std::uint32_t width, std::uint32_t height,
                  const std::array<float, 4>& background) {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glViewport(0, 0, static_cast<GLsizei>(width), static_cast<GLsizei>(height));
  glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GREATER);
  glDepthMask(GL_TRUE);
  glDisable(GL_BLEND);
  glDisable(GL_CULL_FACE);
  glClearColor(background[0], background[1], background[2], background[3]);
  glClearDepth(0.0);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

}  // namespace sightline
