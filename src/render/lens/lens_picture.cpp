#include "sightline/render/lens_picture.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#include "src/render/lens/lens_picture_motion.h"
#include "src/render/lens/lens_picture_seen.h"
#include "src/scene/usable_view.h"

namespace sightline {

using namespace render;

namespace {

// One of the images whose mean is the accumulated picture.
struct LensPass {
  LensPoint point;
  double time = 0.0;  // in frames from this one on
};

// Points of the lens, each with a time of the shutter. The points run from the middle of the lens outwards;
// multiples of the golden ratio spread the times evenly over every stretch of them.
std::vector<LensPass> passesOf(const LensSettings& settings) {
  constexpr double kGolden = 0.6180339887498949;
  const double aperture = settings.lens.aperture > 0.0 ? settings.lens.aperture : 0.0;
  const double shutter = settings.motion ? settings.motion->shutter : 0.0;
  std::vector<LensPass> passes;
  for (const DiscPoint& point : discPoints(settings.passes)) {
    const double turns = kGolden * (static_cast<double>(passes.size()) + 0.5);
    passes.push_back({{aperture * point.x, aperture * point.y, settings.lens.focus},
                      shutter * (turns - std::floor(turns) - 0.5)});
  }
  return passes;
}

void addTo(LayerImage& sum, const LayerImage& image, float weight) {
  for (std::size_t i = 0; i < sum.pixels.size(); ++i) {
    ShapedPixel& s = sum.pixels[i];
    const ShapedPixel& p = image.pixels[i];
    s = {s.red + weight * p.red, s.green + weight * p.green, s.blue + weight * p.blue,
         s.alpha + weight * p.alpha};
  }
}

// Scales pixels with an opacity above 1 down to 1: they show the mean of what arrived there.
void limitOpacity(LayerImage& image) {
  for (ShapedPixel& p : image.pixels) {
    if (p.alpha > 1.0f) {
      p = {p.red / p.alpha, p.green / p.alpha, p.blue / p.alpha, 1.0f};
    }
  }
}

bool fits(std::span<const Mat4> transforms, std::size_t objects) {
  return transforms.empty() || transforms.size() == objects;
}

Error notAnObject(PartId part, std::size_t objects) {
  return Error{"part " + std::to_string(part.value) + " is no object of the scene, which has " +
               std::to_string(objects)};
}

}  // namespace

struct LensPicture::Impl {
  Impl(const SceneView& scene, LayerRenderer& layer_renderer)
      : renderer(&layer_renderer), compositor(scene, layer_renderer), objects(scene.objects.size()) {
    for (const Object& object : scene.objects) {
      any_blended = any_blended || scene.materialOf(object).opacity == Opacity::kBlended;
    }
  }

  // The arguments and the results so far of one draw() call.
  struct Frame {
    const View& view;
    const LensSettings& settings;
    const std::optional<Motion>& motion;
    LensStats stats;
    std::size_t steps = 0, drawn = 0;  // passes of accumulation, or layers; some layers may be drawn as one

    void tellProgress() {
      ++drawn;
      if (settings.progress && drawn < steps) {
        settings.progress(static_cast<double>(drawn) / static_cast<double>(steps));
      }
    }
  };

  Status check(const FrameLayers& layers, const LensSettings& settings) const;
  LayerDraw wholePicture(const LensSettings& settings) const;
  void drawObjects(Frame& frame, const View& view, std::span<const ObjectId> ids, const LayerDraw& how,
                   LayerImage& image);
  void accumulate(Frame& frame, std::span<const ObjectId> ids, LayerDraw how, LayerImage& image);

  void drawSingle(Frame& frame, std::span<const ObjectId> ids, Spread spread, LayerImage& picture);
  void drawAccumulated(Frame& frame, std::span<const ObjectId> ids, LayerImage& picture);
  Status drawLayers(Frame& frame, const FrameLayers& layers, LayerImage& picture);
  LayerBlur chosenFor(std::span<const ObjectId> ids, const LensSettings& settings) const;
  void drawLayer(Frame& frame, std::span<const ObjectId> ids, LayerDraw how, LayerImage& image);
  void blurLayer(Frame& frame, std::span<const ObjectId> ids, const SeenLayer& seen, LayerBlur blur,
                 LayerImage& image);
  void blurSky(const Frame& frame);
  void move(const PixelStep& step, LayerImage& image);

  LayerRenderer* renderer;
  LayerCompositor compositor;
  std::size_t objects;
  bool any_blended = false;
  LayerImage drawn, pass_image, spread_image, sky;
  std::vector<Mat4> transforms;
};

Status LensPicture::Impl::check(const FrameLayers& layers, const LensSettings& settings) const {
  if (settings.passes == 0) {
    return Error{"accumulation takes at least 1 pass"};
  }
  for (const PartId part : layers.parts) {
    if (part.value >= objects) {
      return notAnObject(part, objects);
    }
  }
  for (const PartBlur& chosen : settings.parts) {
    if (chosen.part.value >= objects) {
      return notAnObject(chosen.part, objects);
    }
  }
  if (settings.method == LensMethod::kLayers && layers.depth_buffered.valid()) {
    return Error{
        "what a depth buffer hides of layers cannot be blurred layer by layer; sort all parts, or "
        "accumulate"};
  }
  if (!settings.motion) {
    return Success{};
  }
  const FrameMotion& motion = *settings.motion;
  if (settings.method == LensMethod::kSingleNormalised ||
      settings.method == LensMethod::kSingleUnnormalised) {
    return Error{"one picture of everything cannot be blurred by motion; use layers or accumulation"};
  }
  if (!fits(motion.later_stored, objects)) {
    return Error{"motion takes one transform an object, of which there are " + std::to_string(objects)};
  }
  if (!(motion.shutter >= 0.0 && motion.shutter <= 1.0)) {
    return Error{"the shutter is open for 0 to 1 of a frame, not " + std::to_string(motion.shutter)};
  }
  return Success{};
}

LayerDraw LensPicture::Impl::wholePicture(const LensSettings& settings) const {
  return {.peel = any_blended && settings.peel == CompositeSettings::Peel::kWhereNeeded};
}

void LensPicture::Impl::drawObjects(Frame& frame, const View& view, std::span<const ObjectId> ids,
                                    const LayerDraw& how, LayerImage& image) {
  frame.stats.triangles += renderer->draw(view, ids, how, image).triangles;
  ++frame.stats.render_passes;
}

void LensPicture::Impl::accumulate(Frame& frame, std::span<const ObjectId> ids, LayerDraw how,
                                   LayerImage& image) {
  const std::optional<Motion>& motion = frame.motion;
  const float weight = 1.0f / static_cast<float>(frame.settings.passes);
  how.depths = false;
  image.clear(renderer->width(), renderer->height());
  for (const LensPass& pass : passesOf(frame.settings)) {
    how.lens = pass.point;
    View view = frame.view;
    if (motion) {
      view = viewAt(frame.view, motion->later, pass.time);
      transformsAt(*motion, objects, pass.time, transforms);
      renderer->setTransforms(transforms);
    }
    drawObjects(frame, view, ids, how, pass_image);
    addTo(image, pass_image, weight);
    if (frame.settings.method == LensMethod::kAccumulation) {
      frame.tellProgress();
    }
  }
  if (motion) {
    renderer->setTransforms(motion->stored);
  }
}

void LensPicture::Impl::drawSingle(Frame& frame, std::span<const ObjectId> ids, Spread spread,
                                   LayerImage& picture) {
  LayerDraw how = wholePicture(frame.settings);
  how.depths = true;
  drawObjects(frame, frame.view, ids, how, drawn);
  if (frame.settings.sky) {
    renderer->drawSky(frame.view, sky);
    compositeOver(drawn, sky);
  }
  if (frame.view.orthographic) {
    std::replace(drawn.depths.begin(), drawn.depths.end(), LayerImage::kNoDepth,
                 static_cast<float>(frame.settings.lens.focus));
  }
  blurByDepth(drawn, frame.view, frame.settings.lens, spread, picture);
  if (spread == Spread::kAsItArrives && frame.settings.sky) {
    // A pixel at which less opacity arrived is darker, one at which more arrived is brighter.
    for (ShapedPixel& pixel : picture.pixels) {
      pixel.alpha = 1.0f;
    }
  }
}

void LensPicture::Impl::drawAccumulated(Frame& frame, std::span<const ObjectId> ids, LayerImage& picture) {
  accumulate(frame, ids, wholePicture(frame.settings), picture);
  if (!frame.settings.sky) {
    return;
  }
  // A sky shows little detail, so the mean of pictures over skies is taken as their mean over the mean sky.
  if (!frame.motion) {
    renderer->drawSky(frame.view, drawn);
  } else {
    drawn.clear(renderer->width(), renderer->height());
    for (const LensPass& pass : passesOf(frame.settings)) {
      renderer->drawSky(viewAt(frame.view, frame.motion->later, pass.time), pass_image);
      addTo(drawn, pass_image, 1.0f / static_cast<float>(frame.settings.passes));
    }
  }
  blurSky(frame);
  compositeOver(picture, sky);
}

// Blurs the sky in `drawn` into `sky`.
void LensPicture::Impl::blurSky(const Frame& frame) {
  const double circle =
      circleOfConfusion(frame.view, frame.settings.lens, LayerImage::kNoDepth, drawn.height);
  blurEvenly(drawn, frame.view.orthographic ? 0.0 : circle, sky);
}

Status LensPicture::Impl::drawLayers(Frame& frame, const FrameLayers& layers, LayerImage& picture) {
  CompositeSettings composite;
  composite.peel = frame.settings.peel;
  composite.form = frame.settings.form;
  composite.sky = false;
  composite.draw_layer = [this, &frame](std::span<const ObjectId> ids, const LayerDraw& how,
                                        LayerImage& image) { drawLayer(frame, ids, how, image); };
  const Result<CompositeStats> composited = compositor.composite(frame.view, layers, composite, picture);
  if (!composited) {
    return composited.error();
  }
  if (frame.settings.sky) {
    renderer->drawSky(frame.view, drawn);
    blurSky(frame);
    if (frame.motion) {
      move(skyStep(frame.view, *frame.motion, sky), sky);
    }
    compositeOver(picture, sky);
  }
  return Success{};
}

LayerBlur LensPicture::Impl::chosenFor(std::span<const ObjectId> ids, const LensSettings& settings) const {
  LayerBlur blur = LayerBlur::kAutomatic;
  for (const PartBlur& chosen : settings.parts) {
    if (std::find(ids.begin(), ids.end(), ObjectId(chosen.part.value)) != ids.end()) {
      blur = chosen.blur;
    }
  }
  return blur;
}

void LensPicture::Impl::drawLayer(Frame& frame, std::span<const ObjectId> ids, LayerDraw how,
                                  LayerImage& image) {
  how.depths = true;
  drawObjects(frame, frame.view, ids, how, drawn);
  frame.tellProgress();
  const SeenLayer seen = lookAt(drawn, frame.view, frame.settings.lens);
  if (seen.empty) {
    image.clear(drawn.width, drawn.height);
    return;
  }
  ++frame.stats.layers;
  LayerBlur blur = chosenFor(ids, frame.settings);
  if (blur == LayerBlur::kAutomatic) {
    const double range = seen.max_circle - seen.min_circle;
    blur = range <= frame.settings.even_within_px        ? LayerBlur::kEven
           : range > frame.settings.accumulate_beyond_px ? LayerBlur::kAccumulate
                                                         : LayerBlur::kByDepth;
  }
  if (blur == LayerBlur::kAccumulate) {
    ++frame.stats.accumulated;
    accumulate(frame, ids, how, image);
  } else {
    blurLayer(frame, ids, seen, blur, image);
  }
}

// Blurs the layer's image in `drawn`.
void LensPicture::Impl::blurLayer(Frame& frame, std::span<const ObjectId> ids, const SeenLayer& seen,
                                  LayerBlur blur, LayerImage& image) {
  if (blur == LayerBlur::kEven) {
    ++frame.stats.even;
    blurEvenly(drawn, std::abs(seen.mean_circle), image);
  } else {
    ++frame.stats.by_depth;
    blurByDepth(drawn, frame.view, frame.settings.lens, Spread::kAsItArrives, image);
    limitOpacity(image);
  }
  if (frame.motion) {
    const PixelStep step = layerStep(frame.view, *frame.motion, ids, seen, image);
    frame.stats.moved += step.x != 0.0 || step.y != 0.0 ? 1 : 0;
    move(step, image);
  }
}

void LensPicture::Impl::move(const PixelStep& step, LayerImage& image) {
  if (step.x != 0.0 || step.y != 0.0) {
    blurAlong(image, step.x, step.y, spread_image);
    std::swap(image, spread_image);
  }
}

LensPicture::LensPicture(const SceneView& scene, LayerRenderer& renderer)
    : impl_(std::make_unique<Impl>(scene, renderer)) {}
LensPicture::~LensPicture() = default;
LensPicture::LensPicture(LensPicture&&) noexcept = default;
LensPicture& LensPicture::operator=(LensPicture&&) noexcept = default;

Result<LensStats> LensPicture::draw(const View& given_view, const FrameLayers& layers,
                                    const LensSettings& settings, LayerImage& picture) {
  if (const Status ok = impl_->check(layers, settings); !ok) {
    return ok.error();
  }
  const View view = scene::withUnitAxes(given_view);
  std::optional<Motion> motion;
  if (const std::optional<FrameMotion>& given = settings.motion) {
    const std::span<const Mat4> stored = impl_->renderer->transforms();
    motion = Motion{.later = scene::withUnitAxes(given->later),
                    .stored = {stored.begin(), stored.end()},
                    .later_stored = given->later_stored,
                    .shutter = given->shutter};
  }
  std::vector<ObjectId> ids;
  for (const PartId part : layers.parts) {
    ids.push_back(ObjectId(part.value));
  }
  const std::size_t steps = settings.method == LensMethod::kAccumulation ? settings.passes : layers.layers();
  Impl::Frame frame{view, settings, motion, {}, steps, 0};
  switch (settings.method) {
    case LensMethod::kSingleNormalised:
      impl_->drawSingle(frame, ids, Spread::kNormalised, picture);
      break;
    case LensMethod::kSingleUnnormalised:
      impl_->drawSingle(frame, ids, Spread::kAsItArrives, picture);
      break;
    case LensMethod::kLayers:
      if (const Status ok = impl_->drawLayers(frame, layers, picture); !ok) {
        return ok.error();
      }
      break;
    case LensMethod::kAccumulation:
      impl_->drawAccumulated(frame, ids, picture);
      break;
  }
  if (settings.progress) {
    settings.progress(1.0);
  }
  return frame.stats;
}

}  // namespace sightline
