// What does a frame's culling cost as the scene grows? The built-in city with 3 to 3,100 copies, about 1,000
// to 1,000,000 objects, the same kind of walk through each. In the same run, on the same frames:
//
//   walk       the hierarchical walk with the occlusion tree, as AnyCuller does it (choice, tree and walk)
//   all boxes  the same tree of the same occluders, asked about the box of every object
//   rays       one ray for each pixel of a 320 x 180 buffer (Embree), a pyramid of its farthest depths, and a
//              test of the boxes that the frustum holds: the way Godot culls; not conservative, beside only
//              for its time
//
//   scaling [COPIES...]

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "bench/benchmark_scene.h"
#include "bench/measuring.h"
#include "bench/ray_depth.h"
#include "scenes/procedural.h"
#include "tests/support/any_culler.h"

namespace {

using namespace sightline;
using namespace sightline::bench;

constexpr std::uint32_t kWidth = 320, kHeight = 180;
constexpr int kFrames = 20;

// Ray-cast depths and the coarser levels that hold the farthest of 2 x 2.
class RayPyramid {
 public:
  explicit RayPyramid(const SceneView& scene) : rays_(scene) {}

  void cast(const View& view, std::uint32_t width, std::uint32_t height) {
    rays_.cast(view, width, height);
    levels_.assign(1, {static_cast<int>(width), static_cast<int>(height), {}});
    levels_[0].depth.assign(rays_.depth().begin(), rays_.depth().end());
    while (levels_.back().width > 1 || levels_.back().height > 1) {
      levels_.push_back(coarser(levels_.back()));
    }
  }

  // Conservative only with respect to the rays that were cast.
  bool mayShow(const Box& box) const {
    const std::optional<RayDepth::Rectangle> rectangle = rays_.rectangleOf(box);
    if (!rectangle) {
      return true;
    }
    auto [x0, x1, y0, y1, nearest] = *rectangle;
    std::size_t level = 0;
    while ((x1 - x0 > 3 || y1 - y0 > 3) && level + 1 < levels_.size()) {
      ++level, x0 /= 2, x1 /= 2, y0 /= 2, y1 /= 2;
    }
    const Level& at = levels_[level];
    for (int y = y0; y <= y1; ++y) {
      for (int x = x0; x <= x1; ++x) {
        if (nearest <= static_cast<double>(at.depth[static_cast<std::size_t>(y * at.width + x)])) {
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

  RayDepth rays_;
  std::vector<Level> levels_;
};

void measure(std::uint32_t copies) {
  const BenchmarkScene city(makeCity({.copies = copies}));
  const Scene& scene = city.scene;
  const std::vector<Box>& bounds = city.bounds;
  Hierarchy hierarchy;
  const double hierarchy_us = microseconds([&] { hierarchy = buildHierarchy(bounds, city.cost); });
  OccluderSet occluders;
  const double find_us = microseconds([&] { occluders = findOccluders(scene.view()); });
  RayPyramid rays(scene.view());

  const AnySettings settings;
  AnyCuller culler(hierarchy, bounds, occluders, settings);
  AnyCuller frustum(hierarchy, bounds, occluders, {.method = AnyMethod::kFrustum});
  OcclusionTree tree({.variant = settings.variant});
  std::vector<double> walk_us, boxes_us, rays_us;
  std::vector<ObjectId> shown;
  double kept = 0.0, kept_rays = 0.0, in_frustum = 0.0;
  for (int i = 0; i < 40 + kFrames; ++i) {
    const View view = city.path.view(static_cast<std::size_t>(i), scene.origin);
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
    const RayTimes times = cullByRays(rays, frustum, bounds, view, kWidth, kHeight, shown);
    rays_us.push_back(times.rays_us + times.boxes_us);
    kept_rays += static_cast<double>(shown.size()) / kFrames;
    in_frustum += static_cast<double>(frustum.visible().size()) / kFrames;
  }
  fmt::print(
      "{:>9} {:>10.1f} {:>10.1f} | {:>9.0f} {:>11.0f} {:>9.0f} | {:>8.1f} {:>8.1f} | {:>9.0f} {:>8.0f} "
      "{:>8.0f}\n",
      scene.objects.size(), hierarchy_us * 1e-3, find_us * 1e-3, medianOf(walk_us), medianOf(boxes_us),
      medianOf(rays_us), medianOf(boxes_us) / medianOf(walk_us), medianOf(rays_us) / medianOf(walk_us),
      in_frustum, kept, kept_rays);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::uint32_t> copies{3, 30, 300, 3100};
  std::vector<std::uint32_t> given;
  for (const std::string& word : argumentsOf(argc, argv).words) {
    given.push_back(static_cast<std::uint32_t>(std::stoul(word)));
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
