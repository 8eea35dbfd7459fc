// Based on: Poon Chun Ho, W. Wang. Occlusion Culling Using Minimum Occluder Set and Opacity Map. 1999,
// section 5. Differs from the paper in what a covered pixel promises (the conservative coverage rule), in
// rectangles that are rounded outwards, in strict comparisons, and in the last pixel of each row; see
// docs/algorithms/opacity-map.md.

#include "sightline/occlusion/opacity_map.h"

#include "src/occlusion/boxes/pixel_boxes.h"
#include "src/occlusion/boxes/sparse_depth.h"
#include "src/occlusion/boxes/summed_area.h"

namespace sightline {

using occlusion::areaOf;
using occlusion::BoxPlace;
using occlusion::PixelBox;
using occlusion::SparseDepth;

struct OpacityMap::Impl {
  explicit Impl(const OpacityMapSettings& s)
      : settings(s),
        raster(s.raster),
        sparse_depth(s.depth == DepthComparison::kSparseAlways ? SparseDepth::Use::kAlways
                                                               : SparseDepth::Use::kWherePaying),
        coverage_ratio(s.coverage_ratio) {}

  void finish() {
    const DepthBufferView buffer = raster.depthBuffer();
    opacity.build(buffer);
    if (settings.depth != DepthComparison::kPixelwise) {
      sparse_depth.begin(buffer);
    }
    stats.raster = raster.stats();
    ready = true;
  }

  // Whether too little of the rectangle is covered for tests of what lies in the box to be worthwhile.
  bool tooLittle(std::uint32_t covered, std::uint32_t area) const {
    return static_cast<double>(covered) < coverage_ratio * static_cast<double>(area);
  }

  bool allNearer(const PixelBox& image) {
    ++stats.depth_tests;
    if (settings.depth == DepthComparison::kPixelwise) {
      return allNearerPixelwise(raster.depthBuffer(), image, stats.depths_compared);
    }
    const std::uint64_t before = sparse_depth.compared();
    const bool nearer = sparse_depth.allNearer(image);
    stats.depths_compared += sparse_depth.compared() - before;
    stats.sparse_rows = sparse_depth.rowsUsed();
    return nearer;
  }

  Visibility classify(const PixelBox& image) {
    ++stats.overlap_tests;
    const std::uint32_t covered = opacity.count(image), area = areaOf(image);
    if (covered == 0) {
      ++stats.overlap_failed;
      return Visibility::kVisible;
    }
    if (area - covered > settings.tolerance) {
      ++stats.overlap_failed;
      if (!tooLittle(covered, area)) {
        return Visibility::kPartial;
      }
      ++stats.given_up;
      return Visibility::kVisible;
    }
    return allNearer(image) ? Visibility::kHidden : Visibility::kPartial;
  }

  OpacityMapSettings settings;
  Rasteriser raster;
  occlusion::BoxProjection projection;
  occlusion::SummedArea opacity;
  SparseDepth sparse_depth;
  double coverage_ratio;
  bool ready = false;  // finish() has been called for this view
  OpacityMapStats stats;
};

OpacityMap::OpacityMap(const OpacityMapSettings& settings) : impl_(std::make_unique<Impl>(settings)) {}
OpacityMap::~OpacityMap() = default;
OpacityMap::OpacityMap(OpacityMap&&) noexcept = default;
OpacityMap& OpacityMap::operator=(OpacityMap&&) noexcept = default;

void OpacityMap::build(const View& view, const OccluderSet& set, std::span<const OccluderId> chosen,
                       const ParallelFor& parallel_for) {
  begin(view);
  draw(set, chosen, parallel_for);
  finish();
}

void OpacityMap::begin(const View& view) {
  impl_->ready = false;
  impl_->stats = {};
  impl_->raster.begin(view);
  const DepthBufferView buffer = impl_->raster.depthBuffer();
  impl_->projection = {scene::PixelView(view, buffer.width, buffer.height), buffer.width, buffer.height};
}

void OpacityMap::draw(const OccluderSet& set, std::span<const OccluderId> chosen,
                      const ParallelFor& parallel_for) {
  impl_->ready = false;
  impl_->raster.draw(set, chosen, parallel_for);
}

void OpacityMap::reserve(const SurfaceSet& surfaces) {
  impl_->raster.reserve(surfaces);
}

void OpacityMap::draw(const SurfaceSet& surfaces, std::span<const ObjectId> candidates,
                      const SurfaceDrawing& drawing, const ParallelFor& parallel_for) {
  impl_->raster.draw(surfaces, candidates, drawing, parallel_for);
  impl_->ready = impl_->ready && impl_->raster.surfaceStats().groups == 0;
}

SurfaceStats OpacityMap::draw(const MovingSurfaces& moving, const SurfaceDrawing& drawing,
                              const ParallelFor& parallel_for) {
  const SurfaceStats drawn = impl_->raster.draw(moving, drawing, parallel_for);
  impl_->ready = impl_->ready && drawn.groups == 0;
  return drawn;
}

void OpacityMap::finish() {
  impl_->finish();
}

Visibility OpacityMap::classify(const Box& box) {
  if (!impl_->ready) {
    return Visibility::kVisible;
  }
  PixelBox image;
  occlusion::projectBoxes(impl_->projection, {&box, 1}, {&image, 1});
  if (image.place == BoxPlace::kOutside) {
    return Visibility::kHidden;
  }
  return image.place == BoxPlace::kOnBuffer ? impl_->classify(image) : Visibility::kPartial;
}

void OpacityMap::setCoverageRatio(double ratio) {
  impl_->coverage_ratio = ratio;
}

DepthBufferView OpacityMap::depthBuffer() const {
  return impl_->raster.depthBuffer();
}
const OpacityMapStats& OpacityMap::stats() const {
  return impl_->stats;
}
const SurfaceStats& OpacityMap::surfaceStats() const {
  return impl_->raster.surfaceStats();
}
std::span<const OccluderId> OpacityMap::occluders() const {
  return impl_->raster.occluders();
}

}  // namespace sightline
