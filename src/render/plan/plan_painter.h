#pragma once

#include "sightline/io/image.h"
#include "sightline/render/plan_view.h"
#include "src/render/scene/scene_buffers.h"
#include "src/render/scene/scene_programs.h"

namespace sightline::render {

// Draws plan views. Precondition of all functions: the context is current.
class PlanPainter {
 public:
  static Result<PlanPainter> create();

  // Empty (0 x 0) when the driver cannot make a picture of the size asked for.
  Image paint(const SceneBuffers& scene, const Box& scene_bounds, const PlanView& plan) const;

 private:
  void drawScene(const SceneBuffers& scene, const Box& scene_bounds, const PlanView& plan) const;
  void drawOverlay(const PlanView& plan) const;

  SceneProgram faces_, walls_;
  GLint wall_width_ = -1;
  GLuint overlay_program_ = 0, overlay_array_ = 0, overlay_buffer_ = 0;
};

}  // namespace sightline::render
