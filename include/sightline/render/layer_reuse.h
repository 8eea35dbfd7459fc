#pragma once

// Saved rendering: images of layers drawn in one frame, moved and warped for the next ones.
//
// A layer's image is drawn once, cropped, and kept with characteristic points of its objects. In later frames
// the points, moved with the objects and seen from where the eye is then, say by which map of the picture the
// image follows best, and how well. It is drawn anew where that is not well enough.
//
// Based on: Snyder, Lengyel. MSR-TR-97-11, 1997, section 12.2. Lengyel, Snyder. Rendering with Coherent
// Layers. SIGGRAPH 1997 (warps fitted to characteristic points; geometric, sampling,
// visibility and photometric errors).
// Differs from the second in: warps may be projective; images are drawn when their error is too large, not in
// the order of errors until a frame's time is used up; the photometric error is bounded by how far objects
// have turned.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sightline/layers/compositing.h"
#include "sightline/render/layer_renderer.h"

namespace sightline {

// Which maps of the picture an image may follow.
enum class ReuseWarp : std::uint8_t {
  kAffine,
  kProjective,  // affine where that does, else projective: what is flat or far away stays true in turns
};

struct ReuseSettings {
  double tolerance_px = 1.0;        // a warp that moves a characteristic point wrongly by more is not used
  std::uint32_t max_frames = 1000;  // an image is drawn anew after so many
  // The renderer's pictures are larger than the frames by so many pixels on each side (their images: as many
  // smaller than LayerRenderer::width() and height()): what is there when an image is drawn may come into
  // view later. At most what leaves one pixel.
  std::uint32_t guard_px = 0;
  ReuseWarp warp = ReuseWarp::kProjective;
  double max_stretch = 1.3;  // an image is not stretched or shrunk by more than this factor
  // Radians by which an object may have turned in the scene since it was drawn: its light and shade are those
  // of then.
  double max_turn = 0.1;
};

struct ReuseStats {
  std::uint64_t layers = 0, drawn = 0;               // visible layers; of them drawn anew
  std::uint64_t triangles = 0, drawn_triangles = 0;  // the same by triangles
  double largest_error_px = 0.0;                     // of the warps used
};

// Keeps the last drawn image of every layer, by its objects, while it is asked for frame after frame. Drawn
// anew is a layer
//  - of other objects than any of the frame before,
//  - whose warp is wrong by more than the tolerance, stretches it too much, or comes from an image too old,
//  - one of whose objects has turned too far,
//  - of which something comes into view that was outside the drawn picture,
//  - that crosses the near or the far plane,
//  - when the view's kind or its near or far distance changes, or whether it is peeled,
//  - of which depths are asked for, that is drawn as given (LayerDraw::as_given), or that is seen from beside
//    the lens's middle: these are not reused,
//  - with a transform that is not finite, or in such a view.
// With a tolerance of 0 everything is drawn but what has not moved at all, nor the view. The largest
// deviation is measured at the characteristic points, up to 26 an object: farthest vertices in as many
// directions, of an object that is partly outside the picture those of the part inside. Between them, and
// where a layer hides parts of itself, nothing is promised. For one thread at a time.
class LayerReuse {
 public:
  // scene: what the renderer was made of; kept as a copy of what is needed. The renderer stays the caller's,
  // and must outlive this.
  LayerReuse(const SceneView& scene, LayerRenderer& renderer, const ReuseSettings& settings);
  ~LayerReuse();
  LayerReuse(LayerReuse&&) noexcept;
  LayerReuse& operator=(LayerReuse&&) noexcept;

  // Once a frame, before image(): the objects' places, as LayerRenderer::setTransforms takes them, which is
  // called with them.
  void beginFrame(const View& view, std::span<const Mat4> scene_from_stored);
  // The image of the layer of these objects (as LayerRenderer::draw takes them): warped from the last one
  // drawn, or drawn. Of the frame's size. A layer outside the view is transparent, and costs neither.
  void image(std::span<const ObjectId> objects, const LayerDraw& how, LayerImage& image);

  std::uint32_t width() const;  // of the frames, pixels
  std::uint32_t height() const;
  const ReuseStats& stats() const;  // of all frames

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sightline
