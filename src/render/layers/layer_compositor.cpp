// Groups are composited one after another, front to back: the images of a group's layers are drawn, its
// program combines them, and the picture so far is put over the result.

#include "sightline/render/layer_compositor.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "src/render/layers/convex_mesh.h"

namespace sightline {

using namespace render;

namespace {

// Where a layer's image comes from: drawn, unless it is left out or replaced.
struct LayerUse {
  bool left_out = false;
  const LayerImage* replacement = nullptr;
};

// Whether the depth-buffered layer hides what is behind it of this one.
bool isHidden(const FrameLayers& layers, std::uint32_t layer) {
  return layers.depth_buffered.valid() && layer >= layers.first_hidden.value &&
         layer < layers.depth_buffered.value;
}

Error replacementError(LayerId layer, const std::string& what) {
  return Error{"the image that replaces layer " + std::to_string(layer.value) + " " + what};
}

}  // namespace

struct LayerCompositor::Impl {
  bool isBlended(ObjectId object_or_piece) const {
    return is_blended[renderer->objectOf(object_or_piece).value] != 0;
  }

  LayerRenderer* renderer = nullptr;
  std::vector<std::uint8_t> is_blended, covers_once;  // one for each object

  CompositingCompiler compiler;
  CompositingProgram group_program;  // one group's steps, with its layers numbered from 0
  std::vector<LayerUse> uses;        // one for each layer of the frame
  std::vector<LayerImage> images;    // of one group's layers; never shrinks
  std::vector<ShapedImage> operands;
  std::vector<const LayerImage*> kept;  // the images of one group, for CompositeSettings::keep_group
  std::vector<ObjectId> objects;
  std::array<ShapedPixel, kCompositingScratch> scratch;
  LayerImage composited, sky;
  std::vector<std::uint32_t> unordered_groups;
  bool all_sizes_fit = true;  // whether every image drawn so far has the renderer's size

  Status readUses(const FrameLayers& layers, const CompositeSettings& settings);
  bool isOfRenderersSize(const LayerImage& image) const;
  bool hasBlended(const FrameLayers& layers, LayerId layer) const;
  bool needsPeel() const;
  bool isUnordered(const FrameLayers& layers, std::uint32_t first, std::uint32_t end) const;

  void collect(const FrameLayers& layers, std::uint32_t first, std::uint32_t end);
  void drawObjects(const View& view, const CompositeSettings& settings, bool hidden, LayerImage& image,
                   CompositeStats& stats);
  void hideBehindDepthBuffered(const View& view, const FrameLayers& layers, CompositeStats& stats);
  void addLayer(const View& view, const FrameLayers& layers, std::uint32_t layer,
                const CompositeSettings& settings, LayerImage& picture, CompositeStats& stats);
  void addGroup(const View& view, const FrameLayers& layers, std::uint32_t group,
                const CompositingProgram& program, const CompositeSettings& settings, LayerImage& picture,
                CompositeStats& stats);
  void addImage(const CompositeSettings& settings, std::uint32_t first, std::uint32_t end,
                const LayerImage& image, LayerImage& picture);
  void evaluateGroup(std::span<const CompositingStep> steps, std::uint32_t first, std::uint32_t count,
                     const CompositeSettings& settings, LayerImage& picture);
};

Status LayerCompositor::Impl::readUses(const FrameLayers& layers, const CompositeSettings& settings) {
  uses.assign(layers.layers(), {});
  for (const LayerReplacement& replaced : settings.replaced) {
    if (replaced.layer.value >= uses.size()) {
      return replacementError(replaced.layer, "replaces none: there are " + std::to_string(uses.size()));
    }
    const LayerImage* image = replaced.image;
    if (image == nullptr || !isOfRenderersSize(*image)) {
      return replacementError(replaced.layer, "must have " + std::to_string(renderer->width()) + " x " +
                                                  std::to_string(renderer->height()) + " pixels");
    }
    uses[replaced.layer.value].replacement = image;
  }
  for (const LayerId layer : settings.left_out) {
    if (layer.value < uses.size()) {
      uses[layer.value].left_out = true;
    }
  }
  return Success{};
}

bool LayerCompositor::Impl::isOfRenderersSize(const LayerImage& image) const {
  return image.width == renderer->width() && image.height == renderer->height() &&
         image.pixels.size() == std::size_t{image.width} * image.height;
}

bool LayerCompositor::Impl::hasBlended(const FrameLayers& layers, LayerId layer) const {
  const std::span<const PartId> parts = layers.partsOf(layer);
  return std::any_of(parts.begin(), parts.end(),
                     [&](PartId part) { return isBlended(ObjectId(part.value)); });
}

// Whether the layer of all of `objects` must be peeled.
bool LayerCompositor::Impl::needsPeel() const {
  const bool any_blended =
      std::any_of(objects.begin(), objects.end(), [&](ObjectId o) { return isBlended(o); });
  return any_blended && (objects.size() > 1 || covers_once[renderer->objectOf(objects.front()).value] == 0);
}

// Whether the layers of a group that are drawn form a cycle of which some are blended.
bool LayerCompositor::Impl::isUnordered(const FrameLayers& layers, std::uint32_t first,
                                        std::uint32_t end) const {
  std::size_t parts = 0;
  bool any_blended = false;
  for (std::uint32_t i = first; i < end; ++i) {
    if (!uses[i].left_out && uses[i].replacement == nullptr) {
      parts += layers.partsOf(LayerId(i)).size();
      any_blended = any_blended || hasBlended(layers, LayerId(i));
    }
  }
  return parts > 1 && any_blended;
}

// Collects the objects of those of these layers that are drawn.
void LayerCompositor::Impl::collect(const FrameLayers& layers, std::uint32_t first, std::uint32_t end) {
  objects.clear();
  for (std::uint32_t i = first; i < end; ++i) {
    if (!uses[i].left_out && uses[i].replacement == nullptr) {
      for (const PartId part : layers.partsOf(LayerId(i))) {
        objects.push_back(ObjectId(part.value));
      }
    }
  }
}

void LayerCompositor::Impl::hideBehindDepthBuffered(const View& view, const FrameLayers& layers,
                                                    CompositeStats& stats) {
  objects.clear();
  if (layers.depth_buffered.valid()) {
    collect(layers, layers.depth_buffered.value, layers.depth_buffered.value + 1);
    stats.triangles += renderer->hideBehind(view, objects);
  }
}

void LayerCompositor::Impl::drawObjects(const View& view, const CompositeSettings& settings, bool hidden,
                                        LayerImage& image, CompositeStats& stats) {
  LayerDraw how;
  how.hidden = hidden;
  how.depths = static_cast<bool>(settings.keep_group);
  how.peel = settings.peel == CompositeSettings::Peel::kWhereNeeded && needsPeel();
  ++stats.layers;
  stats.peeled += how.peel ? 1 : 0;
  if (settings.draw_layer) {
    settings.draw_layer(objects, how, image);
    if (!isOfRenderersSize(image)) {
      all_sizes_fit = false;
      image.clear(renderer->width(), renderer->height());
    }
  } else {
    stats.triangles += renderer->draw(view, objects, how, image).triangles;
  }
}

void LayerCompositor::Impl::addLayer(const View& view, const FrameLayers& layers, std::uint32_t layer,
                                     const CompositeSettings& settings, LayerImage& picture,
                                     CompositeStats& stats) {
  if (uses[layer].left_out) {
    return;
  }
  if (uses[layer].replacement != nullptr) {
    addImage(settings, layer, layer + 1, *uses[layer].replacement, picture);
    return;
  }
  collect(layers, layer, layer + 1);
  drawObjects(view, settings, isHidden(layers, layer), images.front(), stats);
  addImage(settings, layer, layer + 1, images.front(), picture);
}

// Puts the image of all layers from `first` up to `end` under the picture.
void LayerCompositor::Impl::addImage(const CompositeSettings& settings, std::uint32_t first,
                                     std::uint32_t end, const LayerImage& image, LayerImage& picture) {
  compositeOver(picture, image);
  if (settings.keep_group) {
    const LayerImage* const only = &image;
    const CompositingStep step{CompositingOp::kStartImage, LayerId(0u)};
    settings.keep_group({first, end, {&only, 1}, {&step, 1}});
  }
}

void LayerCompositor::Impl::addGroup(const View& view, const FrameLayers& layers, std::uint32_t group,
                                     const CompositingProgram& program, const CompositeSettings& settings,
                                     LayerImage& picture, CompositeStats& stats) {
  const std::uint32_t first = layers.first_layer[group], end = layers.first_layer[group + 1];
  const bool unordered = isUnordered(layers, first, end);
  if (unordered) {
    unordered_groups.push_back(group);
  }
  if (end - first == 1) {
    addLayer(view, layers, first, settings, picture, stats);
    return;
  }
  const bool any_replaced = std::any_of(uses.begin() + first, uses.begin() + end, [](const LayerUse& use) {
    return use.replacement != nullptr && !use.left_out;
  });
  // An image that replaces a layer has no depths by which it could be peeled with the others.
  if (unordered && !any_replaced && settings.peel == CompositeSettings::Peel::kWhereNeeded) {
    collect(layers, first, end);
    drawObjects(view, settings, isHidden(layers, first), images.front(), stats);
    addImage(settings, first, end, images.front(), picture);
    return;
  }
  const std::uint32_t count = end - first;
  images.resize(std::max<std::size_t>(images.size(), count));
  operands.assign(count, {});
  kept.assign(count, nullptr);
  for (std::uint32_t i = 0; i < count; ++i) {
    const LayerUse& use = uses[first + i];
    if (use.left_out) {
      continue;
    }
    if (use.replacement == nullptr) {
      collect(layers, first + i, first + i + 1);
      drawObjects(view, settings, isHidden(layers, first + i), images[i], stats);
    }
    kept[i] = use.replacement != nullptr ? use.replacement : &images[i];
    operands[i] = kept[i]->view();
  }
  evaluateGroup(program.group(group), first, count, settings, picture);
}

void LayerCompositor::Impl::evaluateGroup(std::span<const CompositingStep> steps, std::uint32_t first,
                                          std::uint32_t count, const CompositeSettings& settings,
                                          LayerImage& picture) {
  group_program.steps.assign(steps.begin(), steps.end());
  bool is_started = false;
  for (CompositingStep& step : group_program.steps) {
    if (step.layer.valid()) {
      step.layer.value -= first;
    }
    // The compiled program puts the group over those before it; here it is composited alone.
    if (step.op == CompositingOp::kOver && !is_started) {
      step.op = CompositingOp::kStartImage;
    }
    is_started = is_started || step.op == CompositingOp::kStartImage;
  }
  group_program.first_of.assign({0, static_cast<std::uint32_t>(steps.size())});
  group_program.layers = count;
  composited.clear(picture.width, picture.height);
  if (evaluate(group_program, operands, composited.target(), scratch)) {
    compositeOver(picture, composited);
    if (settings.keep_group) {
      settings.keep_group({first, first + count, kept, group_program.steps});
    }
  }
}

LayerCompositor::LayerCompositor(const SceneView& scene, LayerRenderer& renderer)
    : impl_(std::make_unique<Impl>()) {
  impl_->renderer = &renderer;
  impl_->images.resize(1);
  for (const Object& object : scene.objects) {
    const Material& material = scene.materialOf(object);
    const bool blended = material.opacity == Opacity::kBlended;
    impl_->is_blended.push_back(blended ? 1 : 0);
    impl_->covers_once.push_back(
        blended && coversOnce(scene.positions, scene.indicesOf(object), material.double_sided) ? 1 : 0);
  }
}

LayerCompositor::~LayerCompositor() = default;
LayerCompositor::LayerCompositor(LayerCompositor&&) noexcept = default;
LayerCompositor& LayerCompositor::operator=(LayerCompositor&&) noexcept = default;

Result<CompositeStats> LayerCompositor::composite(const View& view, const FrameLayers& layers,
                                                  const CompositeSettings& settings, LayerImage& picture) {
  Impl& c = *impl_;
  for (const PartId part : layers.parts) {
    if (c.renderer->objectOf(ObjectId(part.value)).value >= c.is_blended.size()) {
      return Error{"part " + std::to_string(part.value) + " is no object of the scene, which has " +
                   std::to_string(c.is_blended.size())};
    }
  }
  if (const Status ok = c.readUses(layers, settings); !ok) {
    return ok.error();
  }
  const CompositingProgram& program = c.compiler.compile(layers, settings.form, settings.left_out);
  CompositeStats stats;
  stats.operations = countSteps(program.steps);
  c.all_sizes_fit = true;
  c.unordered_groups.clear();
  picture.clear(c.renderer->width(), c.renderer->height());
  c.hideBehindDepthBuffered(view, layers, stats);
  for (std::uint32_t group = 0; group < layers.groups(); ++group) {
    c.addGroup(view, layers, group, program, settings, picture, stats);
  }
  stats.unordered_groups = static_cast<std::uint32_t>(c.unordered_groups.size());
  if (!c.all_sizes_fit) {
    return Error{"layers drawn by draw_layer must have " + std::to_string(c.renderer->width()) + " x " +
                 std::to_string(c.renderer->height()) + " pixels"};
  }
  if (settings.sky) {
    c.renderer->drawSky(view, c.sky);
    compositeOver(picture, c.sky);
  }
  return stats;
}

std::span<const std::uint32_t> LayerCompositor::unorderedGroups() const {
  return impl_->unordered_groups;
}

}  // namespace sightline
