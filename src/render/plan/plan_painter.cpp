#include "src/render/plan/plan_painter.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "src/render/context/gl_context.h"
#include "src/render/context/read_pixels.h"
#include "src/render/plan/plan_overlay.h"
#include "src/render/scene/shaders.h"

namespace sightline::render {
namespace {

constexpr double kWallWidthPx = 1.6;

// An orthographic view straight down, from above the scene or from the cut; right is +x, up is -z.
View viewFromAbove(const Box& bounds, const PlanView& plan) {
  const double bottom = bounds.wellFormed() ? bounds.min.y : 0.0;
  const double top = std::min(bounds.wellFormed() ? bounds.max.y + 1.0 : 1.0, plan.cut_height);
  View view;
  view.eye = {plan.camera.eye.x, top + 1.0, plan.camera.eye.z};
  view.right = {1.0, 0.0, 0.0};
  view.up = {0.0, 0.0, -1.0};
  view.forward = {0.0, -1.0, 0.0};
  view.orthographic = true;
  view.ortho_height = 2.0 * plan.radius;
  view.aspect = 1.0;
  view.z_near = 1.0;
  view.z_far = std::max(top - bottom, 1.0) + 2.0;
  return view;
}

bool fillsHalfThePicture(const Object& object, const PlanView& plan) {
  const auto extent = object.bounds.extent();
  return object.bounds.wellFormed() && extent.x * extent.z > 2.0 * plan.radius * plan.radius;
}

// One colour for each object: its state's, a little lighter or darker from object to object.
std::vector<std::array<std::uint8_t, 4>> stateColors(const PlanView& plan, std::uint32_t object_count) {
  std::vector<std::array<std::uint8_t, 4>> colors(object_count);
  for (std::uint32_t i = 0; i < object_count; ++i) {
    const ObjectState state = i < plan.states.size() ? plan.states[i] : ObjectState::kOutside;
    const PlanColor& full = state == ObjectState::kKept     ? kPlanKept
                            : state == ObjectState::kHidden ? kPlanHidden
                                                            : kPlanOutside;
    const bool pale = i < plan.objects.size() && fillsHalfThePicture(plan.objects[i], plan);
    const PlanColor color = pale ? paleOf(full) : full;
    const std::uint32_t percent = 92 + ((i * 2654435761u) >> 24) % 9;
    for (std::size_t c = 0; c < 3; ++c) {
      colors[i][c] = static_cast<std::uint8_t>(color[c] * percent / 100);
    }
    colors[i][3] = 255;
  }
  return colors;
}

}  // namespace

Result<PlanPainter> PlanPainter::create() {
  const Result<SceneProgram> faces = makeSceneProgram("plan", kPlanFragment);
  const Result<SceneProgram> walls = makeSceneProgram("plan walls", kPlanWallFragment, kPlanWallGeometry);
  const Result<GLuint> overlay = makeProgram("plan overlay", kOverlayVertex, kOverlayFragment);
  if (!faces || !walls || !overlay) {
    return !faces ? faces.error() : !walls ? walls.error() : overlay.error();
  }
  PlanPainter painter;
  painter.faces_ = *faces;
  painter.walls_ = *walls;
  painter.wall_width_ = glGetUniformLocation(walls->id, "half_width");
  painter.overlay_program_ = *overlay;
  glGenVertexArrays(1, &painter.overlay_array_);
  glGenBuffers(1, &painter.overlay_buffer_);
  glBindVertexArray(painter.overlay_array_);
  glBindBuffer(GL_ARRAY_BUFFER, painter.overlay_buffer_);
  glVertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, sizeof(OverlayVertex), nullptr);
  glVertexAttribPointer(1, 4, GL_UNSIGNED_BYTE, GL_TRUE, sizeof(OverlayVertex),
                        reinterpret_cast<const void*>(offsetof(OverlayVertex, color)));
  glEnableVertexAttribArray(0);
  glEnableVertexAttribArray(1);
  return painter;
}

Image PlanPainter::paint(const SceneBuffers& scene, const Box& scene_bounds, const PlanView& plan) const {
  // The plan is drawn at twice its size, for smooth lines, if the driver can.
  Result<Framebuffer> picture = makeFramebuffer(2 * plan.size_px, 2 * plan.size_px);
  const bool smooth = picture.has_value();
  if (!smooth) {
    picture = makeFramebuffer(plan.size_px, plan.size_px);
  }
  if (!picture) {
    return {};
  }
  const auto channel = [](std::uint8_t c) { return static_cast<float>(c) / 255.0f; };
  beginPicture(picture->id, picture->width, picture->height,
               {channel(kPlanBackground[0]), channel(kPlanBackground[1]), channel(kPlanBackground[2]), 1.0f});
  drawScene(scene, scene_bounds, plan);
  drawOverlay(plan);
  const Image image = readPixels(*picture);
  destroy(*picture);
  return smooth ? halved(image) : image;
}

void PlanPainter::drawScene(const SceneBuffers& scene, const Box& scene_bounds, const PlanView& plan) const {
  const View view = viewFromAbove(scene_bounds, plan);
  scene.bindStateColors(stateColors(plan, scene.objectCount()));
  useProgram(faces_, view, 0.0f);
  scene.drawAll();
  glDepthFunc(GL_GEQUAL);
  useProgram(walls_, view, 0.0f);
  glUniform1f(wall_width_, static_cast<float>(kWallWidthPx / plan.size_px));
  scene.drawAll();
}

void PlanPainter::drawOverlay(const PlanView& plan) const {
  const std::vector<OverlayVertex> vertices = planOverlay(plan);
  glDisable(GL_DEPTH_TEST);
  glEnable(GL_BLEND);
  glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ZERO, GL_ONE);
  glUseProgram(overlay_program_);
  glBindVertexArray(overlay_array_);
  glBindBuffer(GL_ARRAY_BUFFER, overlay_buffer_);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size() * sizeof(OverlayVertex)),
               vertices.data(), GL_STREAM_DRAW);
  glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(vertices.size()));
  glDisable(GL_BLEND);
}

}  // namespace sightline::render
