#pragma once

// Rays against the triangles of a story, by brute force in double precision: shares nothing with the library.

#include <cmath>
#include <map>
#include <optional>
#include <vector>

#include "tests/world/world_story.h"

namespace sightline::world_story {

struct Hit {
  InstanceId id;
  double distance = 0.0;
  bool opaque = false;
};

class Rays {
 public:
  explicit Rays(const ToldScene& story) {
    std::vector<InstanceId> ids;
    const Scene scene = story.scene(ids);
    for (std::size_t o = 0; o < scene.objects.size(); ++o) {
      const Object& object = scene.objects[o];
      const Material& material = scene.materials[object.material.value];
      for (std::uint32_t i = 0; i < object.index_count; i += 3) {
        const auto at = [&](std::uint32_t c) {
          return Vec3d(scene.positions[scene.indices[object.first_index + i + c]]);
        };
        triangles_.push_back({ids[o], at(0), at(1) - at(0), at(2) - at(0), material.double_sided,
                              material.opacity == Opacity::kOpaque});
      }
    }
  }

  // What is drawn of the triangles along a ray of unit direction, within these distances; in no order.
  std::vector<Hit> hits(const Vec3d& from, const Vec3d& along, double near, double far) const {
    std::vector<Hit> hits;
    for (const Triangle& t : triangles_) {
      const Vec3d p = cross(along, t.v);
      const double det = dot(t.u, p);  // positive: its front is seen
      if (det == 0.0 || (det < 0.0 && !t.double_sided)) {
        continue;
      }
      const Vec3d s = from - t.at;
      const double u = dot(s, p) / det;
      const Vec3d q = cross(s, t.u);
      const double v = dot(along, q) / det, distance = dot(t.v, q) / det;
      if (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > near && distance < far) {
        hits.push_back({t.id, distance, t.opaque});
      }
    }
    return hits;
  }
  // The nearest opaque one.
  static std::optional<Hit> first(const std::vector<Hit>& hits) {
    std::optional<Hit> first;
    for (const Hit& hit : hits) {
      if (hit.opaque && (!first || hit.distance < first->distance)) {
        first = hit;
      }
    }
    return first;
  }

 private:
  struct Triangle {
    InstanceId id;
    Vec3d at, u, v;
    bool double_sided, opaque;
  };
  std::vector<Triangle> triangles_;
};

}  // namespace sightline::world_story
