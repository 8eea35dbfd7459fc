#pragma once

// A depth buffer by ray casting, and boxes compared with it: what a culler can do that has Embree and no
// occluders. One core. Not conservative: what is seen between two rays is hidden.

#include <embree3/rtcore.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "bench/measuring.h"
#include "sightline/scene/scene.h"
#include "tests/support/any_culler.h"

namespace sightline::bench {

class RayDepth {
 public:
  // Of the opaque triangles, whichever way they face. Perspective views only.
  explicit RayDepth(const SceneView& scene) : positions_(scene.positions.begin(), scene.positions.end()) {
    for (const Object& object : scene.objects) {
      if (scene.materialOf(object).opaque()) {
        const auto part = scene.indicesOf(object);
        indices_.insert(indices_.end(), part.begin(), part.end());
      }
    }
    device_ = rtcNewDevice("threads=1");
    geometry_ = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    positions_.emplace_back();  // Embree reads 16 bytes of each
    rtcSetSharedGeometryBuffer(geometry_, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, positions_.data(), 0,
                               sizeof(Vec3f), positions_.size() - 1);
    rtcSetSharedGeometryBuffer(geometry_, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, indices_.data(), 0,
                               3 * sizeof(std::uint32_t), indices_.size() / 3);
    rtcCommitGeometry(geometry_);
    scene_ = rtcNewScene(device_);
    rtcAttachGeometry(scene_, geometry_);
    rtcCommitScene(scene_);
  }
  ~RayDepth() {
    rtcReleaseScene(scene_);
    rtcReleaseGeometry(geometry_);
    rtcReleaseDevice(device_);
  }
  RayDepth(const RayDepth&) = delete;
  RayDepth& operator=(const RayDepth&) = delete;

  // One ray through the centre of each pixel.
  void cast(const View& view, std::uint32_t width, std::uint32_t height) {
    view_ = view;
    width_ = static_cast<int>(width), height_ = static_cast<int>(height);
    depth_.resize(std::size_t{width} * height);
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; x += kPacket) {
        castPacket(x, y);
      }
    }
  }

  // Of the last cast: metres along forward, row after row, the lowest first.
  std::span<const float> depth() const { return depth_; }

  // Pixels x0 to x1 of rows y0 to y1, and the nearest depth of the box.
  struct Rectangle {
    int x0, x1, y0, y1;
    double nearest;
  };
  // In the view of the last cast. None: the box reaches the near plane.
  std::optional<Rectangle> rectangleOf(const Box& box) const {
    // Of the lower and the upper end of each axis: its part of a corner's place to the right, up and forward.
    Vec3d part[3][2];
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3d along(view_.right[axis], view_.up[axis], view_.forward[axis]);
      part[axis][0] = along * (static_cast<double>(box.min[axis]) - view_.eye[axis]);
      part[axis][1] = along * (static_cast<double>(box.max[axis]) - view_.eye[axis]);
    }
    double low_x = 1e30, high_x = -1e30, low_y = 1e30, high_y = -1e30, nearest = 1e30;
    for (unsigned i = 0; i < 8; ++i) {
      const Vec3d corner = part[0][i & 1] + part[1][i >> 1 & 1] + part[2][i >> 2];
      if (corner.z <= view_.z_near) {
        return std::nullopt;
      }
      const double per_depth = 1.0 / corner.z, x = corner.x * per_depth, y = corner.y * per_depth;
      low_x = std::min(low_x, x), high_x = std::max(high_x, x);
      low_y = std::min(low_y, y), high_y = std::max(high_y, y);
      nearest = std::min(nearest, corner.z);
    }
    const double half_height = view_.tan_half_fovy, half_width = half_height * view_.aspect;
    const double left = view_.shift_x, down = view_.shift_y;
    return Rectangle{pixel(low_x / half_width - left, width_), pixel(high_x / half_width - left, width_),
                     pixel(low_y / half_height - down, height_), pixel(high_y / half_height - down, height_),
                     nearest};
  }

  // Whether in some pixel of the box's rectangle nothing is nearer than the box. Boxes that reach the near
  // plane may show.
  bool mayShow(const Box& box) const {
    const std::optional<Rectangle> rectangle = rectangleOf(box);
    if (!rectangle) {
      return true;
    }
    const auto [x0, x1, y0, y1, nearest] = *rectangle;
    for (int y = y0; y <= y1; ++y) {
      const float* row = &depth_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_)];
      for (int x = x0; x <= x1; ++x) {
        if (nearest <= static_cast<double>(row[x])) {
          return true;
        }
      }
    }
    return false;
  }

 private:
  static constexpr int kPacket = 16;

  static int pixel(double ndc, int size) {
    return static_cast<int>(std::clamp((ndc * 0.5 + 0.5) * size, 0.0, size - 1.0));
  }

  void castPacket(int x0, int y) {
    alignas(64) RTCRayHit16 packet;
    alignas(64) int valid[kPacket];
    const double v = 2.0 * (y + 0.5) / height_ - 1.0 + view_.shift_y;
    for (int i = 0; i < kPacket; ++i) {
      const double u = 2.0 * (x0 + i + 0.5) / width_ - 1.0 + view_.shift_x;
      const Vec3d d = view_.forward + view_.right * (u * view_.tan_half_fovy * view_.aspect) +
                      view_.up * (v * view_.tan_half_fovy);
      auto& ray = packet.ray;
      ray.org_x[i] = static_cast<float>(view_.eye.x), ray.dir_x[i] = static_cast<float>(d.x);
      ray.org_y[i] = static_cast<float>(view_.eye.y), ray.dir_y[i] = static_cast<float>(d.y);
      ray.org_z[i] = static_cast<float>(view_.eye.z), ray.dir_z[i] = static_cast<float>(d.z);
      ray.tnear[i] = static_cast<float>(view_.z_near), ray.tfar[i] = static_cast<float>(view_.z_far);
      ray.time[i] = 0.0f, ray.mask[i] = 0xffffffffu;
      ray.id[i] = ray.flags[i] = 0;
      packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
      valid[i] = x0 + i < width_ ? -1 : 0;
    }
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersect16(valid, scene_, &context, &packet);
    for (int i = 0; i < kPacket && x0 + i < width_; ++i) {
      // The direction's part along forward is 1, so that the parameter is the depth.
      depth_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
             static_cast<std::size_t>(x0 + i)] = packet.ray.tfar[i];
    }
  }

  std::vector<std::uint32_t> indices_;
  std::vector<Vec3f> positions_;
  RTCDevice device_ = nullptr;
  RTCGeometry geometry_ = nullptr;
  RTCScene scene_ = nullptr;
  View view_;
  int width_ = 0, height_ = 0;
  std::vector<float> depth_;  // metres along forward, the lowest row first
};

struct RayTimes {
  double rays_us = 0.0, boxes_us = 0.0;
};

// A frame by rays: casts them and keeps what the frustum holds and may show. rays: a RayDepth, or what casts
// and answers as it does. frustum: a culler that does nothing else.
template <typename Rays>
RayTimes cullByRays(Rays& rays, AnyCuller& frustum, std::span<const Box> bounds, const View& view,
                    std::uint32_t width, std::uint32_t height, std::vector<ObjectId>& kept) {
  RayTimes times;
  times.rays_us = microseconds([&] { rays.cast(view, width, height); });
  times.boxes_us = microseconds([&] {
    frustum.cull(view);
    kept.clear();
    for (const ObjectId object : frustum.visible()) {
      if (rays.mayShow(bounds[object.value])) {
        kept.push_back(object);
      }
    }
  });
  return times;
}

}  // namespace sightline::bench
