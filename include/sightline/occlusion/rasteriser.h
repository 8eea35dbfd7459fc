#pragma once

// A conservative rasteriser: which pixels of a depth buffer occluders cover, and how near they surely are.

#include <cstdint>
#include <limits>
#include <memory>
#include <span>

#include "sightline/base/parallel_for.h"
#include "sightline/math/box.h"
#include "sightline/occluders/occluder_set.h"
#include "sightline/occluders/surface_set.h"
#include "sightline/scene/camera.h"
#include "sightline/scene/viewer_region.h"

namespace sightline {

namespace occlusion {
struct BufferPolygons;
struct RasterBand;
}  // namespace occlusion

// A way to decide which pixels polygons cover, in place of the conservative one; such as centreCoverage() of
// sightline/comparison/centre_coverage.h (not installed). Implemented in the library only: private headers
// define its arguments.
class CoverageRule {
 public:
  // Draws polygons into a band of rows. Polygons are given as they are, each alone: bodies are not drawn as
  // one and no edges are shared. order: indices into polygons.polygons, the nearest first. Called once for
  // each band, by several threads at a time.
  virtual void draw(const occlusion::BufferPolygons& polygons, std::span<const std::uint32_t> order,
                    const occlusion::RasterBand& band) const = 0;

 protected:
  ~CoverageRule() = default;
};

// Values out of range are clamped.
struct RasterSettings {
  // Pixels, 1 to kMaxBufferSize each; of any aspect, for pixels need not be square.
  std::uint32_t width = 320, height = 180;
  // Null: the conservative rule. A pixel is covered only where all of it is: by one occluder, or by several
  // that share edges of the mesh. Its depth is their farthest over the whole pixel. Other rules must outlive
  // the settings, and may hide what can be seen.
  const CoverageRule* coverage = nullptr;
};
inline constexpr std::uint32_t kMaxBufferSize = 8192;

// The reciprocal depth of a pixel that nothing covers.
inline constexpr float kUncovered = -std::numeric_limits<float>::max();

// A view of a depth buffer; the lowest row comes first. It is valid until the buffer is drawn again.
struct DepthBufferView {
  // height rows of stride values; greater is nearer. 1 / depth (1 / metres), orthographic -depth (metres).
  std::span<const float> reciprocal_depth{};
  std::uint32_t width = 0, height = 0;
  std::uint32_t stride = 0;  // from one row to the next; values beyond the width have no meaning

  float at(std::uint32_t x, std::uint32_t y) const { return reciprocal_depth[std::size_t{y} * stride + x]; }
  bool covered(std::uint32_t x, std::uint32_t y) const { return at(x, y) > kUncovered; }
  std::span<const float> row(std::uint32_t y) const {
    return reciprocal_depth.subspan(std::size_t{y} * stride, width);
  }
};

// What a view has to do with the one before.
enum class ViewStep : std::uint8_t {
  kJump,  // nothing
  kNext,  // it follows: what changed few pixels of late rests for a few views
  kSame,  // it is the same view: what is drawn in it is not drawn again
};

// Which surfaces are worth drawing, and how many. Whatever the values are, what is covered is hidden.
struct SurfaceLimits {
  double min_pixels = 100.0;        // parts whose rectangle in the buffer has fewer pixels are left out
  double min_patch_pixels = 150.0;  // patches with fewer are drawn only together with the rest of their part
  // Surfaces whose rectangle has fewer pixels for each edge of their boundary are left out: they hardly cover
  // any.
  double pixels_per_edge = 4.0;
  // Surfaces are drawn, the nearest ones first, until they have cost so much: 1 for each edge of their
  // boundaries, 1 for each tile of 32 x 8 pixels, and 8 for each time that some are drawn together.
  std::uint32_t budget = 60000;
};

// What a draw() of surfaces draws. Whatever the values are, what is covered is hidden.
struct SurfaceDrawing {
  SurfaceLimits limits{};
  ViewStep step = ViewStep::kJump;  // from the view in which this set was drawn last
  bool draw_resting = false;        // what rests is drawn too
  // Empty, or boxes in scene space that are to be hidden: surfaces are drawn only where they are before one
  // of these and something of it is not hidden yet, and pixels count as changed where that is so.
  std::span<const Box> targets{};
  // Only what changed many pixels in the view before is drawn, the parts that changed most first. The
  // candidates are not looked at.
  bool useful_only = false;
};

// What a draw() of surfaces drew.
struct SurfaceStats {
  std::uint32_t groups = 0;  // of clusters that were drawn together
  std::uint32_t edges = 0;   // of their boundaries
  std::uint32_t work = 0;    // what they cost, as SurfaceLimits::budget counts it
  std::uint32_t gain = 0;    // pixels that became nearer by an eighth or more, before targets
};

struct RasterStats {
  std::uint32_t occluders = 0;  // occluders that were drawn, or are behind what was drawn
  // Chosen, but seen from behind, edge-on, wholly before the near plane, or outside the buffer.
  std::uint32_t unusable = 0;
  // Those of `occluders` that lie behind what was drawn before, or that cover no whole pixel.
  std::uint32_t hidden = 0;
};

// Draws occluders into a depth buffer; can be used alone. With the conservative rule a covered pixel
// promises: every point that projects into it, is not before the view's near plane and is farther than the
// stored depth is hidden from the eye by triangles of the occluders.
//
// Every instruction set and any number of threads give the same bits. Use by one thread at a time; nothing is
// allocated once the storage has grown to what a few frames need.
class Rasteriser {
 public:
  explicit Rasteriser(const RasterSettings& settings = {});
  ~Rasteriser();
  Rasteriser(Rasteriser&&) noexcept;
  Rasteriser& operator=(Rasteriser&&) noexcept;

  // Clears the buffer for a view. viewers: what surfaces then cover is hidden from all of these, too.
  // Occluders of an OccluderSet, which hide from the view's own eye only, are drawn if that is all of them.
  void begin(const View& view, const ViewerRegion& viewers = {});
  // Draws the chosen occluders. May be called several times, with the same set or others; shared edges are
  // watertight between occluders of one call. The set must outlive the call only.
  void draw(const OccluderSet& set, std::span<const OccluderId> chosen,
            const ParallelFor& parallel_for = serialFor);

  // Makes room for drawing these surfaces, in proportion to the set. Otherwise the first draw() of them takes
  // the time that this takes.
  void reserve(const SurfaceSet& surfaces);
  // Draws the surfaces of some objects, SurfaceSet::objects for all. With any coverage rule they are drawn
  // conservatively.
  void draw(const SurfaceSet& surfaces, std::span<const ObjectId> candidates,
            const SurfaceDrawing& drawing = {}, const ParallelFor& parallel_for = serialFor);

  // The same for surfaces in a space of their own.
  SurfaceStats draw(const MovingSurfaces& surfaces, std::span<const ObjectId> candidates,
                    const SurfaceDrawing& drawing, const ParallelFor& parallel_for = serialFor);

  // Draws all surfaces of a set that moves. The set must outlive the call only; it costs least where the same
  // one is drawn in each view. drawing.step has no effect. Returns what was drawn, as surfaceStats() does.
  SurfaceStats draw(const MovingSurfaces& moving, const SurfaceDrawing& drawing = {},
                    const ParallelFor& parallel_for = serialFor);

  const RasterSettings& settings() const;
  DepthBufferView depthBuffer() const;
  const RasterStats& stats() const;          // counts since begin()
  const SurfaceStats& surfaceStats() const;  // of the last draw() of surfaces with candidates
  // The chosen occluders that were drawn or are behind what was drawn, since begin(), draw by draw. A convex
  // body that was drawn as one is named by the first of its faces that was chosen.
  std::span<const OccluderId> occluders() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sightline
