#pragma once

// From a sorted frame to its picture: each layer drawn alone, then composited by the compiled program.

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "sightline/base/result.h"
#include "sightline/layers/compositing.h"
#include "sightline/render/layer_renderer.h"

namespace sightline {

// An image put in place of a layer (an external stream on a proxy).
struct LayerReplacement {
  LayerId layer{};
  const LayerImage* image = nullptr;  // of the renderer's size
};

struct CompositeSettings {
  // Which layers are peeled (LayerDraw::peel).
  enum class Peel : std::uint8_t {
    kNever,
    // Layers whose own order is not known: of several parts of which some are blended, or of one blended part
    // whose surface may lie over itself (pieces of convex surfaces, fronts outwards, and flat ones do not). A
    // group of several layers of which some are blended is drawn as one layer: where a circle covers a pixel,
    // expressions are wrong. If a layer of it is replaced, they are used nevertheless: a foreign image cannot
    // be peeled.
    kWhereNeeded,
  };
  Peel peel = Peel::kWhereNeeded;
  CompositingForm form = CompositingForm::kCheapest;
  bool sky = true;                  // behind everything
  std::vector<LayerId> left_out{};  // others than the frame's do not matter; before `replaced`
  std::vector<LayerReplacement> replaced{};
  // Draws a layer's image, of the renderer's size, in place of LayerRenderer::draw (depth of field, motion
  // blur, reuse). Empty: draw().
  std::function<void(std::span<const ObjectId> objects, const LayerDraw& how, LayerImage& image)> draw_layer;
};

struct CompositeStats {
  std::uint32_t layers = 0;            // drawn; a group that is peeled as one layer counts once
  std::uint32_t peeled = 0;            // of them
  std::uint32_t unordered_groups = 0;  // see LayerCompositor::unorderedGroups
  std::uint64_t triangles = 0;         // sent to OpenGL; none of what draw_layer draws
  CompositingCounts operations{};
};

// Part i of the order is object i of the renderer's scene. Holds the images of one group at a time. For one
// thread at a time.
class LayerCompositor {
 public:
  // scene: what the renderer was made of, for materials and shapes; kept as copies of what is needed. The
  // renderer must stay where it is, and outlive this. Time: of each blended mesh, its triangles squared.
  LayerCompositor(const SceneView& scene, LayerRenderer& renderer);
  ~LayerCompositor();
  LayerCompositor(LayerCompositor&&) noexcept;
  LayerCompositor& operator=(LayerCompositor&&) noexcept;

  // picture: of the renderer's size afterwards, without depths. layers: as LayerMerger gives them
  // (checkLayers). No allocation of pictures after warm-up.
  // Errors: a replacement of another size or of a layer that is not there; a part that is no object; an image
  // of draw_layer of another size.
  Result<CompositeStats> composite(const View& view, const FrameLayers& layers,
                                   const CompositeSettings& settings, LayerImage& picture);

  // Of the last picture: the frame's groups of which several parts were drawn and some of them were blended,
  // which no order gets right. Ascending; valid until the next picture.
  std::span<const std::uint32_t> unorderedGroups() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sightline
