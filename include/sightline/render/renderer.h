#pragma once

// Reference pictures of a scene by headless OpenGL. `sightline walk` and the tests measure and compare them.
//
// A picture depends only on the view and on what is visible in it: leaving out hidden objects changes no bit
// of it (on one machine). So a picture with culling can be compared with one without.

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

// The cost of one picture.
struct DrawStats {
  double draw_us = 0.0;         // from the first command to the last pixel, without reading the picture back
  std::uint64_t triangles = 0;  // sent to OpenGL
  std::uint32_t ranges = 0;     // contiguous ranges of the index buffer in which they were sent
};

// Owns an OpenGL context and the scene's triangles in it. Movable. Used by one thread at a time, which may be
// any; the caller's current context stays current.
class Renderer {
 public:
  // Uploads the scene, whose memory is not needed afterwards. Pictures have width x height pixels, each 1 to
  // 16384. Error, with the reason, if there is no OpenGL 4.3 with ARB_clip_control without a window, or if
  // the scene does not fit.
  static Result<Renderer> create(const SceneView& scene, std::uint32_t width, std::uint32_t height);
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  // Draws these objects (ids ascending): first opaque ones, then alpha-tested ones with a checkerboard of
  // holes, then blended ones in the order of their ids. Backs of single-sided materials are not drawn. The
  // view fills the picture, whatever its aspect.
  Image draw(const View& view, std::span<const ObjectId> objects, DrawStats* stats = nullptr);

  // Draws without reading the picture back, to measure the time.
  DrawStats time(const View& view, std::span<const ObjectId> objects);

  // The picture of the last draw() or time().
  Image readBack() const;

  // How many fragments of culled objects pass the depth test over the picture of the kept ones. A depth
  // buffer cannot order surfaces nearer to each other than its rounding, so two pictures may differ although
  // nothing was culled wrongly; culled surfaces are therefore moved away by four millionths of their
  // distance. At 0 every difference between the two pictures is such rounding. Overwrites the last picture.
  std::uint64_t countShowing(const View& view, std::span<const ObjectId> kept,
                             std::span<const ObjectId> culled);

  // A picture of the whole scene from above, coloured by the result of one frame's culling.
  Image drawPlan(const PlanView& plan);

  // The name and version of the OpenGL implementation.
  std::string device() const;

 private:
  struct Impl;
  explicit Renderer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace sightline
