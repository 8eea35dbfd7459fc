#include "sightline/render/layer_renderer.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "src/render/context/gl_context.h"
#include "src/render/layers/depth_peeling.h"
#include "src/render/layers/layer_renderer_places.h"
#include "src/render/layers/layer_renderer_rect.h"
#include "src/render/layers/layer_renderer_target.h"
#include "src/render/scene/scene_buffers.h"
#include "src/render/scene/scene_programs.h"
#include "src/render/scene/shaders.h"
#include "src/scene/usable_view.h"

namespace sightline {

using namespace render;

namespace {

constexpr std::array<float, 4> kTransparent{0.0f, 0.0f, 0.0f, 0.0f};

// The programs of all passes for one vertex shader.
struct LayerPrograms {
  SceneProgram opaque, alpha_tested, blended, peel_depth, peel_color, depth;
};

Result<LayerPrograms> makeLayerPrograms(const char* vertex, std::uint32_t samples) {
  LayerPrograms p;
  const std::array<std::pair<SceneProgram*, const char*>, 6> all{
      {{&p.opaque, kLayerOpaqueFragment},
       {&p.alpha_tested, kLayerAlphaTestedFragment},
       {&p.blended, kLayerBlendedFragment},
       {&p.peel_depth, kPeelDepthFragment},
       {&p.peel_color, kPeelColorFragment},
       {&p.depth, kLayerDepthFragment}}};
  for (const auto& [program, fragment] : all) {
    const Result<SceneProgram> made = makeSceneProgram("layer", fragment, nullptr, vertex);
    if (!made) {
      return made.error();
    }
    *program = *made;
  }
  const GLint location = glGetUniformLocation(p.alpha_tested.id, "samples");
  glProgramUniform1i(p.alpha_tested.id, location, static_cast<GLint>(samples));
  return p;
}

// The bounds of each object's vertices. The scene's own bounds are not relied on.
std::vector<Box> boundsOf(const SceneView& scene) {
  std::vector<Box> bounds(scene.objects.size());
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    for (const std::uint32_t index : scene.indicesOf(scene.objects[i])) {
      bounds[i].extend(scene.positions[index]);
    }
  }
  return bounds;
}

}  // namespace

struct LayerRenderer::Impl {
  explicit Impl(GlContext c) : context(std::move(c)) {}
  Status prepare(const SceneView& scene, const LayerRendererOptions& options);
  void choose(std::span<const ObjectId> objects, bool as_given);
  const ObjectPiece* findPiece(ObjectId id) const;
  PixelRect covered(const View& view, const LensPoint& lens) const;
  void begin(const PixelRect& rect);
  void use(const SceneProgram LayerPrograms::*program, const View& view, const LensPoint& lens,
           const ObjectPiece* piece) const;
  template <typename DrawBatch>
  void forEachBatch(DrawBatch&& draw_batch);
  void drawOpaque(const View& view, const LensPoint& lens);
  void blendInOrder(const View& view, const LensPoint& lens);
  std::uint32_t peel(const View& view, const LensPoint& lens, std::uint64_t blended);
  void addBlendedDepths(const View& view, const LensPoint& lens);
  struct Triangles {
    std::uint64_t all = 0, blended = 0;
  };
  Triangles countTriangles();

  GlContext context;
  SceneBuffers buffers;
  ObjectPlaces places;
  LayerPrograms stored, moved;
  SkyProgram sky;
  LayerTarget target;
  std::optional<DepthPeeler> peeler;              // if the scene has blended surfaces
  std::vector<Box> bounds;                        // of each object, in stored coordinates
  std::vector<ObjectPiece> pieces;                // that may be drawn, ascending
  std::vector<ObjectId> chosen;                   // the objects to draw, in the order of drawing
  std::vector<const ObjectPiece*> chosen_pieces;  // those to draw after them
  std::vector<std::uint8_t> seen;                 // one for each object: whether it is among the chosen ones
  float haze = 0.0f;
  LayerRendererOptions options;
};

Status LayerRenderer::Impl::prepare(const SceneView& scene, const LayerRendererOptions& new_options) {
  const GlContext::Current current(context);
  Result<LayerTarget> new_target =
      LayerTarget::create(new_options.width, new_options.height, new_options.samples);
  if (!new_target) {
    return new_target.error();
  }
  Result<LayerPrograms> stored_programs = makeLayerPrograms(kSceneVertex, new_options.samples);
  Result<LayerPrograms> moved_programs = makeLayerPrograms(kMovedSceneVertex, new_options.samples);
  Result<SkyProgram> new_sky = makeSkyProgram(kLinearSkyFragment);
  Result<SceneBuffers> scene_buffers = SceneBuffers::create(scene, new_options.tints);
  Result<ObjectPlaces> new_places = ObjectPlaces::create(static_cast<std::uint32_t>(scene.objects.size()));
  for (const Error* error :
       {stored_programs ? nullptr : &stored_programs.error(),
        moved_programs ? nullptr : &moved_programs.error(), new_sky ? nullptr : &new_sky.error(),
        scene_buffers ? nullptr : &scene_buffers.error(), new_places ? nullptr : &new_places.error()}) {
    if (error) {
      return *error;
    }
  }
  const auto blended = [&scene](const Object& o) { return scene.materialOf(o).opacity == Opacity::kBlended; };
  if (std::any_of(scene.objects.begin(), scene.objects.end(), blended)) {
    Result<DepthPeeler> new_peeler = DepthPeeler::create(*new_target);
    if (!new_peeler) {
      return new_peeler.error();
    }
    peeler = *new_peeler;
  }
  target = *new_target;
  stored = *stored_programs;
  moved = *moved_programs;
  sky = *new_sky;
  buffers = std::move(*scene_buffers);
  places = std::move(*new_places);
  bounds = boundsOf(scene);
  haze = hazeFor(sceneBounds(scene));
  options = new_options;
  return Success{};
}

const ObjectPiece* LayerRenderer::Impl::findPiece(ObjectId id) const {
  const auto found =
      std::lower_bound(pieces.begin(), pieces.end(), id,
                       [](const ObjectPiece& piece, ObjectId number) { return piece.piece < number; });
  return found != pieces.end() && found->piece == id ? &*found : nullptr;
}

// Sets `chosen` and `chosen_pieces`: what can be drawn, each once, in the order of drawing.
void LayerRenderer::Impl::choose(std::span<const ObjectId> objects, bool as_given) {
  chosen.clear();
  chosen_pieces.clear();
  for (const ObjectId id : pieces.empty() ? std::span<const ObjectId>() : objects) {
    const ObjectPiece* const piece = findPiece(id);
    if (piece != nullptr && places.drawable(piece->object.value)) {
      chosen_pieces.push_back(piece);
    }
  }
  std::sort(chosen_pieces.begin(), chosen_pieces.end());
  chosen_pieces.erase(std::unique(chosen_pieces.begin(), chosen_pieces.end()), chosen_pieces.end());
  seen.assign(bounds.size(), 0);
  for (const ObjectId id : objects) {
    if (places.drawable(id.value) && seen[id.value] == 0) {
      seen[id.value] = 1;
      chosen.push_back(id);
    }
  }
  if (!as_given && !std::is_sorted(chosen.begin(), chosen.end())) {
    std::sort(chosen.begin(), chosen.end());
  }
  std::erase_if(chosen_pieces, [&](const ObjectPiece* piece) { return seen[piece->object.value] != 0; });
}

// The rectangle that the chosen objects cover.
PixelRect LayerRenderer::Impl::covered(const View& view, const LensPoint& lens) const {
  RectCollector collector(view, lens, options.width, options.height);
  for (std::size_t i = 0; i < chosen.size() && !collector.full(); ++i) {
    collector.add(bounds[chosen[i].value], places.of(chosen[i].value));
  }
  for (std::size_t i = 0; i < chosen_pieces.size() && !collector.full(); ++i) {
    const ObjectId object = chosen_pieces[i]->object;
    collector.add(bounds[object.value], places.of(object.value));
  }
  return collector.rect();
}

void LayerRenderer::Impl::begin(const PixelRect& rect) {
  target.restrictTo(rect);
  beginPicture(target.framebuffer(), target.sampleWidth(), target.sampleHeight(), kTransparent);
}

// piece: what is drawn with the program; null: whole objects.
void LayerRenderer::Impl::use(const SceneProgram LayerPrograms::*program, const View& view,
                              const LensPoint& lens, const ObjectPiece* piece) const {
  const LayerPrograms& programs = places.asStored() ? stored : moved;
  useProgram(programs.*program, view, view.orthographic ? 0.0f : haze, 1.0f, lens);
  setSides(programs.*program, view, lens, piece ? std::span(piece->sides) : std::span<const PieceSide>());
}

// Selects what was chosen, first all whole objects and then one piece after the other.
template <typename DrawBatch>
void LayerRenderer::Impl::forEachBatch(DrawBatch&& draw_batch) {
  if (!chosen.empty()) {
    buffers.select(chosen, places.mirrored());
    draw_batch(nullptr);
  }
  for (const ObjectPiece* const piece : chosen_pieces) {
    buffers.select({&piece->object, 1}, places.mirrored());
    draw_batch(piece);
  }
}

LayerRenderer::Impl::Triangles LayerRenderer::Impl::countTriangles() {
  const SceneBuffers::Drawn whole = buffers.select(chosen, places.mirrored());
  Triangles triangles{whole.triangles, buffers.blendedTriangles()};
  for (const ObjectPiece* const piece : chosen_pieces) {
    triangles.all += buffers.select({&piece->object, 1}, places.mirrored()).triangles;
    triangles.blended += buffers.blendedTriangles();
  }
  return triangles;
}

void LayerRenderer::Impl::drawOpaque(const View& view, const LensPoint& lens) {
  forEachBatch([&](const ObjectPiece* piece) {
    use(&LayerPrograms::opaque, view, lens, piece);
    buffers.drawPass(Pass::kOpaque);
    buffers.drawPass(Pass::kOpaqueDoubleSided);
    use(&LayerPrograms::alpha_tested, view, lens, piece);
    buffers.drawPass(Pass::kAlphaTested);
    buffers.drawPass(Pass::kAlphaTestedDoubleSided);
  });
}

void LayerRenderer::Impl::blendInOrder(const View& view, const LensPoint& lens) {
  glDepthMask(GL_FALSE);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  forEachBatch([&](const ObjectPiece* piece) {
    use(&LayerPrograms::blended, view, lens, piece);
    buffers.drawPass(Pass::kBlended);
  });
  glDisable(GL_BLEND);
  glDepthMask(GL_TRUE);
}

std::uint32_t LayerRenderer::Impl::peel(const View& view, const LensPoint& lens, std::uint64_t blended) {
  // A triangle has one depth in a sample, so there are no more peels than triangles.
  return peeler->peel(target, blended, [&](DepthPeeler::Stage stage) {
    forEachBatch([&](const ObjectPiece* piece) {
      use(stage == DepthPeeler::Stage::kDepth ? &LayerPrograms::peel_depth : &LayerPrograms::peel_color, view,
          lens, piece);
      buffers.drawPass(Pass::kBlended);
    });
  });
}

void LayerRenderer::Impl::addBlendedDepths(const View& view, const LensPoint& lens) {
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  forEachBatch([&](const ObjectPiece* piece) {
    use(&LayerPrograms::depth, view, lens, piece);
    buffers.drawPass(Pass::kBlended);
  });
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
}

LayerRenderer::LayerRenderer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
LayerRenderer::~LayerRenderer() = default;
LayerRenderer::LayerRenderer(LayerRenderer&&) noexcept = default;
LayerRenderer& LayerRenderer::operator=(LayerRenderer&&) noexcept = default;

Result<LayerRenderer> LayerRenderer::create(const SceneView& scene, const LayerRendererOptions& options) {
  Result<GlContext> context = GlContext::create();
  if (!context) {
    return context.error();
  }
  auto impl = std::make_unique<Impl>(std::move(*context));
  if (Status prepared = impl->prepare(scene, options); !prepared) {
    return prepared.error();
  }
  return LayerRenderer(std::move(impl));
}

void LayerRenderer::setTransforms(std::span<const Mat4> scene_from_stored) {
  impl_->places.set(scene_from_stored);
}
std::span<const Mat4> LayerRenderer::transforms() const {
  return impl_->places.all();
}

void LayerRenderer::setPieces(std::vector<ObjectPiece> pieces) {
  impl_->pieces = std::move(pieces);
  std::sort(impl_->pieces.begin(), impl_->pieces.end(),
            [](const ObjectPiece& a, const ObjectPiece& b) { return a.piece < b.piece; });
  const auto isObject = [&](const ObjectPiece& piece) { return piece.piece.value < impl_->bounds.size(); };
  std::erase_if(impl_->pieces, isObject);
}

ObjectId LayerRenderer::objectOf(ObjectId object_or_piece) const {
  const ObjectPiece* const piece = impl_->findPiece(object_or_piece);
  return piece != nullptr ? piece->object : object_or_piece;
}

LayerDrawStats LayerRenderer::draw(const View& given_view, std::span<const ObjectId> objects,
                                   const LayerDraw& how, LayerImage& image) {
  Impl& r = *impl_;
  const View view = scene::withUnitAxes(given_view);
  const GlContext::Current current(r.context);
  r.choose(objects, how.as_given);
  const auto [triangles, blended] = r.countTriangles();
  LayerDrawStats stats{.triangles = triangles, .passes = 1};
  r.begin(r.covered(view, how.lens));
  if (how.hidden) {
    r.target.restoreDepths();
  }
  r.buffers.bind();
  r.places.bind(view.eye);
  r.drawOpaque(view, how.lens);
  if (blended > 0 && how.peel) {
    const std::uint32_t peels = r.peel(view, how.lens, blended);
    stats.passes = std::max(peels, 1u);
    // Each peel sends the triangles twice, and one more time finds that there are no further peels.
    stats.triangles += blended * (peels + std::min<std::uint64_t>(peels + 1, blended) - 1);
  } else if (blended > 0) {
    r.blendInOrder(view, how.lens);
  }
  if (blended > 0 && how.depths) {
    r.addBlendedDepths(view, how.lens);
    stats.triangles += blended;
  }
  r.target.read(view, how.depths, image);
  return stats;
}

std::uint64_t LayerRenderer::hideBehind(const View& given_view, std::span<const ObjectId> objects,
                                        const LensPoint& lens) {
  Impl& r = *impl_;
  const View view = scene::withUnitAxes(given_view);
  const GlContext::Current current(r.context);
  r.choose(objects, false);
  const auto [triangles, blended] = r.countTriangles();
  r.begin({0, 0, r.options.width, r.options.height});
  r.buffers.bind();
  r.places.bind(view.eye);
  r.drawOpaque(view, lens);
  r.target.keepDepths();
  return triangles - blended;
}

void LayerRenderer::drawSky(const View& given_view, LayerImage& image) {
  Impl& r = *impl_;
  const View view = scene::withUnitAxes(given_view);
  const GlContext::Current current(r.context);
  r.begin({0, 0, r.options.width, r.options.height});
  drawSkyBehind(r.sky, view);
  r.target.read(view, false, image);
}

std::uint32_t LayerRenderer::width() const {
  return impl_->options.width;
}

std::uint32_t LayerRenderer::height() const {
  return impl_->options.height;
}

std::string LayerRenderer::device() const {
  return impl_->context.device();
}

}  // namespace sightline
