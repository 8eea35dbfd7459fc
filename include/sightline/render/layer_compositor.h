#pragma once

// Draws a sorted frame: each layer alone, then all of them composited by the compiled program.

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "sightline/base/result.h"
#include "sightline/layers/compositing.h"
#include "sightline/render/layer_renderer.h"

namespace sightline {

// An image that takes the place of a layer, such as a video on a proxy.
struct LayerReplacement {
  LayerId layer{};
  const LayerImage* image = nullptr;  // must have the renderer's size
};

// The images of one group of a frame and the steps that composited them. Valid during the call.
struct CompositedGroup {
  std::uint32_t first_layer = 0, end_layer = 0;  // the frame's layers that are in the group
  // One image for each of these layers, null for one that was left out; or a single image of all of them,
  // which were drawn together. Images that were drawn have depths; replacements have those of their own.
  std::span<const LayerImage* const> images{};
  // A program with images numbered from 0 (checkProgram). Its result lies behind the groups before it.
  std::span<const CompositingStep> steps{};
};

struct CompositeSettings {
  // Which layers are peeled (LayerDraw::peel).
  enum class Peel : std::uint8_t {
    kNever,
    // Peels a layer of several parts of which some are blended, and a layer of one blended part whose surface
    // may overlap itself (pieces of convex surfaces with their fronts outwards and flat ones do not). A group
    // of several layers of which some are blended is drawn as one layer, because compositing expressions are
    // wrong where a whole cycle covers a pixel. If one of its layers is replaced, expressions are used
    // nevertheless: an image cannot be peeled.
    kWhereNeeded,
  };
  Peel peel = Peel::kWhereNeeded;
  CompositingForm form = CompositingForm::kCheapest;
  bool sky = true;                  // draw the sky behind everything
  std::vector<LayerId> left_out{};  // not drawn, even if replaced; ids that the frame lacks are ignored
  std::vector<LayerReplacement> replaced{};
  // Called in place of LayerRenderer::draw for each layer's image (for depth of field, motion blur or reuse),
  // which must have the renderer's size. Empty: LayerRenderer::draw.
  std::function<void(std::span<const ObjectId> objects, const LayerDraw& how, LayerImage& image)> draw_layer;
  // Called for each group of which something was drawn, front to back, to keep its images (for a file of
  // layers). The sky is in none. Empty: nothing is kept, and no depths are drawn.
  std::function<void(const CompositedGroup& group)> keep_group;
};

struct CompositeStats {
  std::uint32_t layers = 0;            // layers drawn; a group that is peeled as one layer counts once
  std::uint32_t peeled = 0;            // those of them that were peeled
  std::uint32_t unordered_groups = 0;  // the number of LayerCompositor::unorderedGroups
  std::uint64_t triangles = 0;         // sent to OpenGL, except by draw_layer
  CompositingCounts operations{};
};

// Composites frames whose part i is object i of the renderer's scene, or one of its pieces
// (LayerRenderer::setPieces). Holds the images of one group at a time. For one thread at a time.
class LayerCompositor {
 public:
  // scene is the one that the renderer was made of; what is needed of its materials and shapes is copied. The
  // renderer must not be moved and must outlive this. Takes time proportional to the square of each blended
  // mesh's triangles, up to 8192 of them; larger meshes count as ones that may overlap themselves.
  LayerCompositor(const SceneView& scene, LayerRenderer& renderer);
  ~LayerCompositor();
  LayerCompositor(LayerCompositor&&) noexcept;
  LayerCompositor& operator=(LayerCompositor&&) noexcept;

  // Draws and composites a frame's layers, as LayerMerger gives them (checkLayers). picture gets the
  // renderer's size and no depths. Allocates no pictures after warm-up. Errors: a replacement of the wrong
  // size or of a layer that the frame lacks; a part that is no object; an image of the wrong size from
  // draw_layer.
  Result<CompositeStats> composite(const View& view, const FrameLayers& layers,
                                   const CompositeSettings& settings, LayerImage& picture);

  // The groups of the last frame of which several parts were drawn, some of them blended: no order draws them
  // correctly. Ascending; valid until the next picture.
  std::span<const std::uint32_t> unorderedGroups() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sightline
