#pragma once

// Depth pyramid: a hierarchical depth map of occluders, made for asking about many boxes at once.

#include <cstdint>
#include <memory>
#include <span>

#include "sightline/base/parallel_for.h"
#include "sightline/occluders/occluder_set.h"
#include "sightline/occlusion/rasteriser.h"
#include "sightline/occlusion/visibility.h"
#include "sightline/scene/camera.h"

namespace sightline {

struct DepthPyramidSettings {
  RasterSettings raster{};
};

struct DepthPyramidStats {
  RasterStats raster{};
};

struct BoxAnswer {
  Visibility visibility = Visibility::kVisible;
  bool within_view = false;    // all of it surely lies in the view's volume
  bool on_map = false;         // its rectangle in the map is known
  std::uint16_t x = 0, y = 0;  // then the middle of it, pixels
};

// What a caller who asks about the same boxes view after view knows of them.
struct BoxHints {
  // As many as boxes, or none. Not 0: the box was not hidden a short while ago, and is not looked for again:
  // kPartial unless it is wholly outside the view.
  std::span<const std::uint8_t> seen{};
  // Of the boxes from this one on it does not matter whether they are kVisible or kPartial.
  std::size_t plain_from = static_cast<std::size_t>(-1);
  // First and last pixels of a window of which there is a better map. A box whose rectangle lies in it is
  // kPartial unless a short test hides it.
  std::uint16_t window_x0 = 1, window_y0 = 1, window_x1 = 0, window_y1 = 0;

  // The same for so many of the boxes.
  BoxHints from(std::size_t first, std::size_t count) const {
    BoxHints part = *this;
    part.seen = seen.empty() ? seen : seen.subspan(first, count);
    part.plain_from = plain_from > first ? plain_from - first : 0;
    return part;
  }
};

// Usable alone: build() from any occluders, then classify() any boxes at any time. With Coverage::kInner
// answers are conservative: kHidden only where no point of the box can be seen from the view's eye. kVisible
// where nothing in the map is before any part of the box. A box is compared by its own outline and depth in
// each pixel wherever its rectangle leaves doubt. Between begin() and finish(), and before the first view,
// nothing is hidden but what lies outside the view. After finish() several threads may ask; drawing is for
// one at a time. Allocates nothing once its storage has grown to what a few builds need.
class DepthPyramid {
 public:
  explicit DepthPyramid(const DepthPyramidSettings& settings = {});
  ~DepthPyramid();
  DepthPyramid(DepthPyramid&&) noexcept;
  DepthPyramid& operator=(DepthPyramid&&) noexcept;

  void build(const View& view, const OccluderSet& set, std::span<const OccluderId> chosen,
             const ParallelFor& parallel_for = serialFor);
  // The same in steps: draw() any number of occluders, also of several sets, as those that move; then
  // finish().
  void begin(const View& view);
  void draw(const OccluderSet& set, std::span<const OccluderId> chosen,
            const ParallelFor& parallel_for = serialFor);
  void finish(const ParallelFor& parallel_for = serialFor);

  // Of boxes in scene space, as seen in the last view; one answer for each. Boxes that are not well formed,
  // and those that reach the near plane, are kPartial or kVisible. What is wholly outside the view is
  // kHidden.
  void classify(std::span<const Box> boxes, std::span<BoxAnswer> answers, const BoxHints& hints = {}) const;
  Visibility classify(const Box& box) const;
  // The same with the view's volume alone, as if nothing were drawn: kHidden where wholly outside, kVisible
  // or kPartial elsewhere.
  void classifyInView(std::span<const Box> boxes, std::span<BoxAnswer> answers) const;

  // Of the pyramid, level 0 is the map itself.
  std::uint32_t levels() const;
  DepthMapView map() const;
  const DepthPyramidStats& stats() const;
  std::span<const OccluderId> occluders() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sightline
