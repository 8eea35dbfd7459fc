// What does a frame's culling cost as the scene grows? The built-in city with 3 to 3,100 copies, about 1,000
// to 1,000,000 objects, the same kind of walk through each. In the same run, on the same frames:
//
//   walk       the hierarchical walk with the occlusion tree, as Culler does it (choice, tree and walk)
//   all boxes  the same tree of the same occluders, asked about the box of every object
//   rays       one ray for each pixel of a 320 x 180 buffer (Embree), a pyramid of its farthest depths, and a
//   test of
//              the boxes that the frustum holds: the way Godot culls; not conservative, beside only for its
//              time
//
//   scaling [COPIES...]

#include <embree3/rtcore.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <string>
#include <vector>

#include "scenes/procedural.h"
#include "sightline/culling/culler.h"

namespace {

using namespace sightline;

constexpr int kWidth = 320, kHeight = 180, kFrames = 20;

double microseconds(const auto& function) {
  const auto start = std::chrono::steady_clock::now();
  function();
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0.0 : values[values.size() / 2];
}

// A buffer of ray-cast depths and the coarser levels that hold the farthest of 2 x 2.
class RayBuffer {
 public:
  explicit RayBuffer(const SceneView& scene) {
    for (const Object& object : scene.objects) {
      if (scene.materialOf(object).opaque()) {
        const auto part = scene.indicesOf(object);
        indices_.insert(indices_.end(), part.begin(), part.end());
      }
    }
    device_ = rtcNewDevice("threads=2");
    geometry_ = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    positions_.assign(scene.positions.begin(), scene.positions.end());
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
  ~RayBuffer() {
    rtcReleaseScene(scene_);
    rtcReleaseGeometry(geometry_);
    rtcReleaseDevice(device_);
  }
  RayBuffer(const RayBuffer&) = delete;
  RayBuffer& operator=(const RayBuffer&) = delete;

  void cast(const View& view) {
    clip_ = clipFromScene(view);
    levels_.assign(1, {kWidth, kHeight, std::vector<float>(kWidth * kHeight)});
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; x += 16) {
        castPacket(view, x, y);
      }
    }
    while (levels_.back().width > 1 || levels_.back().height > 1) {
      levels_.push_back(coarser(levels_.back()));
    }
  }

  // Conservative only with respect to the rays that were cast.
  bool mayShow(const Box& box) const {
    double low_x = 1e9, high_x = -1e9, low_y = 1e9, high_y = -1e9, nearest = 1e30;
    for (int i = 0; i < 8; ++i) {
      const Vec3d p((i & 1) != 0 ? box.max.x : box.min.x, (i & 2) != 0 ? box.max.y : box.min.y,
                    (i & 4) != 0 ? box.max.z : box.min.z);
      const double w = clip_(3, 0) * p.x + clip_(3, 1) * p.y + clip_(3, 2) * p.z + clip_(3, 3);
      if (w <= 1e-3) {
        return true;
      }
      const Vec3d q = transformPoint(clip_, p);
      low_x = std::min(low_x, q.x / w), high_x = std::max(high_x, q.x / w);
      low_y = std::min(low_y, q.y / w), high_y = std::max(high_y, q.y / w);
      nearest = std::min(nearest, w);
    }
    const auto pixel = [](double ndc, int size) {
      return std::clamp(static_cast<int>((ndc * 0.5 + 0.5) * size), 0, size - 1);
    };
    int x0 = pixel(low_x, kWidth), x1 = pixel(high_x, kWidth), y0 = pixel(low_y, kHeight),
        y1 = pixel(high_y, kHeight);
    std::size_t level = 0;
    while ((x1 - x0 > 3 || y1 - y0 > 3) && level + 1 < levels_.size()) {
      ++level, x0 /= 2, x1 /= 2, y0 /= 2, y1 /= 2;
    }
    const Level& at = levels_[level];
    for (int y = y0; y <= std::min(y1, at.height - 1); ++y) {
      for (int x = x0; x <= std::min(x1, at.width - 1); ++x) {
        if (nearest < at.depth[static_cast<std::size_t>(y * at.width + x)]) {
          return true;
        }
      }
    }
    return false;
  }

 private:
  struct Level {
    int width, height;
    std::vector<float> depth;
  };

  void castPacket(const View& view, int x0, int y) {
    alignas(64) RTCRayHit16 packet;
    alignas(64) int valid[16];
    for (int i = 0; i < 16; ++i) {
      const double x = 2.0 * (x0 + i + 0.5) / kWidth - 1.0, v = 2.0 * (y + 0.5) / kHeight - 1.0;
      const Vec3d d = view.forward + view.right * (x * view.tan_half_fovy * view.aspect) +
                      view.up * (v * view.tan_half_fovy);
      packet.ray.org_x[i] = static_cast<float>(view.eye.x), packet.ray.dir_x[i] = static_cast<float>(d.x);
      packet.ray.org_y[i] = static_cast<float>(view.eye.y), packet.ray.dir_y[i] = static_cast<float>(d.y);
      packet.ray.org_z[i] = static_cast<float>(view.eye.z), packet.ray.dir_z[i] = static_cast<float>(d.z);
      packet.ray.tnear[i] = static_cast<float>(view.near), packet.ray.tfar[i] = static_cast<float>(view.far);
      packet.ray.time[i] = 0.0f, packet.ray.mask[i] = 0xffffffffu;
      packet.ray.id[i] = packet.ray.flags[i] = 0;
      packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
      valid[i] = -1;
    }
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersect16(valid, scene_, &context, &packet);
    for (int i = 0; i < 16; ++i) {
      levels_[0].depth[static_cast<std::size_t>(y * kWidth + x0 + i)] = packet.ray.tfar[i];
    }
  }

  static Level coarser(const Level& fine) {
    Level level{(fine.width + 1) / 2, (fine.height + 1) / 2, {}};
    level.depth.assign(static_cast<std::size_t>(level.width * level.height), 0.0f);
    for (int y = 0; y < fine.height; ++y) {
      for (int x = 0; x < fine.width; ++x) {
        float& depth = level.depth[static_cast<std::size_t>(y / 2 * level.width + x / 2)];
        depth = std::max(depth, fine.depth[static_cast<std::size_t>(y * fine.width + x)]);
      }
    }
    return level;
  }

  std::vector<std::uint32_t> indices_;
  std::vector<Vec3f> positions_;
  RTCDevice device_ = nullptr;
  RTCGeometry geometry_ = nullptr;
  RTCScene scene_ = nullptr;
  Mat4 clip_;
  std::vector<Level> levels_;
};

void measure(std::uint32_t copies) {
  const Scene scene = makeCity({.copies = copies});
  std::vector<Box> bounds;
  std::vector<std::uint32_t> cost;
  for (const Object& object : scene.objects) {
    bounds.push_back(object.bounds);
    cost.push_back(object.triangleCount());
  }
  Hierarchy hierarchy;
  const double hierarchy_us = microseconds([&] { hierarchy = buildHierarchy(bounds, cost); });
  OccluderSet occluders;
  const double find_us = microseconds([&] { occluders = findOccluders(scene.view()); });
  RayBuffer rays(scene.view());

  const CullerSettings settings;
  Culler culler(hierarchy, bounds, occluders, settings);
  Culler frustum(hierarchy, bounds, occluders, {.method = CullMethod::kFrustum});
  OcclusionTree tree({.variant = settings.variant});
  std::vector<double> walk_us, boxes_us, rays_us;
  double kept = 0.0, kept_rays = 0.0, in_frustum = 0.0;
  const CameraPath& path = scene.paths[0];
  for (int i = 0; i < 40 + kFrames; ++i) {
    const View view = path.view(static_cast<std::size_t>(i), scene.origin);
    const double us = microseconds([&] { culler.cull(view); });
    if (i < 40) {
      continue;  // warm-up
    }
    walk_us.push_back(us);
    kept += static_cast<double>(culler.visible().size()) / kFrames;
    const std::vector<OccluderId> used(culler.occludersUsed().begin(), culler.occludersUsed().end());
    const Frustum planes = frustumOf(view);
    std::size_t seen = 0;
    boxes_us.push_back(microseconds([&] {
      tree.build(view, occluders, used);
      for (const Box& box : bounds) {
        std::uint8_t mask = kAllFrustumPlanes;
        seen +=
            classify(planes, box, mask) != FrustumSide::kOutside && tree.classify(box) != Visibility::kHidden;
      }
    }));
    std::size_t shown = 0;
    rays_us.push_back(microseconds([&] {
      frustum.cull(view);
      rays.cast(view);
      for (const ObjectId object : frustum.visible()) {
        shown += rays.mayShow(bounds[object.value]) ? 1 : 0;
      }
    }));
    kept_rays += static_cast<double>(shown) / kFrames;
    in_frustum += static_cast<double>(frustum.visible().size()) / kFrames;
  }
  fmt::print(
      "{:>9} {:>10.1f} {:>10.1f} | {:>9.0f} {:>11.0f} {:>9.0f} | {:>8.1f} {:>8.1f} | {:>9.0f} {:>8.0f} "
      "{:>8.0f}\n",
      scene.objects.size(), hierarchy_us * 1e-3, find_us * 1e-3, median(walk_us), median(boxes_us),
      median(rays_us), median(boxes_us) / median(walk_us), median(rays_us) / median(walk_us), in_frustum,
      kept, kept_rays);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::uint32_t> copies{3, 30, 300, 3100};
  std::vector<std::uint32_t> given;
  for (int i = 1; i < argc; ++i) {
    if (argv[i][0] != '-') {
      given.push_back(static_cast<std::uint32_t>(std::stoul(argv[i])));
    }
  }
  fmt::print("{:>9} {:>10} {:>10} | {:>9} {:>11} {:>9} | {:>8} {:>8} | {:>9} {:>8} {:>8}\n", "objects",
             "hierarchy", "occluders", "walk", "all boxes", "rays", "boxes", "rays", "frustum", "kept",
             "kept by");
  fmt::print("{:>9} {:>10} {:>10} | {:>9} {:>11} {:>9} | {:>8} {:>8} | {:>9} {:>8} {:>8}\n", "", "ms", "ms",
             "us", "us", "us", "/ walk", "/ walk", "objects", "objects", "rays");
  for (const std::uint32_t count : given.empty() ? copies : given) {
    measure(count);
  }
}
