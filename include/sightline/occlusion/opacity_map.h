#pragma once

// Opacity map and sparse depth map: occluders drawn into a small map, boxes compared with it by a few integer
// operations.

#include <cstdint>
#include <memory>
#include <span>

#include "sightline/base/parallel_for.h"
#include "sightline/occluders/occluder_set.h"
#include "sightline/occlusion/rasteriser.h"
#include "sightline/occlusion/visibility.h"
#include "sightline/scene/camera.h"

namespace sightline {

// How a box's depth is compared with the map's.
enum class DepthComparison : std::uint8_t {
  kSparse,     // only at local peaks of each row (Poon and Wang 1999, section 5.3)
  kPixelwise,  // at every pixel, to measure against
};

struct OpacityMapSettings {
  RasterSettings raster{};
  DepthComparison depth = DepthComparison::kSparse;
  // Approximate overlap test: so many pixels of a box's rectangle may be uncovered; its depth is compared
  // with the covered ones. Other than 0 it is NOT conservative. A box of which nothing is covered is never
  // hidden.
  std::uint32_t tolerance = 0;
  // Adaptive overlap test: a box of which a smaller part than this is covered, 0 to 1, counts as visible, so
  // that a walk does not test what is in it. 0: off.
  double coverage_ratio = 0.2;
};

struct OpacityMapStats {
  RasterStats raster{};
  // All since begin() or build().
  std::uint32_t overlap_tests = 0;    // boxes with a rectangle on the map
  std::uint32_t overlap_failed = 0;   // of those: more uncovered pixels than the tolerance
  std::uint32_t given_up = 0;         // of the failed: some of it covered, but less than the coverage ratio
  std::uint32_t depth_tests = 0;      // the others
  std::uint64_t depths_compared = 0;  // pixels
  bool sparse = false;                // rows of the sparse depth map were made and used
};

// Usable alone: build() from any occluders, then classify() any box at any time. With Coverage::kInner and no
// tolerance answers are conservative: kHidden only where no point of the box can be seen from the view's eye.
// kVisible where nothing covers the box's rectangle, or too little (coverage_ratio); both comparisons of
// depth give the same answers. Before build(), and between begin() and finish(), everything is kVisible. Not
// safe to share between threads; allocates nothing once its storage has grown to what a few builds need.
// Source: Poon, Wang 1999, section 5.
class OpacityMap {
 public:
  explicit OpacityMap(const OpacityMapSettings& settings = {});
  ~OpacityMap();
  OpacityMap(OpacityMap&&) noexcept;
  OpacityMap& operator=(OpacityMap&&) noexcept;

  void build(const View& view, const OccluderSet& set, std::span<const OccluderId> chosen,
             const ParallelFor& parallel_for = serialFor);
  // The same in steps, for occluders of several sets, as those that move: begin() a view, draw() any number,
  // then finish(). draw() and finish() may follow build() too.
  void begin(const View& view);
  void draw(const OccluderSet& set, std::span<const OccluderId> chosen,
            const ParallelFor& parallel_for = serialFor);
  void finish();

  // Of a box in scene space, as seen in the last view. Boxes that are not well formed, and those that reach
  // the near plane, are kPartial or kVisible. What is wholly outside the view is kHidden.
  Visibility classify(const Box& box);

  // Instead of the settings' coverage_ratio, until changed again; culling adapts it to measured times.
  void setCoverageRatio(double ratio);

  DepthMapView map() const;  // valid until the next begin() or build()
  const OpacityMapStats& stats() const;
  std::span<const OccluderId> occluders() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sightline
