#pragma once

// Opacity map and sparse depth map: occluders are drawn into a small depth buffer, and a box is compared with
// it by a few integer operations.

#include <cstdint>
#include <memory>
#include <span>

#include "sightline/base/parallel_for.h"
#include "sightline/occluders/occluder_set.h"
#include "sightline/occlusion/rasteriser.h"
#include "sightline/occlusion/visibility.h"
#include "sightline/scene/camera.h"

namespace sightline {

// How a box's depth is compared with the buffer's.
enum class DepthComparison : std::uint8_t {
  kSparse,        // at local peaks of each row (Poon and Wang 1999, section 5.3), where that takes less time
  kPixelwise,     // at every pixel, to measure against
  kSparseAlways,  // at local peaks everywhere, as the paper has it, to measure against
};

struct OpacityMapSettings {
  RasterSettings raster{};
  DepthComparison depth = DepthComparison::kSparse;
  // Approximate overlap test: so many pixels of a box's rectangle may be uncovered, and its depth is compared
  // with the covered ones only. A value other than 0 is NOT conservative. A box of which nothing is covered
  // is never hidden.
  std::uint32_t tolerance = 0;
  // Adaptive overlap test: a box of which a smaller part than this (0 to 1) is covered counts as visible, so
  // that a traversal does not test what is in it. 0 turns this off.
  double coverage_ratio = 0.2;
};

struct OpacityMapStats {
  RasterStats raster{};
  // Counts since begin() or build().
  std::uint32_t overlap_tests = 0;    // boxes with a rectangle in the buffer
  std::uint32_t overlap_failed = 0;   // of these: more uncovered pixels than the tolerance
  std::uint32_t given_up = 0;         // of the failed: partly covered, but less than the coverage ratio
  std::uint32_t depth_tests = 0;      // boxes that passed the overlap test
  std::uint64_t depths_compared = 0;  // pixels whose depth was compared
  std::uint32_t sparse_rows = 0;      // rows that were compared at their peaks
};

// Tells for any box whether the drawn occluders hide it. It can be used alone: build() from any occluders,
// then classify() boxes at any time.
//
// With the conservative coverage rule and no tolerance answers are conservative: kHidden only where no point
// of the box can be seen from the view's eye. kVisible means that nothing covers the box's rectangle, or too
// little (coverage_ratio). All comparisons of depth give the same answers. Before build(), and between
// begin() and finish(), everything is kVisible.
//
// Use by one thread at a time; nothing is allocated once the storage has grown to what a few builds need.
// Source: Poon, Wang 1999, section 5.
class OpacityMap {
 public:
  explicit OpacityMap(const OpacityMapSettings& settings = {});
  ~OpacityMap();
  OpacityMap(OpacityMap&&) noexcept;
  OpacityMap& operator=(OpacityMap&&) noexcept;

  void build(const View& view, const OccluderSet& set, std::span<const OccluderId> chosen,
             const ParallelFor& parallel_for = serialFor);
  // Builds in steps, for occluders of several sets: begin() a view, draw() any number, then finish(). draw()
  // and finish() may follow build() too.
  void begin(const View& view);
  void draw(const OccluderSet& set, std::span<const OccluderId> chosen,
            const ParallelFor& parallel_for = serialFor);
  void reserve(const SurfaceSet& surfaces);  // see Rasteriser
  void draw(const SurfaceSet& surfaces, std::span<const ObjectId> candidates,
            const SurfaceDrawing& drawing = {}, const ParallelFor& parallel_for = serialFor);
  SurfaceStats draw(const MovingSurfaces& moving, const SurfaceDrawing& drawing = {},
                    const ParallelFor& parallel_for = serialFor);
  void finish();

  // Classifies a box in scene space as seen in the last view. Boxes that are not well formed, and those that
  // reach the near plane, are kPartial or kVisible. A box that is wholly outside the view is kHidden.
  Visibility classify(const Box& box);

  // Replaces the settings' coverage_ratio until changed again; culling adapts it to measured times.
  void setCoverageRatio(double ratio);

  DepthBufferView depthBuffer() const;  // valid until the next begin() or build()
  const OpacityMapStats& stats() const;
  const SurfaceStats& surfaceStats() const;  // of the last draw() of surfaces
  std::span<const OccluderId> occluders() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sightline
