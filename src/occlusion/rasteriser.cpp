// A conservative rasteriser.
//
// Each convex polygon covers, row by row, the pixels between the last one that its left edges come near and
// the first one that its right edges come near. Pixels that shared edges cross are drawn afterwards, group by
// group (raster_rows.cpp). Edges are computed in single precision with a margin above its rounding, and
// depths are rounded away from the eye; docs/conservative.md has the argument.

#include "sightline/occlusion/rasteriser.h"

#include <algorithm>
#include <cmath>

#include "src/occlusion/polygons/polygon_builder.h"
#include "src/occlusion/polygons/raster_rows.h"
#include "src/occlusion/surfaces/surface_aims.h"
#include "src/occlusion/surfaces/surface_raster.h"

namespace sightline {

using namespace occlusion;

namespace {

// The box of surfaces that move, in scene space, up to rounding.
Box boxInScene(const MovingSurfaces& moving) {
  const Mat4& m = moving.scene_from_surfaces;
  const Box& own = moving.surfaces->bounds;
  const Vec3d middle = transformPoint(m, center(own)), half = (Vec3d(own.max) - Vec3d(own.min)) * 0.5;
  Vec3d reach;
  for (int axis = 0; axis < 3; ++axis) {
    reach[axis] =
        std::abs(m(axis, 0)) * half.x + std::abs(m(axis, 1)) * half.y + std::abs(m(axis, 2)) * half.z;
  }
  return {Vec3f(middle - reach), Vec3f(middle + reach)};
}

}  // namespace

struct Rasteriser::Impl {
  // A thread draws at least so many rows together.
  static constexpr std::uint32_t kBandRows = 16;

  explicit Impl(const RasterSettings& s) : settings(s) {
    settings.width = std::clamp(settings.width, 1u, kMaxBufferSize);
    settings.height = std::clamp(settings.height, 1u, kMaxBufferSize);
    stride = (settings.width + kRowSlack - 1) / kRowSlack * kRowSlack + kRowSlack;
    reciprocal_depth.resize(std::size_t{stride} * settings.height, kUncovered);
    bands = (settings.height + kBandRows - 1) / kBandRows;
    scratch.resize(bands);
  }

  // The nearest polygons come first: they hide most of what comes after.
  void sortPolygons() {
    order.resize(polygons.polygons.size());
    for (std::uint32_t i = 0; i < order.size(); ++i) {
      order[i] = i;
    }
    std::sort(order.begin(), order.end(), [this](std::uint32_t a, std::uint32_t b) {
      const BufferPolygon &p = polygons.polygons[a], &q = polygons.polygons[b];
      return p.nearest != q.nearest ? p.nearest > q.nearest : p.occluder < q.occluder;
    });
    by_group = order;
    std::erase_if(by_group,
                  [this](std::uint32_t p) { return polygons.polygons[p].group == BufferPolygon::kNoGroup; });
    std::sort(by_group.begin(), by_group.end(), [this](std::uint32_t a, std::uint32_t b) {
      const BufferPolygon &p = polygons.polygons[a], &q = polygons.polygons[b];
      return p.group != q.group ? p.group < q.group : a < b;
    });
  }

  RasterBand bandOf(std::uint32_t begin, std::uint32_t end) {
    return {reciprocal_depth.data(), settings.width, stride, begin * kBandRows,
            std::min(end * kBandRows, settings.height)};
  }

  void drawBands(std::uint32_t begin, std::uint32_t end) {
    if (begin == end) {
      return;  // the scratch of the band at which it would begin is another range's
    }
    const RasterBand band = bandOf(begin, end);
    if (settings.coverage != nullptr) {
      settings.coverage->draw(polygons, order, band);
      return;
    }
    drawInsides(polygons, order, band, scratch[begin],
                std::span(drawn).subspan(begin * order.size(), order.size()));
    const double rounding = bufferRounding(settings.width, settings.height);
    for (std::size_t first = 0, last = 0; first < by_group.size(); first = last) {
      const std::uint32_t group = polygons.polygons[by_group[first]].group;
      while (last < by_group.size() && polygons.polygons[by_group[last]].group == group) {
        ++last;
      }
      drawSharedEdges(polygons, std::span(by_group).subspan(first, last - first), band, rounding,
                      scratch[begin]);
    }
  }

  void draw(const OccluderSet& set, std::span<const OccluderId> chosen, const ParallelFor& parallel_for) {
    const PolygonForm form = settings.coverage == nullptr ? PolygonForm::kConservative : PolygonForm::kExact;
    builder.build(PolygonProjection(view, form, settings.width, settings.height), set, chosen, polygons);
    if (!polygons.polygons.empty()) {
      sortPolygons();
      drawn.assign(order.size() * bands, settings.coverage != nullptr ? 1 : 0);
      parallel_for(bands, [this](std::uint32_t begin, std::uint32_t end) { drawBands(begin, end); });
      contents = Contents::kOther;
    }
    count();
  }

  // Prepares the map for drawing surfaces. It looks at the buffer again only where others than surfaces were
  // drawn into it.
  void aimAt(std::span<const Box> targets) {
    if (contents == Contents::kNothing) {
      map.begin(target(), kUncovered);
    } else if (contents == Contents::kOther) {
      map.begin(target());
    }
    if (contents != Contents::kOfMap) {
      contents = Contents::kOfMap;
      aims.begin(view, target());
    }
    aims.aim(targets, map);
  }

  // Draws surfaces in a space of their own. set_view: the view in it.
  void draw(const SurfaceSet& set, const scene::PixelView& set_view, std::span<const ObjectId> candidates,
            const SurfaceDrawing& drawing, const ParallelFor& parallel_for) {
    aimAt(drawing.targets);
    SurfaceMemory& memory = memories.of(set, views);
    SurfaceDrawing next = drawing;
    if (drawing.step == ViewStep::kSame && memory.buffer_view != views) {
      next.step = ViewStep::kNext;  // this set is not yet drawn in the view
    }
    memory.buffer_view = views;
    surfaces.draw(set, set_view, candidates, next, memory, map, parallel_for);
    with_candidates = surfaces.stats();
  }

  DepthTarget target() { return {reciprocal_depth.data(), settings.width, settings.height, stride}; }

  // Counts what the last draw() drew.
  void count() {
    const std::size_t before = used.size(), size = polygons.polygons.size();
    for (std::size_t p = 0; p < size;) {
      const OccluderId occluder = polygons.polygons[p].occluder;
      used.push_back(occluder);
      bool some = false;
      // The faces of a body follow each other.
      for (; p < size && polygons.polygons[p].occluder == occluder; ++p) {
        for (std::uint32_t band = 0; band < bands; ++band) {
          some = some || drawn[band * size + p] != 0;
        }
      }
      stats.hidden += some ? 0 : 1;
    }
    stats.occluders = static_cast<std::uint32_t>(used.size());
    stats.unusable += polygons.considered - static_cast<std::uint32_t>(used.size() - before);
  }

  RasterSettings settings;
  std::uint32_t stride = 0, bands = 0;
  std::vector<float> reciprocal_depth;
  scene::PixelView view;
  PolygonBuilder builder;
  // What is in the buffer: nothing at all, nothing but what the map knows of, or something else.
  enum class Contents : std::uint8_t { kNothing, kOfMap, kOther };
  Contents contents = Contents::kNothing;
  std::uint64_t views = 0;  // since the first begin()
  WindingMap map;
  SurfaceAims aims;
  SurfaceRaster surfaces;
  SurfaceMemories memories;      // of sets that are drawn with candidates
  SurfaceMemory of_moving;       // of the others, one after the other
  SurfaceStats with_candidates;  // of the last draw() of surfaces with candidates
  BufferPolygons polygons;
  std::vector<std::uint32_t> order, by_group;
  std::vector<std::uint8_t> drawn;     // by band and polygon: some of the polygon was nearer than the buffer
  std::vector<RasterScratch> scratch;  // by the first band of the range that a thread draws
  std::vector<OccluderId> used;
  RasterStats stats;
};

Rasteriser::Rasteriser(const RasterSettings& settings) : impl_(std::make_unique<Impl>(settings)) {}
Rasteriser::~Rasteriser() = default;
Rasteriser::Rasteriser(Rasteriser&&) noexcept = default;
Rasteriser& Rasteriser::operator=(Rasteriser&&) noexcept = default;

void Rasteriser::begin(const View& view, const ViewerRegion& viewers) {
  impl_->view = scene::PixelView(view, impl_->settings.width, impl_->settings.height, viewers);
  fillBuffer(impl_->reciprocal_depth, kUncovered);
  impl_->contents = Impl::Contents::kNothing;
  ++impl_->views;
  impl_->used.clear();
  impl_->stats = {};
}

void Rasteriser::draw(const OccluderSet& set, std::span<const OccluderId> chosen,
                      const ParallelFor& parallel_for) {
  if (!impl_->view.viewers.several()) {
    impl_->draw(set, chosen, parallel_for);
  }
}

void Rasteriser::reserve(const SurfaceSet& surfaces) {
  impl_->surfaces.reserve(surfaces, impl_->memories.of(surfaces, impl_->views));
}

void Rasteriser::draw(const SurfaceSet& surfaces, std::span<const ObjectId> candidates,
                      const SurfaceDrawing& drawing, const ParallelFor& parallel_for) {
  impl_->draw(surfaces, impl_->view, candidates, drawing, parallel_for);
}

SurfaceStats Rasteriser::draw(const MovingSurfaces& surfaces, std::span<const ObjectId> candidates,
                              const SurfaceDrawing& drawing, const ParallelFor& parallel_for) {
  if (surfaces.surfaces == nullptr) {
    return {};
  }
  impl_->draw(*surfaces.surfaces, impl_->view.inSpace(surfaces.scene_from_surfaces), candidates, drawing,
              parallel_for);
  return impl_->with_candidates;
}

SurfaceStats Rasteriser::draw(const MovingSurfaces& moving, const SurfaceDrawing& drawing,
                              const ParallelFor& parallel_for) {
  if (moving.surfaces == nullptr) {
    return {};
  }
  impl_->aimAt(drawing.targets);
  if (!impl_->aims.mayUse(boxInScene(moving), impl_->map)) {
    return {};
  }
  SurfaceDrawing alone = drawing;
  alone.step = ViewStep::kJump;
  alone.useful_only = false;
  impl_->surfaces.draw(*moving.surfaces, impl_->view.inSpace(moving.scene_from_surfaces),
                       moving.surfaces->objects, alone, impl_->of_moving, impl_->map, parallel_for);
  return impl_->surfaces.stats();
}

const RasterSettings& Rasteriser::settings() const {
  return impl_->settings;
}
DepthBufferView Rasteriser::depthBuffer() const {
  return {impl_->reciprocal_depth, impl_->settings.width, impl_->settings.height, impl_->stride};
}
const SurfaceStats& Rasteriser::surfaceStats() const {
  return impl_->with_candidates;
}
const RasterStats& Rasteriser::stats() const {
  return impl_->stats;
}
std::span<const OccluderId> Rasteriser::occluders() const {
  return impl_->used;
}

}  // namespace sightline
