#include "oracle/exact_visibility.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <limits>

#include "oracle/ray_scene.h"
#include "oracle/sample_points.h"
#include "oracle/view_rays.h"
#include "oracle/visibility_proof.h"

namespace sightline {
namespace {

constexpr std::uint64_t kNotSeen = std::numeric_limits<std::uint64_t>::max();

FloatRay floatRay(const View& view, const ViewRay& ray) {
  return {Vec3f(ray.origin), Vec3f(ray.direction), static_cast<float>(view.z_far - view.z_near)};
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

}  // namespace

struct ExactVisibility::Impl {
  explicit Impl(const SceneView& scene_) : scene(scene_), rays(scene_), samples(scene_), proofs(scene_) {}

  // Calls on_hits(first pixel, rays, hits) for every batch of pixels in rows [begin, end).
  template <typename OnHits>
  void traceRows(const View& view, std::uint32_t width, std::uint32_t height, std::uint32_t begin,
                 std::uint32_t end, OnHits&& on_hits) const;
  std::optional<SeenPoint> aimAt(const View& view, ObjectId object, std::uint32_t samples,
                                 std::vector<RayHit>& hits) const;
  void lookBeside(const View& view, ObjectId object, std::uint32_t samples,
                  std::vector<SeenPoint>& seen) const;
  using Decide = Decision (VisibilityProof::*)(ObjectId object, std::uint32_t max_steps);
  std::vector<Decision> decideEach(const View& view, std::span<const ObjectId> objects,
                                   std::uint32_t max_steps, Decide decide,
                                   const ParallelFor& parallel_for) const;

  SceneView scene;
  RayScene rays;
  SamplePoints samples;
  ProofScene proofs;
};

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

std::vector<SeenPoint> ExactVisibility::visibleThroughPixels(const View& view, std::uint32_t width,
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
  std::vector<SeenPoint> visible;
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

std::vector<SeenPoint> ExactVisibility::pixelsShowing(ObjectId object, const View& view, std::uint32_t width,
                                                      std::uint32_t height,
                                                      const ParallelFor& parallel_for) const {
  std::vector<std::vector<SeenPoint>> of_row(height);
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
  std::vector<SeenPoint> all;
  for (const std::vector<SeenPoint>& row : of_row) {
    all.insert(all.end(), row.begin(), row.end());
  }
  return all;
}

std::vector<SeenPoint> ExactVisibility::visibleBesideEdges(const View& view,
                                                           std::span<const ObjectId> objects,
                                                           std::uint32_t samples,
                                                           const ParallelFor& parallel_for) const {
  std::vector<std::vector<SeenPoint>> of_object(objects.size());
  parallel_for(static_cast<std::uint32_t>(objects.size()), [&](std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t i = begin; i < end; ++i) {
      if (impl_->scene.objects[objects[i].value].index_count > 0) {
        impl_->lookBeside(view, objects[i], samples, of_object[i]);
      }
    }
  });
  std::vector<SeenPoint> all;
  for (const std::vector<SeenPoint>& witnesses : of_object) {
    all.insert(all.end(), witnesses.begin(), witnesses.end());
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const SeenPoint& a, const SeenPoint& b) { return a.object < b.object; });
  const auto same = [](const SeenPoint& a, const SeenPoint& b) { return a.object == b.object; };
  all.erase(std::unique(all.begin(), all.end(), same), all.end());
  return all;
}

// Appends a witness for each hit.
void ExactVisibility::Impl::lookBeside(const View& view, ObjectId object, std::uint32_t sample_count,
                                       std::vector<SeenPoint>& seen) const {
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

std::optional<SeenPoint> ExactVisibility::Impl::aimAt(const View& view, ObjectId object,
                                                      std::uint32_t sample_count,
                                                      std::vector<RayHit>& hits) const {
  RayScene::Batch batch;
  std::uint32_t count = 0;
  for (std::uint32_t sample = 0; sample < sample_count; ++sample) {
    const Vec3d point = samples.point(object, sample, view);
    if (inVolume(view, point, -1e-6)) {
      FloatRay& ray = batch[count++];
      ray = floatRay(view, rayTo(view, point));
      const double t = depthOf(view, point) - view.z_near;
      if (t > 1e-3 * view.z_near) {
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
        return SeenPoint{object, batch[best->ray].at(best->t)};
      }
      count = 0;
    }
  }
  return std::nullopt;
}

std::vector<SeenPoint> ExactVisibility::visibleByAimedRays(const View& view,
                                                           std::span<const ObjectId> objects,
                                                           std::uint32_t samples,
                                                           const ParallelFor& parallel_for) const {
  std::vector<std::optional<SeenPoint>> found(objects.size());
  parallel_for(static_cast<std::uint32_t>(objects.size()), [&](std::uint32_t begin, std::uint32_t end) {
    std::vector<RayHit> hits;
    for (std::uint32_t i = begin; i < end; ++i) {
      if (impl_->scene.objects[objects[i].value].index_count > 0) {
        found[i] = impl_->aimAt(view, objects[i], samples, hits);
      }
    }
  });
  std::vector<SeenPoint> witnesses;
  for (const std::optional<SeenPoint>& witness : found) {
    if (witness) {
      witnesses.push_back(*witness);
    }
  }
  return witnesses;
}

bool ExactVisibility::confirm(const View& view, const SeenPoint& witness) const {
  return VisibilityProof(impl_->proofs, impl_->rays, view).reaches(witness.point, witness.object);
}

std::vector<Decision> ExactVisibility::decide(const View& view, std::span<const ObjectId> objects,
                                              std::uint32_t max_steps,
                                              const ParallelFor& parallel_for) const {
  return impl_->decideEach(view, objects, max_steps, &VisibilityProof::decide, parallel_for);
}

std::vector<Decision> ExactVisibility::decideBoxes(const View& view, std::span<const ObjectId> objects,
                                                   std::uint32_t max_steps,
                                                   const ParallelFor& parallel_for) const {
  return impl_->decideEach(view, objects, max_steps, &VisibilityProof::decideBox, parallel_for);
}

std::vector<Decision> ExactVisibility::Impl::decideEach(const View& view, std::span<const ObjectId> objects,
                                                        std::uint32_t max_steps, Decide decide,
                                                        const ParallelFor& parallel_for) const {
  std::vector<Decision> decisions(objects.size());
  parallel_for(static_cast<std::uint32_t>(objects.size()), [&](std::uint32_t begin, std::uint32_t end) {
    VisibilityProof proof(proofs, rays, view);
    for (std::uint32_t i = begin; i < end; ++i) {
      decisions[i] = (proof.*decide)(objects[i], max_steps);
    }
  });
  return decisions;
}

}  // namespace sightline
