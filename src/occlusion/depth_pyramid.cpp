// Based on: Greene, Kass, Miller. Hierarchical Z-Buffer Visibility. SIGGRAPH 1993; Zhang, Manocha, Hudson,
// Hoff. Visibility Culling Using Hierarchical Occlusion Maps. SIGGRAPH 1997.
// Differs from the papers in: the depth buffer is conservative; a box is compared by its own outline and
// depth, down to single pixels, before it is called visible; docs/algorithms/depth-pyramid.md has the rest.

#include "sightline/occlusion/depth_pyramid.h"

#include <algorithm>

#include "src/occlusion/boxes/box_depth_test.h"
#include "src/occlusion/boxes/box_outline.h"
#include "src/occlusion/boxes/depth_levels.h"
#include "src/occlusion/boxes/pixel_boxes.h"

namespace sightline {

using namespace occlusion;

struct DepthPyramid::Impl {
  explicit Impl(const DepthPyramidSettings& settings) : raster(settings.raster) {}

  Rasteriser raster;
  DepthLevels levels;
  bool finished = false;
  OutlineView view;
  BoxProjection projection;

  std::span<const DepthLevel> usableLevels() const {
    return finished ? levels.levels() : std::span<const DepthLevel>();
  }
};

namespace {

// Boxes that are projected in one call.
constexpr std::size_t kGroup = 64;

template <typename Use>
void forGroups(std::size_t count, Use&& use) {
  for (std::size_t first = 0; first < count; first += kGroup) {
    use(first, std::min(kGroup, count - first));
  }
}

}  // namespace

DepthPyramid::DepthPyramid(const DepthPyramidSettings& settings) : impl_(std::make_unique<Impl>(settings)) {}
DepthPyramid::~DepthPyramid() = default;
DepthPyramid::DepthPyramid(DepthPyramid&&) noexcept = default;
DepthPyramid& DepthPyramid::operator=(DepthPyramid&&) noexcept = default;

void DepthPyramid::build(const View& view, const OccluderSet& set, std::span<const OccluderId> chosen,
                         const ParallelFor& parallel_for) {
  begin(view);
  draw(set, chosen, parallel_for);
  finish(parallel_for);
}

void DepthPyramid::begin(const View& view, const ViewerRegion& viewers) {
  const DepthBufferView buffer = impl_->raster.depthBuffer();
  impl_->raster.begin(view, viewers);
  impl_->view = OutlineView(scene::PixelView(view, buffer.width, buffer.height));
  impl_->projection = BoxProjection(impl_->view.view, buffer.width, buffer.height);
  impl_->finished = false;
}

void DepthPyramid::draw(const OccluderSet& set, std::span<const OccluderId> chosen,
                        const ParallelFor& parallel_for) {
  impl_->finished = false;
  impl_->raster.draw(set, chosen, parallel_for);
}

void DepthPyramid::reserve(const SurfaceSet& surfaces) {
  impl_->raster.reserve(surfaces);
}

void DepthPyramid::draw(const SurfaceSet& surfaces, std::span<const ObjectId> candidates,
                        const SurfaceDrawing& drawing, const ParallelFor& parallel_for) {
  impl_->raster.draw(surfaces, candidates, drawing, parallel_for);
  impl_->finished = impl_->finished && impl_->raster.surfaceStats().groups == 0;
}

SurfaceStats DepthPyramid::draw(const MovingSurfaces& surfaces, std::span<const ObjectId> candidates,
                                const SurfaceDrawing& drawing, const ParallelFor& parallel_for) {
  const SurfaceStats drawn = impl_->raster.draw(surfaces, candidates, drawing, parallel_for);
  impl_->finished = impl_->finished && drawn.groups == 0;
  return drawn;
}

SurfaceStats DepthPyramid::draw(const MovingSurfaces& moving, const SurfaceDrawing& drawing,
                                const ParallelFor& parallel_for) {
  const SurfaceStats drawn = impl_->raster.draw(moving, drawing, parallel_for);
  impl_->finished = impl_->finished && drawn.groups == 0;
  return drawn;
}

void DepthPyramid::finish(const ParallelFor& parallel_for) {
  if (!impl_->finished) {
    impl_->levels.build(impl_->raster.depthBuffer(), parallel_for);
    impl_->finished = true;
  }
}

void DepthPyramid::classify(std::span<const Box> boxes, std::span<BoxAnswer> answers,
                            const BoxHints& hints) const {
  PixelBox images[kGroup];
  forGroups(boxes.size(), [&](std::size_t first, std::size_t count) {
    const std::span<PixelBox> group(images, count);
    projectBoxes(impl_->projection, boxes.subspan(first, count), group);
    testBoxes(impl_->usableLevels(), impl_->view, boxes.subspan(first, count), group,
              answers.subspan(first, count), hints.from(first, count));
  });
}

Visibility DepthPyramid::classify(const Box& box) const {
  BoxAnswer answer;
  classify({&box, 1}, {&answer, 1});
  return answer.visibility;
}

void DepthPyramid::seesPoints(std::span<const Vec3f> points, std::span<std::uint8_t> seen) const {
  const std::span<const DepthLevel> levels = impl_->usableLevels();
  if (levels.empty()) {
    std::fill_n(seen.begin(), points.size(), std::uint8_t{0});
    return;
  }
  const DepthLevel& buffer = levels.front();
  PointImage images[kGroup];
  forGroups(points.size(), [&](std::size_t first, std::size_t count) {
    projectPoints(impl_->projection, points.subspan(first, count), {images, count});
    for (std::size_t i = 0; i < count; ++i) {
      const PointImage& image = images[i];
      const bool known = image.x != PointImage::kUnknown;
      const std::size_t at = known ? static_cast<std::size_t>(image.y) * buffer.stride + image.x : 0;
      seen[first + i] = known && buffer.min[at] <= image.farthest ? 1 : 0;
    }
  });
}

void DepthPyramid::classifyInView(std::span<const Box> boxes, std::span<BoxAnswer> answers) const {
  PixelBox images[kGroup];
  forGroups(boxes.size(), [&](std::size_t first, std::size_t count) {
    projectBoxes(impl_->projection, boxes.subspan(first, count), {images, count});
    for (std::size_t i = 0; i < count; ++i) {
      const BoxPlace place = images[i].place;
      answers[first + i] = images[i].answer(place == BoxPlace::kOutside    ? Visibility::kHidden
                                            : place == BoxPlace::kOnBuffer ? Visibility::kVisible
                                                                           : Visibility::kPartial);
    }
  });
}

void DepthPyramid::openPixels(std::span<const Box> boxes, std::uint32_t max, std::span<std::uint32_t> counts,
                              std::vector<BufferPixel>& pixels) const {
  PixelBox images[kGroup];
  forGroups(boxes.size(), [&](std::size_t first, std::size_t count) {
    projectBoxes(impl_->projection, boxes.subspan(first, count), {images, count});
    findOpenPixels(impl_->usableLevels(), impl_->view, boxes.subspan(first, count), {images, count}, max,
                   counts.subspan(first, count), pixels);
  });
}

std::uint32_t DepthPyramid::levels() const {
  return static_cast<std::uint32_t>(impl_->usableLevels().size());
}
DepthBufferView DepthPyramid::depthBuffer() const {
  return impl_->raster.depthBuffer();
}
const SurfaceStats& DepthPyramid::surfaceStats() const {
  return impl_->raster.surfaceStats();
}
const RasterStats& DepthPyramid::stats() const {
  return impl_->raster.stats();
}
std::span<const OccluderId> DepthPyramid::occluders() const {
  return impl_->raster.occluders();
}

}  // namespace sightline
