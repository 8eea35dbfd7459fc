#pragma once

// Reference pictures of a scene by headless OpenGL: what `walk` measures and compares, and what tests look
// at.
//
// A picture depends only on the view and on what is visible in it: the pictures of all objects and of all
// objects less hidden ones are equal bit for bit (on one machine). So a picture with culling is checked
// against one without.

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "sightline/base/ids.h"
#include "sightline/base/result.h"
#include "sightline/io/image.h"
#include "sightline/render/plan_view.h"
#include "sightline/scene/scene.h"

namespace sightline {

// What one picture took.
struct DrawStats {
  double draw_us = 0.0;         // microseconds from the first command to the last pixel, without reading back
  std::uint64_t triangles = 0;  // sent to OpenGL
  std::uint32_t ranges = 0;     // contiguous ranges of triangles that they were sent in
};

// Owns an OpenGL context of its own and the scene's triangles in it. Movable; used by one thread at a time,
// any thread; a context of the caller's that is current stays so.
class Renderer {
 public:
  // Uploads the scene, whose memory is not needed afterwards. width, height: of the pictures, pixels, 1 to
  // 16384. Fails, with the reason, where no OpenGL 4.3 with ARB_clip_control can be had without a window, or
  // where the scene does not fit.
  static Result<Renderer> create(const SceneView& scene, std::uint32_t width, std::uint32_t height);
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  // The picture of the given objects (ids ascending). Opaque objects are drawn first, then alpha-tested ones
  // with a checkerboard of holes, then blended ones in the order of their ids. Backs of single-sided
  // materials are not drawn. The view fills the picture, whatever its aspect.
  Image draw(const View& view, std::span<const ObjectId> objects, DrawStats* stats = nullptr);

  // Draws without reading the picture back, for measuring.
  DrawStats time(const View& view, std::span<const ObjectId> objects);

  // The picture of the last draw() or time().
  Image readBack() const;

  // How much of the culled objects would show in the picture of the kept ones: pixels, each counted once an
  // object's surface passes the depth test there. A depth buffer cannot order surfaces nearer to each other
  // than its rounding, and two pictures may differ there although nothing was culled wrongly; so culled
  // surfaces are taken as farther than they are by four millionths of their distance. 0: every difference of
  // the two pictures is of that kind. Overwrites the last picture.
  std::uint64_t countShowing(const View& view, std::span<const ObjectId> kept,
                             std::span<const ObjectId> culled);

  // Top-down picture of the whole scene, coloured by what a frame's culling said.
  Image drawPlan(const PlanView& plan);

  // The name of the OpenGL implementation and its version, for reports.
  std::string device() const;

 private:
  struct Impl;
  explicit Renderer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace sightline
