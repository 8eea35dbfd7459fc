#pragma once

// The opaque triangles of a scene, and which of their positions are equal, on several threads.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "sightline/base/large_vector.h"
#include "sightline/base/parallel_for.h"
#include "sightline/scene/scene.h"
#include "src/base/parts.h"
#include "src/occluders/surfaces/surface_mesh.h"

namespace sightline::occluders {

// The opaque triangles of a scene, numbered in its order, in parts of about the same size.
class OpaqueParts {
 public:
  explicit OpaqueParts(const SceneView& scene);

  std::size_t count() const { return parts_.count(); }
  // Calls use(part) for each part.
  template <typename Use>
  void run(const ParallelFor& parallel_for, const Use& use) const {
    base::forEach(parallel_for, count(), use);
  }
  // Calls use(number, corners, object) for the triangles of a part that are finite.
  template <typename Use>
  void forEachTriangle(std::size_t part, const Use& use) const {
    std::size_t number = parts_.begin(part);
    auto object = static_cast<std::uint32_t>(
        std::upper_bound(first_of_object_.begin(), first_of_object_.end(), number) -
        first_of_object_.begin() - 1);
    for (; number < parts_.end(part); ++object) {
      const std::span<const std::uint32_t> indices = scene_.indicesOf(scene_.objects[object]);
      const std::size_t first = first_of_object_[object];
      const std::size_t end = std::min<std::size_t>(parts_.end(part), first_of_object_[object + 1]);
      for (; number < end; ++number) {
        const std::span<const std::uint32_t> corners = indices.subspan(3 * (number - first), 3);
        if (all_finite_ || isFiniteTriangle(scene_, corners)) {
          use(static_cast<std::uint32_t>(number), corners, object);
        }
      }
    }
  }

 private:
  SceneView scene_;
  LargeVector<std::uint32_t> first_of_object_;  // its first triangle; and one more
  base::Parts parts_{0, 1};
  bool all_finite_ = false;  // all positions of the scene are
};

struct WeldedVertices {
  LargeVector<Vec3f> vertices;             // in the order in which opaque triangles use them
  LargeVector<std::uint32_t> position_of;  // by vertex: the first of the scene's positions there
  LargeVector<std::uint32_t> vertex_of;    // by position, where opaque triangles use it
};

WeldedVertices weldVertices(const SceneView& scene, const OpaqueParts& triangles,
                            const ParallelFor& parallel_for);

}  // namespace sightline::occluders
