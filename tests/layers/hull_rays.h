#pragma once

// Finds the hulls of a moving scene that a ray hits, and where. Embree finds candidates in single precision,
// which are then tested so strictly that rounding cannot add a hit.

#include <embree3/rtcore.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "scenes/moving_scene.h"
#include "sightline/math/mat4.h"

namespace sightline::test {

// The stretch of a ray inside a part, as distances in lengths of the direction.
struct RayStretch {
  std::uint32_t part = 0;
  double enter = 0.0, leave = 0.0;
};

class HullRays {
 public:
  // Takes the placed solid hulls of all parts except overlays and backdrops.
  HullRays(const MovingScene& scene, std::span<const Mat4> world_from_part)
      : device_(rtcNewDevice(nullptr)), embree_(rtcNewScene(device_.get())) {
    EXPECT_TRUE(rtcGetDeviceProperty(device_.get(), RTC_DEVICE_PROPERTY_FILTER_FUNCTION_SUPPORTED));
    rtcSetSceneFlags(embree_.get(), RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
    for (std::uint32_t part = 0; part < scene.parts.size(); ++part) {
      part_from_world_.push_back(inverse(world_from_part[part]));
      if (scene.parts[part].settings.place == PartSettings::Place::kSorted) {
        for (const std::uint32_t hull : scene.parts[part].hulls) {
          add(part, scene.hulls[hull], world_from_part[part]);
        }
      }
    }
    rtcCommitScene(embree_.get());
  }

  // Returns the parts whose hulls, shrunk by a billionth, the ray hits, by number.
  std::vector<RayStretch> hits(const Vec3d& from, const Vec3d& direction) const {
    Hits hits;
    rtcInitIntersectContext(&hits.context);
    hits.context.filter = collect;
    RTCRay ray{};
    ray.org_x = static_cast<float>(from.x);
    ray.org_y = static_cast<float>(from.y);
    ray.org_z = static_cast<float>(from.z);
    ray.dir_x = static_cast<float>(direction.x);
    ray.dir_y = static_cast<float>(direction.y);
    ray.dir_z = static_cast<float>(direction.z);
    ray.tfar = std::numeric_limits<float>::infinity();
    ray.mask = 0xffffffffu;
    rtcOccluded1(embree_.get(), &hits.context, &ray);
    std::sort(hits.geometries.begin(), hits.geometries.end());
    hits.geometries.erase(std::unique(hits.geometries.begin(), hits.geometries.end()), hits.geometries.end());
    std::vector<RayStretch> stretches;
    for (const std::uint32_t geometry : hits.geometries) {
      if (const std::optional<RayStretch> stretch = inside(geometry, from, direction)) {
        stretches.push_back(*stretch);
      }
    }
    return stretches;
  }

 private:
  struct Instance {
    std::uint32_t part = 0;
    const ConvexHull* hull = nullptr;
  };
  struct Hits {
    RTCIntersectContext context;  // must be the first member: the filter casts its address
    std::vector<std::uint32_t> geometries;
  };
  struct Release {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
  };

  // Records the geometry and lets the ray pass.
  static void collect(const RTCFilterFunctionNArguments* arguments) {
    auto* hits = reinterpret_cast<Hits*>(arguments->context);
    hits->geometries.push_back(RTCHitN_geomID(arguments->hit, 1, 0));
    arguments->valid[0] = 0;
  }

  static Mat4 inverse(const Mat4& m) {
    const Vec3d x(m(0, 0), m(1, 0), m(2, 0)), y(m(0, 1), m(1, 1), m(2, 1)), z(m(0, 2), m(1, 2), m(2, 2));
    const double determinant = dot(x, cross(y, z));
    const Vec3d rows[] = {cross(y, z) / determinant, cross(z, x) / determinant, cross(x, y) / determinant};
    const Vec3d origin(m(0, 3), m(1, 3), m(2, 3));
    Mat4 result;
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) {
        result(row, column) = rows[row][column];
      }
      result(row, 3) = -dot(rows[row], origin);
    }
    return result;
  }

  void add(std::uint32_t part, const ConvexHull& hull, const Mat4& world_from_part) {
    if (hull.dimension < 3) {
      return;
    }
    RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), hull.vertices.size()));
    for (const Vec3d& vertex : hull.vertices) {
      const Vec3d world = transformPoint(world_from_part, vertex);
      for (int axis = 0; axis < 3; ++axis) {
        *vertices++ = static_cast<float>(world[axis]);
      }
    }
    auto* indices = static_cast<std::uint32_t*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                3 * sizeof(std::uint32_t), hull.triangles.size()));
    for (const auto& triangle : hull.triangles) {
      indices = std::copy(triangle.begin(), triangle.end(), indices);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(embree_.get(), geometry, static_cast<unsigned>(instances_.size()));
    rtcReleaseGeometry(geometry);
    instances_.push_back({part, &hull});
  }

  // Clips the ray to the hull in double precision, in the hull's space.
  std::optional<RayStretch> inside(std::uint32_t geometry, const Vec3d& from, const Vec3d& direction) const {
    const Instance& instance = instances_[geometry];
    const Mat4& m = part_from_world_[instance.part];
    const Vec3d start = transformPoint(m, from), along = transformDirection(m, direction);
    const double margin =
        1e-9 * (instance.hull->radius + length(instance.hull->centre)) + 1e-14 * length(start);
    RayStretch stretch{instance.part, 0.0, std::numeric_limits<double>::infinity()};
    for (const Plane& face : instance.hull->faces) {
      const double height = face.evaluate(start) + margin, slope = dot(face.normal, along);
      if (slope < 0.0) {
        stretch.enter = std::max(stretch.enter, height / -slope);
      } else if (slope > 0.0) {
        stretch.leave = std::min(stretch.leave, -height / slope);
      } else if (height > 0.0) {
        return std::nullopt;
      }
    }
    return stretch.enter < stretch.leave ? std::optional(stretch) : std::nullopt;
  }

  std::vector<Mat4> part_from_world_;
  std::vector<Instance> instances_;
  std::unique_ptr<RTCDeviceTy, Release> device_;
  std::unique_ptr<RTCSceneTy, Release> embree_;
};

}  // namespace sightline::test
