#pragma once

// Depth pyramid: a hierarchical depth buffer of occluders, made for testing many boxes at once.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sightline/base/parallel_for.h"
#include "sightline/occluders/occluder_set.h"
#include "sightline/occlusion/rasteriser.h"
#include "sightline/occlusion/visibility.h"
#include "sightline/scene/camera.h"

namespace sightline {

struct DepthPyramidSettings {
  RasterSettings raster{};
};

inline constexpr std::uint32_t kManyPixels = 0xffffffffu;  // see DepthPyramid::openPixels

struct BoxAnswer {
  Visibility visibility = Visibility::kVisible;
  bool within_view = false;    // all of the box surely lies in the view's volume
  bool on_buffer = false;      // its rectangle in the depth buffer is known
  std::uint16_t x = 0, y = 0;  // with on_buffer: the middle of that rectangle, pixels
};

// A pixel of a depth buffer; the lowest row comes first.
struct BufferPixel {
  std::uint16_t x = 0, y = 0;
  friend bool operator==(const BufferPixel&, const BufferPixel&) = default;
};

// What a caller knows of boxes that are tested view after view.
struct BoxHints {
  // Empty, or one value for each box. Other than 0: the box was not hidden a short while ago and is not to be
  // tested again yet; it is kPartial unless it is wholly outside the view.
  std::span<const std::uint8_t> retest_delay{};
  // For boxes from this index on, kVisible and kPartial need not be told apart.
  std::size_t plain_from = static_cast<std::size_t>(-1);
  // Empty, or one value for each box. Other than 0: the box is surely not hidden, as
  // DepthPyramid::seesPoints() tells, so that only kVisible and kPartial have to be told apart.
  std::span<const std::uint8_t> not_hidden{};
  // Empty, or a point for each box. Where a box is found not to be hidden, this mostly becomes a point of it
  // that seesPoints() sees, also in the views that follow; else it stays as it is.
  std::span<Vec3f> seen_points{};

  // Returns the hints for `count` boxes from the index `first` on.
  BoxHints from(std::size_t first, std::size_t count) const {
    BoxHints part = *this;
    part.retest_delay = retest_delay.empty() ? retest_delay : retest_delay.subspan(first, count);
    part.plain_from = plain_from > first ? plain_from - first : 0;
    part.not_hidden = not_hidden.empty() ? not_hidden : not_hidden.subspan(first, count);
    part.seen_points = seen_points.empty() ? seen_points : seen_points.subspan(first, count);
    return part;
  }
};

// Tells for many boxes whether the drawn occluders hide them. It can be used alone: build() from any
// occluders, then classify() boxes at any time.
//
// With the conservative coverage rule answers are conservative: kHidden only where no point of the box can be
// seen from the view's eye. kVisible means that nothing in the depth buffer is before any part of the box.
// Wherever its rectangle leaves doubt, a box is compared by its own outline and depth in each pixel. Between
// begin() and finish(), and before the first view, nothing is hidden but what lies outside the view.
//
// After finish() several threads may classify; all other functions are for one thread at a time. Nothing is
// allocated once the storage has grown to what a few builds need.
class DepthPyramid {
 public:
  explicit DepthPyramid(const DepthPyramidSettings& settings = {});
  ~DepthPyramid();
  DepthPyramid(DepthPyramid&&) noexcept;
  DepthPyramid& operator=(DepthPyramid&&) noexcept;

  void build(const View& view, const OccluderSet& set, std::span<const OccluderId> chosen,
             const ParallelFor& parallel_for = serialFor);
  // Builds in steps: begin() a view, draw() any number of occluders, also of several sets, then finish().
  // viewers: as in Rasteriser::begin(): what classify() then calls hidden is hidden from all of these, as far
  // as it lies in the view's volume.
  void begin(const View& view, const ViewerRegion& viewers = {});
  void draw(const OccluderSet& set, std::span<const OccluderId> chosen,
            const ParallelFor& parallel_for = serialFor);
  void reserve(const SurfaceSet& surfaces);  // see Rasteriser
  void draw(const SurfaceSet& surfaces, std::span<const ObjectId> candidates,
            const SurfaceDrawing& drawing = {}, const ParallelFor& parallel_for = serialFor);
  SurfaceStats draw(const MovingSurfaces& surfaces, std::span<const ObjectId> candidates,
                    const SurfaceDrawing& drawing, const ParallelFor& parallel_for = serialFor);
  SurfaceStats draw(const MovingSurfaces& moving, const SurfaceDrawing& drawing = {},
                    const ParallelFor& parallel_for = serialFor);
  void finish(const ParallelFor& parallel_for = serialFor);

  // Classifies boxes in scene space as seen in the last view. answers: as many as boxes. Boxes that are not
  // well formed are kPartial or kVisible, those that reach the near plane kHidden or kPartial. Boxes that are
  // wholly outside the view are kHidden.
  void classify(std::span<const Box> boxes, std::span<BoxAnswer> answers, const BoxHints& hints = {}) const;
  Visibility classify(const Box& box) const;
  // Sets seen[i] to 1 where nothing in the depth buffer is before points[i], which surely lies in the view's
  // volume, else to 0. classify() calls no box hidden that contains such a point. seen: as many as points.
  void seesPoints(std::span<const Vec3f> points, std::span<std::uint8_t> seen) const;
  // Classifies by the view's volume alone, as if nothing were drawn: kHidden for boxes that are wholly
  // outside, kVisible or kPartial for all others.
  void classifyInView(std::span<const Box> boxes, std::span<BoxAnswer> answers) const;

  // The pixels in which boxes are not surely hidden. counts: as many as boxes; box by box, the pixels are
  // appended. A count is kManyPixels, and no pixel is appended, where there are more than `max` of them, and
  // for a box that is not well formed or reaches the near plane. A box without any is hidden.
  void openPixels(std::span<const Box> boxes, std::uint32_t max, std::span<std::uint32_t> counts,
                  std::vector<BufferPixel>& pixels) const;

  // The number of levels; level 0 is the depth buffer itself.
  std::uint32_t levels() const;
  DepthBufferView depthBuffer() const;
  const RasterStats& stats() const;  // of its depth buffer
  const SurfaceStats& surfaceStats() const;
  std::span<const OccluderId> occluders() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sightline
