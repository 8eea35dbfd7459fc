#include "src/render/scene/scene_programs.h"

#include <algorithm>
#include <array>
#include <utility>

#include "src/render/context/gl_context.h"
#include "src/render/scene/shaders.h"
#include "src/scene/usable_view.h"

namespace sightline::render {
namespace {

// Shears what a lens point at the offset d sees: x' = x - d at depth z is drawn at x' + d * z / focus, which
// at the focus distance is x.
void shear(Mat4& clip_from_relative, const View& view, const LensPoint& lens) {
  const double half_height = view.orthographic ? 0.5 * view.ortho_height : view.tan_half_fovy;
  const double x = lens.right / lens.focus / (half_height * view.aspect);
  const double y = lens.up / lens.focus / half_height;
  for (int column = 0; column < 3; ++column) {
    clip_from_relative(0, column) += x * view.forward[column];
    clip_from_relative(1, column) += y * view.forward[column];
  }
}

std::array<float, 16> toFloats(const Mat4& matrix) {
  std::array<float, 16> m{};
  for (std::size_t i = 0; i < m.size(); ++i) {
    m[i] = static_cast<float>(matrix.m[i]);
  }
  return m;
}

void setTextureUnits(GLuint program) {
  const std::array<std::pair<const char*, GLint>, 3> units{
      {{"colors", kColorsUnit}, {"places", kPlacesUnit}, {"behind", kBehindUnit}}};
  for (const auto& [name, unit] : units) {
    if (const GLint location = glGetUniformLocation(program, name); location >= 0) {
      glProgramUniform1i(program, location, unit);
    }
  }
}

}  // namespace

Vec3d lensOffset(const View& view, const LensPoint& lens) {
  return view.right * lens.right + view.up * lens.up;
}

// Computed in double precision: the eye's translation cancels, so that single precision never sees large
// coordinates.
Mat4 reversedClipFromRelative(const View& view, const LensPoint& lens) {
  Mat4 scene_from_relative;
  scene_from_relative(0, 3) = view.eye.x;
  scene_from_relative(1, 3) = view.eye.y;
  scene_from_relative(2, 3) = view.eye.z;
  Mat4 reverse;  // maps z to (w - z) / 2
  reverse(2, 2) = -0.5;
  reverse(2, 3) = 0.5;
  Mat4 clip_from_relative = reverse * (clipFromScene(view) * scene_from_relative);
  if (lens.right != 0.0 || lens.up != 0.0) {
    shear(clip_from_relative, view, lens);
  }
  return clip_from_relative;
}

Result<SceneProgram> makeSceneProgram(const char* name, const char* fragment, const char* geometry,
                                      const char* vertex) {
  const Result<GLuint> id = makeProgram(name, vertex ? vertex : kSceneVertex, fragment, geometry);
  if (!id) {
    return id.error();
  }
  setTextureUnits(*id);
  return SceneProgram{.id = *id,
                      .clip_from_relative = glGetUniformLocation(*id, "clip_from_relative"),
                      .eye_high = glGetUniformLocation(*id, "eye_high"),
                      .eye_low = glGetUniformLocation(*id, "eye_low"),
                      .lens_offset = glGetUniformLocation(*id, "lens_offset"),
                      .haze = glGetUniformLocation(*id, "haze"),
                      .normal_sign = glGetUniformLocation(*id, "normal_sign"),
                      .depth_scale = glGetUniformLocation(*id, "depth_scale"),
                      .cut_count = glGetUniformLocation(*id, "cut_count"),
                      .cut_fronts = glGetUniformLocation(*id, "cut_fronts"),
                      .cuts = glGetUniformLocation(*id, "cuts")};
}

void useProgram(const SceneProgram& program, const View& view, float haze, float depth_scale,
                const LensPoint& lens) {
  const Vec3d offset = lensOffset(view, lens);
  const Vec3d eye = view.eye + offset;
  const Vec3f high(eye);
  const Vec3f low(eye - Vec3d(high));
  const Vec3f from_eye(offset);
  const bool mirrored = scene::isLeftHanded(view);
  glFrontFace(mirrored ? GL_CW : GL_CCW);
  glUseProgram(program.id);
  glUniformMatrix4fv(program.clip_from_relative, 1, GL_FALSE,
                     toFloats(reversedClipFromRelative(view, lens)).data());
  glUniform3f(program.eye_high, high.x, high.y, high.z);
  glUniform3f(program.eye_low, low.x, low.y, low.z);
  glUniform3f(program.lens_offset, from_eye.x, from_eye.y, from_eye.z);
  glUniform1f(program.haze, haze);
  glUniform1f(program.normal_sign, mirrored ? -1.0f : 1.0f);
  glUniform1f(program.depth_scale, depth_scale);
}

void setSides(const SceneProgram& program, const View& view, const LensPoint& lens,
              std::span<const PieceSide> sides) {
  const Vec3d eye = view.eye + lensOffset(view, lens);
  std::array<float, std::size_t{4} * kMaxPieceSides> cuts{};
  GLint fronts = 0;
  const std::size_t count = std::min<std::size_t>(sides.size(), kMaxPieceSides);
  for (std::size_t i = 0; i < count; ++i) {
    const Plane& plane = sides[i].plane;
    for (int axis = 0; axis < 3; ++axis) {
      cuts[4 * i + static_cast<std::size_t>(axis)] = static_cast<float>(plane.normal[axis]);
    }
    cuts[4 * i + 3] = static_cast<float>(plane.evaluate(eye));
    fronts |= sides[i].in_front ? 1 << i : 0;
  }
  glUniform1i(program.cut_count, static_cast<GLint>(count));
  glUniform1i(program.cut_fronts, fronts);
  if (count > 0) {
    glUniform4fv(program.cuts, static_cast<GLsizei>(count), cuts.data());
  }
}

float hazeFor(const Box& bounds) {
  const double diagonal = bounds.wellFormed() ? length(Vec3d(bounds.max) - Vec3d(bounds.min)) : 0.0;
  const double half_distance = std::max(1.5 * diagonal, 60.0);
  return static_cast<float>(1.0 / (half_distance * half_distance));
}

Result<SkyProgram> makeSkyProgram(const char* fragment) {
  const Result<GLuint> program = makeProgram("sky", kSkyVertex, fragment);
  if (!program) {
    return program.error();
  }
  SkyProgram sky{.id = *program};
  sky.forward = glGetUniformLocation(sky.id, "forward");
  sky.right = glGetUniformLocation(sky.id, "right");
  sky.up = glGetUniformLocation(sky.id, "up");
  glGenVertexArrays(1, &sky.vertex_array);
  return sky;
}

void drawSkyBehind(const SkyProgram& sky, const View& view) {
  // Orthographic rays are parallel; their sky still gets a mild gradient.
  const double half_height = view.orthographic ? 0.3 : view.tan_half_fovy;
  const Vec3d half_right = view.right * (half_height * view.aspect), half_up = view.up * half_height;
  const Vec3f forward(view.forward + half_right * view.shift_x + half_up * view.shift_y);
  const Vec3f right(half_right);
  const Vec3f up(half_up);
  glUseProgram(sky.id);
  glUniform3f(sky.forward, forward.x, forward.y, forward.z);
  glUniform3f(sky.right, right.x, right.y, right.z);
  glUniform3f(sky.up, up.x, up.y, up.z);
  glBindVertexArray(sky.vertex_array);
  glDisable(GL_DEPTH_TEST);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glEnable(GL_DEPTH_TEST);
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

}  // namespace sightline::render
