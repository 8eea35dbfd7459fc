#include "sightline/render/renderer.h"

#include <array>
#include <utility>

#include "src/base/stopwatch.h"
#include "src/render/context/gl_context.h"
#include "src/render/context/read_pixels.h"
#include "src/render/plan/plan_painter.h"
#include "src/render/scene/scene_buffers.h"
#include "src/render/scene/scene_programs.h"
#include "src/render/scene/shaders.h"
#include "src/scene/usable_view.h"

namespace sightline {

using namespace render;

namespace {

constexpr std::array<float, 4> kBlack{0.0f, 0.0f, 0.0f, 1.0f};

}  // namespace

struct Renderer::Impl {
  explicit Impl(GlContext c) : context(std::move(c)) {}
  Status prepare(const SceneView& scene, std::uint32_t width, std::uint32_t height);
  void drawScene(const View& view) const;  // axes of unit length
  DrawStats timedDraw(const View& view, std::span<const ObjectId> objects);

  GlContext context;
  SceneBuffers buffers;
  SceneProgram solid, alpha_tested;
  SkyProgram sky;
  PlanPainter plan_painter;
  Framebuffer picture;
  Box bounds;
  float haze = 0.0f;
};

Status Renderer::Impl::prepare(const SceneView& scene, std::uint32_t width, std::uint32_t height) {
  const GlContext::Current current(context);
  Result<Framebuffer> framebuffer = makeFramebuffer(width, height);
  if (!framebuffer) {
    return framebuffer.error();
  }
  Result<SceneProgram> solid_program = makeSceneProgram("solid", kSceneFragment);
  Result<SceneProgram> alpha_program = makeSceneProgram("alpha-tested", kAlphaTestedFragment);
  Result<SkyProgram> new_sky = makeSkyProgram(kSkyFragment);
  Result<PlanPainter> painter = PlanPainter::create();
  Result<SceneBuffers> scene_buffers = SceneBuffers::create(scene);
  for (const Error* error :
       {solid_program ? nullptr : &solid_program.error(), alpha_program ? nullptr : &alpha_program.error(),
        new_sky ? nullptr : &new_sky.error(), painter ? nullptr : &painter.error(),
        scene_buffers ? nullptr : &scene_buffers.error()}) {
    if (error) {
      return *error;
    }
  }
  picture = *framebuffer;
  solid = *solid_program;
  alpha_tested = *alpha_program;
  sky = *new_sky;
  plan_painter = *painter;
  buffers = std::move(*scene_buffers);
  bounds = sceneBounds(scene);
  haze = hazeFor(bounds);
  return Success{};
}

void Renderer::Impl::drawScene(const View& view) const {
  const float view_haze = view.orthographic ? 0.0f : haze;
  beginPicture(picture.id, picture.width, picture.height, kBlack);
  drawSkyBehind(sky, view);
  buffers.bind();
  useProgram(solid, view, view_haze);
  buffers.drawPass(Pass::kOpaque);
  buffers.drawPass(Pass::kOpaqueDoubleSided);
  useProgram(alpha_tested, view, view_haze);
  buffers.drawPass(Pass::kAlphaTested);
  buffers.drawPass(Pass::kAlphaTestedDoubleSided);
  useProgram(solid, view, view_haze);
  glDepthMask(GL_FALSE);
  glEnable(GL_BLEND);
  glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ZERO, GL_ONE);
  buffers.drawPass(Pass::kBlended);
  glDisable(GL_BLEND);
  glDepthMask(GL_TRUE);
}

DrawStats Renderer::Impl::timedDraw(const View& view, std::span<const ObjectId> objects) {
  glFinish();
  base::Stopwatch watch;
  const SceneBuffers::Drawn drawn = buffers.select(objects);
  drawScene(scene::withUnitAxes(view));
  glFinish();
  return {.draw_us = watch.lap(), .triangles = drawn.triangles, .ranges = drawn.ranges};
}

Renderer::Renderer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

Result<Renderer> Renderer::create(const SceneView& scene, std::uint32_t width, std::uint32_t height) {
  Result<GlContext> context = GlContext::create();
  if (!context) {
    return context.error();
  }
  auto impl = std::make_unique<Impl>(std::move(*context));
  if (Status prepared = impl->prepare(scene, width, height); !prepared) {
    return prepared.error();
  }
  return Renderer(std::move(impl));
}

Image Renderer::draw(const View& view, std::span<const ObjectId> objects, DrawStats* stats) {
  const GlContext::Current current(impl_->context);
  const DrawStats drawn = impl_->timedDraw(view, objects);
  if (stats) {
    *stats = drawn;
  }
  return readPixels(impl_->picture);
}

DrawStats Renderer::time(const View& view, std::span<const ObjectId> objects) {
  const GlContext::Current current(impl_->context);
  return impl_->timedDraw(view, objects);
}

Image Renderer::readBack() const {
  const GlContext::Current current(impl_->context);
  return readPixels(impl_->picture);
}

std::uint64_t Renderer::countShowing(const View& view, std::span<const ObjectId> kept,
                                     std::span<const ObjectId> culled) {
  // Moves surfaces away by a few times the rounding of a float depth buffer and of its interpolation.
  constexpr float kDepthScale = 1.0f - 4e-6f;
  const GlContext::Current current(impl_->context);
  (void)impl_->timedDraw(view, kept);
  impl_->buffers.select(culled);
  GLuint query = 0;
  glGenQueries(1, &query);
  glDepthMask(GL_FALSE);
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  useProgram(impl_->solid, scene::withUnitAxes(view), 0.0f, kDepthScale);
  glBeginQuery(GL_SAMPLES_PASSED, query);
  for (std::size_t pass = 0; pass < kPassCount; ++pass) {
    impl_->buffers.drawPass(static_cast<Pass>(pass));
  }
  glEndQuery(GL_SAMPLES_PASSED);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glDepthMask(GL_TRUE);
  GLuint64 samples = 0;
  glGetQueryObjectui64v(query, GL_QUERY_RESULT, &samples);
  glDeleteQueries(1, &query);
  return samples;
}

Image Renderer::drawPlan(const PlanView& plan) {
  const GlContext::Current current(impl_->context);
  return impl_->plan_painter.paint(impl_->buffers, impl_->bounds, plan);
}

std::string Renderer::device() const {
  return impl_->context.device();
}

}  // namespace sightline
