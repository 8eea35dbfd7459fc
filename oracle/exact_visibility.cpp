#include "oracle/exact_visibility.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <limits>

#include "oracle/ray_scene.h"
#include "oracle/sample_points.h"
#include "oracle/view_rays.h"
#include "oracle/wide_ray.h"

namespace sightline {
namespace {

constexpr std::uint64_t kNotSeen = std::numeric_limits<std::uint64_t>::max();

FloatRay floatRay(const View& view, const ViewRay& ray) {
  return {Vec3f(ray.origin), Vec3f(ray.direction), static_cast<float>(view.far - view.near)};
}

// Packs the pixel into the upper and the distance into the lower half, so that the minimum is the first pixel
// with its nearest hit.
std::uint64_t packHit(std::uint32_t pixel, float t) {
  return (static_cast<std::uint64_t>(pixel) << 32) | std::bit_cast<std::uint32_t>(std::max(t, 0.0f));
}

void storeMin(std::atomic<std::uint64_t>& min, std::uint64_t value) {
  std::uint64_t known = min.load(std::memory_order_relaxed);
  while (value < known && !min.compare_exchange_weak(known, value, std::memory_order_relaxed)) {
  }
}

// True if the infinite line through `origin` may intersect the box, enlarged by far more than rounding.
bool mayIntersect(const Vec3d& origin, const Vec3d& direction, const Box& box) {
  double enter = -std::numeric_limits<double>::infinity(), leave = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const double slack = 1e-9 * (std::abs(origin[axis]) + std::abs(double(box.min[axis])) +
                                 std::abs(double(box.max[axis])) + 1e-30);
    const double low = box.min[axis] - slack - origin[axis], high = box.max[axis] + slack - origin[axis];
    if (std::abs(direction[axis]) < 1e-300) {
      if (low > 0.0 || high < 0.0) {
        return false;
      }
      continue;
    }
    const double a = low / direction[axis], b = high / direction[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter <= leave * (1.0 + 1e-12) + 1e-300 && leave >= 0.0;
}

}  // namespace

struct ExactVisibility::Impl {
  explicit Impl(const SceneView& scene_);

  // Calls on_hits(first pixel, rays, hits) for every batch of pixels in rows [begin, end).
  template <typename OnHits>
  void traceRows(const View& view, std::uint32_t width, std::uint32_t height, std::uint32_t begin,
                 std::uint32_t end, OnHits&& on_hits) const;
  std::optional<Witness> aimAt(const View& view, ObjectId object, std::uint32_t samples,
                               std::vector<RayHit>& hits) const;
  void lookBeside(const View& view, ObjectId object, std::uint32_t samples, std::vector<Witness>& seen) const;
  // The minimum parameter in [near, far] at which the ray hits the object.
  std::optional<Wide> intersect(const WideRay& ray, ObjectId object, Wide near, Wide far) const;

  SceneView scene;
  RayScene rays;
  SamplePoints samples;
  std::vector<Box> bounds;  // by object, of its triangles
};

ExactVisibility::Impl::Impl(const SceneView& scene_) : scene(scene_), rays(scene_), samples(scene_) {
  bounds.resize(scene.objects.size());
  for (std::size_t o = 0; o < bounds.size(); ++o) {
    for (const std::uint32_t index : scene.indicesOf(scene.objects[o])) {
      bounds[o].extend(scene.positions[index]);
    }
  }
}

ExactVisibility::ExactVisibility(const SceneView& scene) : impl_(std::make_unique<Impl>(scene)) {}
ExactVisibility::~ExactVisibility() = default;
ExactVisibility::ExactVisibility(ExactVisibility&&) noexcept = default;
ExactVisibility& ExactVisibility::operator=(ExactVisibility&&) noexcept = default;

template <typename OnHits>
void ExactVisibility::Impl::traceRows(const View& view, std::uint32_t width, std::uint32_t height,
                                      std::uint32_t begin, std::uint32_t end, OnHits&& on_hits) const {
  RayScene::Batch batch;
  std::vector<RayHit> hits;
  for (std::uint32_t row = begin; row < end; ++row) {
    for (std::uint32_t column = 0; column < width; column += RayScene::kBatch) {
      const std::uint32_t count = std::min(RayScene::kBatch, width - column);
      for (std::uint32_t i = 0; i < count; ++i) {
        batch[i] = floatRay(view, rayOfPixel(view, column + i, row, width, height));
      }
      hits.clear();
      rays.trace(batch, count, true, hits);
      on_hits(row * width + column, batch, hits);
    }
  }
}

std::vector<Witness> ExactVisibility::visibleThroughPixels(const View& view, std::uint32_t width,
                                                           std::uint32_t height,
                                                           const ParallelFor& parallel_for) const {
  std::vector<std::atomic<std::uint64_t>> first_hit(impl_->scene.objects.size());
  for (std::atomic<std::uint64_t>& hit : first_hit) {
    hit.store(kNotSeen, std::memory_order_relaxed);
  }
  parallel_for(height, [&](std::uint32_t begin, std::uint32_t end) {
    impl_->traceRows(view, width, height, begin, end,
                     [&](std::uint32_t pixel, const RayScene::Batch&, const std::vector<RayHit>& hits) {
                       for (const RayHit& hit : hits) {
                         storeMin(first_hit[hit.object.value], packHit(pixel + hit.ray, hit.t));
                       }
                     });
  });
  std::vector<Witness> visible;
  for (std::uint32_t o = 0; o < first_hit.size(); ++o) {
    const std::uint64_t hit = first_hit[o].load(std::memory_order_relaxed);
    if (hit != kNotSeen) {
      const auto pixel = static_cast<std::uint32_t>(hit >> 32);
      const FloatRay ray = floatRay(view, rayOfPixel(view, pixel % width, pixel / width, width, height));
      visible.push_back({ObjectId(o), ray.at(std::bit_cast<float>(static_cast<std::uint32_t>(hit)))});
    }
  }
  return visible;
}

std::vector<Witness> ExactVisibility::pixelsShowing(ObjectId object, const View& view, std::uint32_t width,
                                                    std::uint32_t height,
                                                    const ParallelFor& parallel_for) const {
  std::vector<std::vector<Witness>> of_row(height);
  parallel_for(height, [&](std::uint32_t begin, std::uint32_t end) {
    impl_->traceRows(view, width, height, begin, end,
                     [&](std::uint32_t pixel, const RayScene::Batch& batch, const std::vector<RayHit>& hits) {
                       std::array<float, RayScene::kBatch> nearest;
                       nearest.fill(std::numeric_limits<float>::infinity());
                       for (const RayHit& hit : hits) {
                         if (hit.object == object) {
                           nearest[hit.ray] = std::min(nearest[hit.ray], hit.t);
                         }
                       }
                       for (std::uint32_t i = 0; i < RayScene::kBatch; ++i) {
                         if (nearest[i] < std::numeric_limits<float>::infinity()) {
                           of_row[pixel / width].push_back({object, batch[i].at(nearest[i])});
                         }
                       }
                     });
  });
  std::vector<Witness> all;
  for (const std::vector<Witness>& row : of_row) {
    all.insert(all.end(), row.begin(), row.end());
  }
  return all;
}

std::vector<Witness> ExactVisibility::visibleBesideEdges(const View& view, std::span<const ObjectId> objects,
                                                         std::uint32_t samples,
                                                         const ParallelFor& parallel_for) const {
  std::vector<std::vector<Witness>> of_object(objects.size());
  parallel_for(static_cast<std::uint32_t>(objects.size()), [&](std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t i = begin; i < end; ++i) {
      if (impl_->scene.objects[objects[i].value].index_count > 0) {
        impl_->lookBeside(view, objects[i], samples, of_object[i]);
      }
    }
  });
  std::vector<Witness> all;
  for (const std::vector<Witness>& witnesses : of_object) {
    all.insert(all.end(), witnesses.begin(), witnesses.end());
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const Witness& a, const Witness& b) { return a.object < b.object; });
  const auto same = [](const Witness& a, const Witness& b) { return a.object == b.object; };
  all.erase(std::unique(all.begin(), all.end(), same), all.end());
  return all;
}

// Appends a witness for each hit.
void ExactVisibility::Impl::lookBeside(const View& view, ObjectId object, std::uint32_t sample_count,
                                       std::vector<Witness>& seen) const {
  RayScene::Batch batch;
  std::vector<RayHit> hits;
  std::uint32_t count = 0;
  for (std::uint32_t sample = 0; sample < sample_count; ++sample) {
    const Vec3d point = samples.besideEdge(object, sample, view);
    if (inVolume(view, point, -1e-6)) {
      batch[count++] = floatRay(view, rayTo(view, point));
    }
    if (count == RayScene::kBatch || (count > 0 && sample + 1 == sample_count)) {
      hits.clear();
      rays.trace(batch, count, false, hits);
      for (const RayHit& hit : hits) {
        seen.push_back({hit.object, batch[hit.ray].at(hit.t)});
      }
      count = 0;
    }
  }
}

std::optional<Witness> ExactVisibility::Impl::aimAt(const View& view, ObjectId object,
                                                    std::uint32_t sample_count,
                                                    std::vector<RayHit>& hits) const {
  RayScene::Batch batch;
  std::uint32_t count = 0;
  for (std::uint32_t sample = 0; sample < sample_count; ++sample) {
    const Vec3d point = samples.point(object, sample, view);
    if (inVolume(view, point, -1e-6)) {
      FloatRay& ray = batch[count++];
      ray = floatRay(view, rayTo(view, point));
      const double t = depthOf(view, point) - view.near;
      if (t > 1e-3 * view.near) {
        ray.direction = Vec3f((point - Vec3d(ray.origin)) / t);  // from the rounded origin to the exact point
      }
    }
    if (count == RayScene::kBatch || (count > 0 && sample + 1 == sample_count)) {
      hits.clear();
      rays.trace(batch, count, false, hits);
      const RayHit* best = nullptr;
      for (const RayHit& hit : hits) {
        const bool better =
            best == nullptr || hit.ray < best->ray || (hit.ray == best->ray && hit.t < best->t);
        best = hit.object == object && better ? &hit : best;
      }
      if (best != nullptr) {
        return Witness{object, batch[best->ray].at(best->t)};
      }
      count = 0;
    }
  }
  return std::nullopt;
}

std::vector<Witness> ExactVisibility::visibleByAimedRays(const View& view, std::span<const ObjectId> objects,
                                                         std::uint32_t samples,
                                                         const ParallelFor& parallel_for) const {
  std::vector<std::optional<Witness>> found(objects.size());
  parallel_for(static_cast<std::uint32_t>(objects.size()), [&](std::uint32_t begin, std::uint32_t end) {
    std::vector<RayHit> hits;
    for (std::uint32_t i = begin; i < end; ++i) {
      if (impl_->scene.objects[objects[i].value].index_count > 0) {
        found[i] = impl_->aimAt(view, objects[i], samples, hits);
      }
    }
  });
  std::vector<Witness> witnesses;
  for (const std::optional<Witness>& witness : found) {
    if (witness) {
      witnesses.push_back(*witness);
    }
  }
  return witnesses;
}

std::optional<Wide> ExactVisibility::Impl::intersect(const WideRay& ray, ObjectId id, Wide near,
                                                     Wide far) const {
  const Object& object = scene.objects[id.value];
  const bool both_sides = scene.materialOf(object).double_sided;
  const std::span<const std::uint32_t> indices = scene.indicesOf(object);
  std::optional<Wide> nearest;
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
    const Vec3f &a = scene.positions[indices[i]], &b = scene.positions[indices[i + 1]],
                &c = scene.positions[indices[i + 2]];
    if (!isFinite(a) || !isFinite(b) || !isFinite(c)) {
      continue;
    }
    const std::optional<Wide> s = ray.intersect(a, b, c, both_sides);
    if (s && *s >= near && *s <= far && (!nearest || *s < *nearest)) {
      nearest = s;
    }
  }
  return nearest;
}

bool ExactVisibility::confirm(const View& view, const Witness& witness) const {
  constexpr double kTie =
      1e-25;  // relative; wide arithmetic on single-precision corners is a thousand times more precise
  const double depth = depthOf(view, witness.point);
  const Vec3d origin =
      view.orthographic ? witness.point - view.forward * depth : view.eye;  // in the plane through the eye
  const Vec3d direction = view.orthographic ? view.forward : witness.point - view.eye;
  const WideRay ray =
      view.orthographic ? WideRay(origin, direction) : WideRay::towards(view.eye, witness.point);
  const Wide depth_per_s = ray.along(view.forward);
  if (!(depth_per_s > 0) || !inVolume(view, witness.point, 1e-6)) {
    return false;
  }
  const Wide near = Wide(view.near) / depth_per_s, far = Wide(view.far) / depth_per_s;
  const std::optional<Wide> target = impl_->intersect(ray, witness.object, near, far);
  if (!target) {
    return false;
  }
  const Wide before = *target * (1 - Wide(kTie));
  for (std::uint32_t o = 0; o < impl_->bounds.size(); ++o) {
    const Object& object = impl_->scene.objects[o];
    if (ObjectId(o) != witness.object && impl_->scene.materialOf(object).opaque() &&
        mayIntersect(origin, direction, impl_->bounds[o])) {
      const std::optional<Wide> blocker = impl_->intersect(ray, ObjectId(o), near, far);
      if (blocker && *blocker < before) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace sightline
