#include "sightline/scene/object_clusters.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "src/base/parts.h"
#include "src/math/longest_axis.h"

namespace sightline {
namespace {

// The triangles of one object, and into which clusters they go.
class ClusterDivider {
 public:
  ClusterDivider(const SceneView& scene, const Object& object, const ObjectClustersSettings& settings)
      : scene_(scene),
        object_(object),
        indices_(scene.indicesOf(object)),
        max_triangles_(std::max(settings.max_triangles, 1u)),
        margin_(settings.margin) {}

  // Appends the clusters to `clusters` and the indices of their triangles to `indices`.
  void divide(std::vector<Object>& clusters, std::vector<std::uint32_t>& indices) {
    order_.resize(object_.triangleCount());
    std::iota(order_.begin(), order_.end(), 0u);
    if (order_.size() <= max_triangles_ || !measure()) {
      Object& whole = clusters.emplace_back(object_);
      whole.first_index = static_cast<std::uint32_t>(indices.size());
      indices.insert(indices.end(), indices_.begin(), indices_.end());
      return;
    }
    std::vector<std::span<std::uint32_t>> waiting{order_};
    while (!waiting.empty()) {
      const std::span<std::uint32_t> part = waiting.back();
      waiting.pop_back();
      if (part.size() <= max_triangles_) {
        add(part, clusters, indices);
      } else {
        const std::size_t half = halve(part);
        waiting.push_back(part.subspan(half));
        waiting.push_back(part.first(half));
      }
    }
  }

 private:
  // Finds the middles of the triangles. False if the object has to stay whole.
  bool measure() {
    Box bounds;
    middles_.resize(order_.size());
    for (std::size_t t = 0; t < order_.size(); ++t) {
      Box triangle;
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3f& corner = scene_.positions[indices_[3 * t + k]];
        if (!isFinite(corner)) {
          return false;
        }
        triangle.extend(corner);
      }
      bounds.extend(triangle);
      middles_[t] = (Vec3d(triangle.min) + Vec3d(triangle.max)) * 0.5;
    }
    return widened(bounds, margin_) == object_.bounds;
  }

  // Sorts some triangles so that those below the middle one come first, and returns how many these are.
  std::size_t halve(std::span<std::uint32_t> part) const {
    Vec3d low = middles_[part[0]], high = low;
    for (const std::uint32_t t : part) {
      low = min(low, middles_[t]);
      high = max(high, middles_[t]);
    }
    const int axis = math::longestAxis(high - low);
    const auto half = static_cast<std::ptrdiff_t>(part.size() / 2);
    std::nth_element(part.begin(), part.begin() + half, part.end(), [&](std::uint32_t a, std::uint32_t b) {
      return std::pair(middles_[a][axis], a) < std::pair(middles_[b][axis], b);
    });
    return static_cast<std::size_t>(half);
  }

  void add(std::span<std::uint32_t> part, std::vector<Object>& clusters,
           std::vector<std::uint32_t>& indices) const {
    std::sort(part.begin(), part.end());
    Object& cluster = clusters.emplace_back(object_);
    cluster.first_index = static_cast<std::uint32_t>(indices.size());
    cluster.index_count = static_cast<std::uint32_t>(3 * part.size());
    Box bounds;
    for (const std::uint32_t t : part) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t index = indices_[3 * std::size_t{t} + k];
        indices.push_back(index);
        bounds.extend(scene_.positions[index]);
      }
    }
    cluster.bounds = widened(bounds, margin_);
  }

  const SceneView& scene_;
  const Object& object_;
  const std::span<const std::uint32_t> indices_;
  const std::uint32_t max_triangles_;
  const double margin_;
  std::vector<std::uint32_t> order_;  // numbers of triangles
  std::vector<Vec3d> middles_;        // by triangle
};

}  // namespace

void ObjectClusters::objectsOf(std::span<const ObjectId> visible, std::vector<ObjectId>& objects) const {
  objects.clear();
  for (const ObjectId cluster : visible) {
    if (objects.empty() || objects.back() != object_of[cluster.value]) {
      objects.push_back(object_of[cluster.value]);
    }
  }
}

ObjectClusters findObjectClusters(const SceneView& scene, const ObjectClustersSettings& settings,
                                  const ParallelFor& parallel_for) {
  struct Divided {
    std::vector<Object> clusters;
    std::vector<std::uint32_t> indices;
  };
  std::vector<Divided> of_object(scene.objects.size());
  base::forEach(parallel_for, of_object.size(), [&](std::uint32_t object) {
    ClusterDivider(scene, scene.objects[object], settings)
        .divide(of_object[object].clusters, of_object[object].indices);
  });
  ObjectClusters found;
  found.first.push_back(0);
  for (std::size_t object = 0; object < of_object.size(); ++object) {
    const auto offset = static_cast<std::uint32_t>(found.indices.size());
    for (Object& cluster : of_object[object].clusters) {
      cluster.first_index += offset;
      found.clusters.push_back(cluster);
      found.object_of.emplace_back(object);
    }
    found.first.push_back(static_cast<std::uint32_t>(found.clusters.size()));
    found.indices.insert(found.indices.end(), of_object[object].indices.begin(),
                         of_object[object].indices.end());
    of_object[object] = {};
  }
  return found;
}

}  // namespace sightline
