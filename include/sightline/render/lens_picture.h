#pragma once

// Pictures of sorted frames with depth of field and motion blur: from layers that are blurred one by one,
// from a single picture that is blurred by depth, and, as the reference, by accumulating whole pictures.
//
// Based on: Snyder, Lengyel. MSR-TR-97-11, 1997, section 10. Potmesil, Chakravarty 1981; Rokita 1993; Max,
// Lerner. A Two-and-a-Half-D Motion-Blur Algorithm. 1985. Haeberli, Akeley. The Accumulation Buffer. 1990.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "sightline/base/result.h"
#include "sightline/layers/compositing.h"
#include "sightline/math/mat4.h"
#include "sightline/render/depth_of_field.h"
#include "sightline/render/layer_compositor.h"
#include "sightline/render/layer_renderer.h"
#include "sightline/scene/camera.h"
#include "sightline/scene/scene.h"

namespace sightline {

enum class LensMethod : std::uint8_t {
  // One picture of everything, each pixel spread by its depth. It lacks what is hidden. What arrives at a
  // pixel is divided by the opacity that arrives there (Potmesil).
  kSingleNormalised,
  // The same, left as it arrives: dark where little does (Rokita).
  kSingleUnnormalised,
  // Each layer is blurred by itself, then composited: what lies behind a blurred edge is known.
  kLayers,
  // The mean of whole pictures from points of the lens at times of the shutter: the reference.
  kAccumulation,
};

// How one layer is blurred.
enum class LayerBlur : std::uint8_t {
  kAutomatic,   // chosen by how much the circle of confusion varies over the layer's visible pixels
  kEven,        // all pixels alike, by the mean of their circles of confusion
  kByDepth,     // each pixel by its own depth
  kAccumulate,  // the mean of images of this layer from points of the lens
};

struct PartBlur {
  PartId part{};
  LayerBlur blur = LayerBlur::kAutomatic;
};

// For motion blur: where everything is in the next frame. LayerRenderer::transforms() say where it is in this
// one. Everything is taken to move in straight lines, from half the shutter's time before this frame to half
// of it after.
struct FrameMotion {
  View later = {};  // the view of the next frame, of the same handedness
  // scene_from_stored in the next frame, one for each object; empty: all are as stored.
  std::span<const Mat4> later_stored = {};
  double shutter = 0.5;  // share of a frame's time that the shutter is open, 0 to 1
};

struct LensSettings {
  LensMethod method = LensMethod::kLayers;
  Lens lens{};                // with aperture 0 everything is sharp, for motion blur alone
  std::uint32_t passes = 21;  // passes of accumulation, at least 1
  // kAutomatic chooses by the range, in pixels, of the circles of confusion of a layer's pixels (negative
  // before the focus): up to the first value kEven, beyond the second kAccumulate, between them kByDepth.
  double even_within_px = 1.0;
  double accumulate_beyond_px = 8.0;
  // Choices for the layers that hold these parts; of several entries for one layer the last one counts. The
  // blur of other layers is chosen automatically.
  std::vector<PartBlur> parts = {};
  std::optional<FrameMotion> motion = {};  // if empty nothing moves; kLayers and kAccumulation only
  CompositeSettings::Peel peel = CompositeSettings::Peel::kWhereNeeded;
  CompositingForm form = CompositingForm::kCheapest;
  bool sky = true;  // behind everything, blurred as at infinity (in orthographic views it stays sharp)
  // Called after each pass or layer with the share of them that is drawn, ascending to 1.
  std::function<void(double done)> progress = {};
};

struct LensStats {
  std::uint32_t layers = 0;                               // layers that show in the picture; kLayers only
  std::uint32_t even = 0, by_depth = 0, accumulated = 0;  // how many of them were blurred in which way
  std::uint32_t moved = 0;                                // how many of them were spread along a line
  std::uint64_t render_passes = 0;  // images of objects drawn, each of one layer or of all
  std::uint64_t triangles = 0;      // triangles sent for them
};

// Draws frames whose part i is object i of the renderer's scene. For one thread at a time.
//
// Limits of kLayers: each layer is drawn from the lens's middle at the shutter's middle, so what it hides of
// itself is missing where a blur should show it, unless the layer is accumulated. The order is that of the
// layers given: LayerSorter::update() takes the eyes of a whole lens, and sweptHull() the parts' motion.
// Surfaces outside the picture are not drawn and not blurred into it; what is not in the picture at the
// shutter's middle is missing. Motion blur moves a layer as a whole, as the middle of its visible pixels
// moves on the screen: turning, growing and bending are lost, and edges of layers that move together do not
// hide the same things at all times. kAccumulate draws the layer at its places in time and loses nothing of
// its own motion.
//
// The renderer's transforms must be those of the frame (setTransforms); with motion others are set during
// draw(), and these again at its end.
class LensPicture {
 public:
  // scene is the one that the renderer was made of; it is not needed afterwards. The renderer must outlive
  // this.
  LensPicture(const SceneView& scene, LayerRenderer& renderer);
  ~LensPicture();
  LensPicture(LensPicture&&) noexcept;
  LensPicture& operator=(LensPicture&&) noexcept;

  // Draws the picture, without depths. With a sky it is opaque; kSingleUnnormalised's is then composited over
  // black. Errors: no passes; a part of the layers or of settings.parts that is no object; kLayers with a
  // depth-buffered layer (FrameLayers::depth_buffered); motion with a single picture, with a wrong number of
  // transforms, or with a shutter outside 0 to 1.
  Result<LensStats> draw(const View& view, const FrameLayers& layers, const LensSettings& settings,
                         LayerImage& picture);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sightline
