#pragma once

// Draws any of a scene's objects alone, to a picture with opacity, by headless OpenGL.
//
// Shading is Renderer's, in linear light; so the picture of opaque objects over the sky is Renderer's within
// a step of eight bits. Blended surfaces differ from it: it blends square roots.

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "sightline/base/ids.h"
#include "sightline/base/result.h"
#include "sightline/math/mat4.h"
#include "sightline/render/layer_image.h"
#include "sightline/scene/scene.h"

namespace sightline {

struct LayerRendererOptions {
  // Of the pictures, pixels, 1 to 8192; times `samples` no more than OpenGL's largest texture (16384 at
  // least).
  std::uint32_t width = 1280, height = 720;
  // A side of each pixel: 1, 2 or 4. Colours are averaged, premultiplied and linear; the depth is that of the
  // nearest sample. Holes of alpha-tested objects are whole pixels.
  std::uint32_t samples = 1;
  // Objects of one material differ a little in lightness, as in Renderer's pictures. false: the materials'
  // colours alone, so that a surface that several objects share looks alike, whichever of them is drawn.
  bool tints = true;
};

// A point of a thin lens. The picture is drawn from there, sheared so that what lies at the focus distance
// stays where it is: a point at depth z moves by (right, up) * (z / focus - 1) across the line of sight. In
// orthographic views all rays are turned by the same angle.
struct LensPoint {
  double right = 0.0, up = 0.0;  // metres from the eye, along the view's axes
  double focus = 1.0;            // metres along forward, > 0; does not matter where right and up are 0
};

struct LayerDraw {
  // Blended surfaces: false, drawn over the opaque ones in the order of the objects' ids and triangles. True,
  // peeled: composited in the order of depth, pixel by pixel, however many lie over each other; those of
  // equal depth in the order of ids and triangles. They are sent twice for each peel.
  bool peel = false;
  // Without peeling: objects are drawn in the order in which they are given, not by their ids (those of each
  // pass: opaque, alpha-tested, blended).
  bool as_given = false;
  // LayerImage::depths too; of the nearest surface, opaque or not. Their error is a few units of a float's
  // last place; in orthographic views, of the far distance.
  bool depths = false;
  LensPoint lens{};
};

struct LayerDrawStats {
  std::uint64_t triangles = 0;  // sent to OpenGL, all passes
  std::uint32_t passes = 0;     // 1, or peels (at least 1): the most depths of one sample
};

// Owns an OpenGL context of its own and the scene's triangles in it. Movable; used by one thread at a time; a
// context of the caller's that is current stays so.
class LayerRenderer {
 public:
  // Uploads the scene, whose memory is not needed afterwards. Fails, with the reason, where no OpenGL 4.3
  // with ARB_clip_control can be had without a window, or where the scene does not fit.
  static Result<LayerRenderer> create(const SceneView& scene, const LayerRendererOptions& options);
  ~LayerRenderer();
  LayerRenderer(LayerRenderer&&) noexcept;
  LayerRenderer& operator=(LayerRenderer&&) noexcept;

  // Where the objects are from now on: scene space from the stored positions, affine, one an object; those
  // beyond the list are as stored, with an empty list all. Identities change no bit of a picture. A transform
  // may mirror: fronts stay fronts. An object whose transform is not finite is not drawn.
  void setTransforms(std::span<const Mat4> scene_from_stored);

  // The objects alone (ids in any order; repeated ones count once, others than the scene's not at all),
  // transparent where there is none of them. What a pixel shows does not depend on what else is drawn with
  // it, but for what hides it; so layers composited in a right order are the picture of all objects, where
  // each pixel has one sample: bit for bit where all are opaque, else to the rounding of floats. What it
  // costs besides the triangles goes with the rectangle of pixels that the objects cover.
  LayerDrawStats draw(const View& view, std::span<const ObjectId> objects, const LayerDraw& how,
                      LayerImage& image);

  // What is behind everything: opaque, without depths.
  void drawSky(const View& view, LayerImage& image);

  std::uint32_t width() const;
  std::uint32_t height() const;
  std::string device() const;

 private:
  struct Impl;
  explicit LayerRenderer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace sightline
