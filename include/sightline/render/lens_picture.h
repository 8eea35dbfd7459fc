#pragma once

// Pictures of sorted frames with depth of field and motion blur: from layers that are blurred one by one,
// from a single picture as others do it, and the reference by accumulating whole pictures.
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
  // One picture of everything, blurred by depth. What another thing hides is not known in it. Divided by the
  // opacity that arrives (Potmesil), or as it arrives, dark where little does (Rokita).
  kSingleNormalised,
  kSingleSpread,
  // Each layer blurred by itself, then composited: what is behind a blurred edge is known.
  kLayers,
  // The mean of whole pictures from points of the lens, and of the shutter's time: the reference.
  kAccumulation,
};

// How one layer is blurred.
enum class LayerBlur : std::uint8_t {
  kAutomatic,   // by how much the circle of confusion varies over what is seen of the layer
  kEven,        // as at its middle depth (the mean of the circles of its pixels)
  kByDepth,     // each pixel by its own depth
  kAccumulate,  // the mean of images of this layer from points of the lens
};

struct PartBlur {
  PartId part{};
  LayerBlur blur = LayerBlur::kAutomatic;
};

// From one frame to the next one: where everything goes, for motion blur. What moves is taken to move in
// straight lines, from half a shutter's time before this frame to half of it after.
struct FrameMotion {
  View later = {};                          // the view of the next frame
  std::span<const Mat4> stored = {};        // scene_from_stored in this frame, one an object; none: as stored
  std::span<const Mat4> later_stored = {};  // in the next one
  double shutter = 0.5;                     // how long it is open, as a share of a frame's time, 0 to 1
};

struct LensSettings {
  LensMethod method = LensMethod::kLayers;
  Lens lens{};                // aperture 0: everything sharp, for motion blur alone
  std::uint32_t passes = 21;  // of accumulation, at least 1
  // Automatic choice, by the largest less the smallest circle of confusion of a layer's pixels (before the
  // focus and behind it counted apart): up to the first even, beyond the second accumulated, between them by
  // depth. Pixels.
  double even_within_px = 1.0;
  double accumulate_beyond_px = 8.0;
  std::vector<PartBlur> parts = {};  // chosen by hand: for the layer that holds the part; of several parts of
                                     // one layer the last entry's. Other layers are chosen for automatically
  std::optional<FrameMotion> motion = {};  // none: nothing moves. Of kLayers and kAccumulation only
  CompositeSettings::Peel peel = CompositeSettings::Peel::kWhereNeeded;
  CompositingForm form = CompositingForm::kCheapest;
  bool sky = true;  // behind everything, blurred as at infinity (as it is in orthographic views)
  // Called after each pass, or layer, with the share of them that is drawn, ascending to 1.
  std::function<void(double done)> progress = {};
};

struct LensStats {
  std::uint32_t layers = 0;                               // with something in the picture; kLayers only
  std::uint32_t even = 0, by_depth = 0, accumulated = 0;  // of them
  std::uint32_t moved = 0;                                // of them, spread along a line
  std::uint64_t render_passes = 0;                        // images of objects drawn: of one layer, or of all
  std::uint64_t triangles = 0;                            // in them
};

// What layers cannot do. Each is drawn from the lens's middle and at the shutter's middle: what it hides of
// itself is missing where a blur should show it, unless it is accumulated. The order is that of the middle,
// too. What is outside the picture is not drawn, and so not blurred into it. Motion blur by layers takes a
// layer to move as a whole, as the middle of what is seen of it moves on the screen: turning, growing and
// bending are lost, and so is that edges of layers that move together hide the same things at all times;
// kAccumulate draws the layer at its places in time and loses nothing of its own motion. What is not in the
// picture at the shutter's middle is not there at all.
//
// Part i of the order is object i of the renderer's scene. The renderer's transforms are those of the frame
// (setTransforms); with motion they are set from it, and are the frame's again afterwards. For one thread at
// a time.
class LensPicture {
 public:
  // scene: what the renderer was made of, not needed afterwards. renderer: outlives this.
  LensPicture(const SceneView& scene, LayerRenderer& renderer);
  ~LensPicture();
  LensPicture(LensPicture&&) noexcept;
  LensPicture& operator=(LensPicture&&) noexcept;

  // picture: opaque with a sky; kSingleSpread's is then as over black. Without depths.
  // Errors: no passes; a part of the layers or of settings.parts that is no object; motion with a single
  // picture, with transforms that are not one an object, or with a shutter outside 0 to 1.
  Result<LensStats> draw(const View& view, const FrameLayers& layers, const LensSettings& settings,
                         LayerImage& picture);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sightline
