#pragma once

// Draws any of a scene's objects alone to a picture with opacity, by headless OpenGL.
//
// Shading is Renderer's in linear light, so opaque objects over the sky equal Renderer's picture within one
// step of eight bits. Blended surfaces differ, because Renderer blends square roots.

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sightline/base/ids.h"
#include "sightline/base/result.h"
#include "sightline/layers/cycle_splitter.h"
#include "sightline/math/mat4.h"
#include "sightline/render/layer_image.h"
#include "sightline/scene/scene.h"

namespace sightline {

struct LayerRendererOptions {
  // Size of the pictures in pixels, each 1 to 8192. Times `samples` it must not exceed OpenGL's largest
  // texture (at least 16384).
  std::uint32_t width = 1280, height = 720;
  // Samples along each side of a pixel: 1, 2 or 4. Colours are averaged premultiplied and in linear light; a
  // pixel's depth is that of its nearest sample. Holes of alpha-tested objects are whole pixels.
  std::uint32_t samples = 1;
  // Makes objects of one material differ a little in lightness, as in Renderer's pictures. Without tints a
  // surface that several objects share looks the same whichever of them is drawn.
  bool tints = true;
};

// A point of a thin lens from which a picture is drawn, sheared so that points at the focus distance stay in
// place: a point at depth z moves by (right, up) * (z / focus - 1) across the line of sight. In orthographic
// views all rays are turned by the same angle.
struct LensPoint {
  double right = 0.0, up = 0.0;  // metres from the eye, along the view's axes
  double focus = 1.0;            // metres along forward, > 0; ignored if right and up are 0
};

// A piece of an object (CycleSplitter), by a number that no object has.
struct ObjectPiece {
  ObjectId piece{}, object{};
  std::vector<PieceSide> sides{};  // planes in scene space, at most kMaxPieceSides; more are ignored
};

struct LayerDraw {
  // Composites blended surfaces in the order of depth, pixel by pixel, however many lie over each other;
  // those of equal depth in the order of ids and triangles. Their triangles are sent twice for each peel.
  // Otherwise they are drawn over the opaque ones in the order of the objects' ids and triangles.
  bool peel = false;
  // Without peeling, draws the objects of each pass (opaque, alpha-tested, blended) in the order in which
  // they are given, not by their ids. Pieces come after all whole objects, in the order of their numbers.
  bool as_given = false;
  // Also fills LayerImage::depths with the depth of the nearest surface, opaque or not. Depths err by a few
  // units in the last place; in orthographic views by as much of the far distance, and where that is
  // infinite they are all the near distance.
  bool depths = false;
  // Leaves out what is behind the surfaces that the last hideBehind() drew, which must have had the same view
  // and lens. Where those are nearest, LayerImage::depths has their depths.
  bool hidden = false;
  LensPoint lens{};
};

struct LayerDrawStats {
  std::uint64_t triangles = 0;  // sent to OpenGL in all passes
  // 1, or the number of peels (at least 1): the largest number of depths at a sample.
  std::uint32_t passes = 0;
};

// Owns an OpenGL context and the scene's triangles in it. Movable. Used by one thread at a time; the caller's
// current context stays current.
class LayerRenderer {
 public:
  // Uploads the scene, whose memory is not needed afterwards. Error, with the reason, if there is no
  // OpenGL 4.3 with ARB_clip_control without a window, or if the scene does not fit.
  static Result<LayerRenderer> create(const SceneView& scene, const LayerRendererOptions& options);
  ~LayerRenderer();
  LayerRenderer(LayerRenderer&&) noexcept;
  LayerRenderer& operator=(LayerRenderer&&) noexcept;

  // Sets the affine transforms of the objects, from stored positions to scene space, one for each object.
  // Objects beyond the end of the list are drawn as stored. Identities change no bit of a picture. A
  // transform may mirror: fronts stay fronts. An object whose transform is not finite is not drawn.
  void setTransforms(std::span<const Mat4> scene_from_stored);
  // Those that are set, one for each object; empty where all are drawn as stored. Valid until the next
  // setTransforms(), which LensPicture::draw() calls too where things move.
  std::span<const Mat4> transforms() const;

  // Sets the pieces that may be drawn from now on; their objects may still be drawn whole. With one sample
  // for each pixel, each sample of an object is in exactly one of its pieces, if they fill space, and has the
  // same bits in it as in the object.
  void setPieces(std::vector<ObjectPiece> pieces);
  // The object of a piece; any other number is its own.
  ObjectId objectOf(ObjectId object_or_piece) const;

  // Draws these objects and pieces alone over transparency. Ids may come in any order; repeated ones count
  // once, those that the scene lacks are ignored. A surface's pixels do not depend on what else is drawn,
  // except where that hides it. So with one sample for each pixel, layers composited in a correct order equal
  // the picture of all objects: bit for bit if all are opaque, else up to the rounding of floats. Beside the
  // triangles, the cost grows with the rectangle of pixels that the objects cover.
  LayerDrawStats draw(const View& view, std::span<const ObjectId> objects, const LayerDraw& how,
                      LayerImage& image);

  // Draws the opaque and the alpha-tested ones of these objects to a depth buffer that draw() uses with
  // LayerDraw::hidden. Returns the number of triangles sent to OpenGL.
  std::uint64_t hideBehind(const View& view, std::span<const ObjectId> objects, const LensPoint& lens = {});

  // Draws the sky, which is opaque and has no depths.
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
