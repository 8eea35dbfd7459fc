#pragma once

// Reuse of layers' images: drawn in one frame, moved and warped for the frames that follow.
//
// A layer's image is drawn once, cropped, and kept with characteristic points of its objects. In later frames
// a warp of the picture is fitted to the points, moved with the objects and projected from the new eye. The
// image is redrawn when the fit is not good enough.
//
// Based on: Snyder, Lengyel. MSR-TR-97-11, 1997, section 12.2. Lengyel, Snyder. Rendering with Coherent
// Layers. SIGGRAPH 1997 (warps fitted to characteristic points; geometric, sampling, visibility and
// photometric errors).
// Differs from the second in: warps may be projective; an image is redrawn when its error is too large,
// whereas the paper redraws in the order of errors until a frame's time is used up; the photometric error is
// bounded by how far objects have turned.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sightline/layers/compositing.h"
#include "sightline/render/layer_renderer.h"

namespace sightline {

// The kinds of warp that an image may be drawn with.
enum class ReuseWarp : std::uint8_t {
  kAffine,
  kProjective,  // affine if that suffices, else projective: follows flat and distant objects in turns
};

struct ReuseSettings {
  double tolerance_px = 1.0;        // the largest error of a characteristic point, in pixels
  std::uint32_t max_frames = 1000;  // an image is redrawn after so many frames
  // The width in pixels of a guard band on each side: frames are smaller than LayerRenderer::width() and
  // height() by twice as much, and what was drawn in the band may come into view later. Clamped so that one
  // pixel is left.
  std::uint32_t guard_px = 0;
  ReuseWarp warp = ReuseWarp::kProjective;
  double max_stretch = 1.3;  // an image is not stretched or shrunk by more than this factor
  // The angle in radians by which an object may have turned in the scene since it was drawn; its shading
  // stays that of then.
  double max_turn = 0.1;
};

struct ReuseStats {
  std::uint64_t layers = 0, drawn = 0;               // visible layers, and those of them that were drawn
  std::uint64_t triangles = 0, drawn_triangles = 0;  // the triangles of the same
  double largest_error_px = 0.0;                     // largest error of the warps used, in pixels
};

// Keeps the last drawn image of every layer, identified by its objects, as long as it is asked for in every
// frame. A layer is redrawn if
//  - no layer of the frame before had the same objects,
//  - its warp errs by more than the tolerance or stretches it too much, or its image is too old,
//  - one of its objects has turned too far,
//  - a part of it comes into view that was outside the drawn picture,
//  - it crosses the near or the far plane,
//  - the view's kind or its near or far distance has changed, or whether the layer is peeled,
//  - its depths are asked for, it is drawn as given (LayerDraw::as_given) or without what others hide of it
//    (LayerDraw::hidden), some of its objects are in pieces (LayerRenderer::setPieces), or it is seen from a
//    point of the lens other than the middle; such images are not kept either. What hides them must have been
//    drawn for the picture with its guard band, so LayerDraw::hidden needs guard_px = 0,
//  - one of its transforms or the view is not finite.
// With a tolerance of 0 an image is reused only if neither its objects nor the view have moved at all. Errors
// are measured at the characteristic points, up to 26 for each object: the farthest vertices in as many
// directions, and if an object is partly outside the picture, those of the part inside. Nothing is promised
// between these points and where a layer hides parts of itself. For one thread at a time.
class LayerReuse {
 public:
  // scene is the one that the renderer was made of; what is needed of it is copied. The renderer must outlive
  // this.
  LayerReuse(const SceneView& scene, LayerRenderer& renderer, const ReuseSettings& settings);
  ~LayerReuse();
  LayerReuse(LayerReuse&&) noexcept;
  LayerReuse& operator=(LayerReuse&&) noexcept;

  // Called once for each frame, before image(). Passes the transforms on to LayerRenderer::setTransforms.
  void beginFrame(const View& view, std::span<const Mat4> scene_from_stored);
  // The image, of the frame's size, of the layer of these objects (as LayerRenderer::draw takes them): warped
  // from the last one drawn, or drawn. A layer outside the view is transparent and costs neither.
  void image(std::span<const ObjectId> objects, const LayerDraw& how, LayerImage& image);

  std::uint32_t width() const;  // of the frames, in pixels
  std::uint32_t height() const;
  const ReuseStats& stats() const;  // of all frames so far

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sightline
