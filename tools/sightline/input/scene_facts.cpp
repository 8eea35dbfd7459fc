#include "tools/sightline/input/scene_facts.h"

#include <memory>
#include <span>
#include <vector>

#include "sightline/math/frustum.h"

namespace sightline::tool {
namespace {

constexpr std::size_t kObjectsSeen = 50'000;
constexpr std::uint64_t kTrianglesSeen = 300'000;
constexpr std::size_t kFramesSeen = 16;

// Every so manieth of `count` things, so that no more than `most` are taken.
std::size_t stepFor(std::uint64_t count, std::uint64_t most) {
  return static_cast<std::size_t>((count + most - 1) / most);
}

std::uint64_t trianglesOf(std::span<const Object> objects) {
  std::uint64_t triangles = 0;
  for (const Object& object : objects) {
    triangles += object.triangleCount();
  }
  return triangles;
}

// What is looked at: all objects, or evenly many of them.
std::vector<Object> sampled(const Scene& scene) {
  std::vector<Object> objects;
  const std::size_t step = stepFor(scene.objects.size(), kObjectsSeen);
  for (std::size_t i = 0; i < scene.objects.size(); i += step) {
    objects.push_back(scene.objects[i]);
  }
  return objects;
}

double seeThroughShare(const Scene& scene) {
  std::uint64_t see_through = 0;
  for (const Object& object : scene.objects) {
    see_through += scene.view().materialOf(object).opaque() ? 0 : object.triangleCount();
  }
  return static_cast<double>(see_through) / static_cast<double>(scene.triangleCount());
}

// Of objects with very many triangles, only the first ones are looked at, the same part of each object.
double occluderArea(const Scene& scene, std::vector<Object> objects) {
  const std::size_t step = stepFor(trianglesOf(objects), kTrianglesSeen);
  for (Object& object : objects) {
    object.index_count = static_cast<std::uint32_t>(3 * stepFor(object.triangleCount(), step));
  }
  SceneView view = scene.view();
  view.objects = objects;
  const double part = static_cast<double>(trianglesOf(objects)) / static_cast<double>(scene.triangleCount());
  const double box = static_cast<double>(surfaceArea(sceneBounds(scene.view())));
  return box > 0.0 ? findOccluders(view).area / part / box : 0.0;
}

double meanInFrustum(const Scene& scene, const Walk& walk, std::span<const Object> objects) {
  const std::size_t step = stepFor(walk.frames.size(), kFramesSeen);
  std::uint64_t inside = 0, frames = 0;
  for (std::size_t i = 0; i < walk.frames.size(); i += step) {
    const Frustum frustum = frustumOf(walk.view(walk.frames[i], scene));
    frames += 1;
    for (const Object& object : objects) {
      std::uint8_t planes = kAllFrustumPlanes;
      inside += classify(frustum, object.bounds, planes) != FrustumSide::kOutside ? 1 : 0;
    }
  }
  const double part = static_cast<double>(objects.size()) / static_cast<double>(scene.objects.size());
  return static_cast<double>(inside) / static_cast<double>(frames) / part;
}

}  // namespace

SceneFacts lookAt(const SceneAndWalk& input) {
  const Scene& scene = input.scene;
  const std::vector<Object> objects = sampled(scene);
  return {.see_through = seeThroughShare(scene),
          .occluder_area = occluderArea(scene, objects),
          .in_frustum = meanInFrustum(scene, input.walk, objects),
          .baked = input.baked.has_value()};
}

Result<std::vector<Setting>> settingsFor(const MethodOptions& options, std::vector<Setting> checked,
                                         const SceneAndWalk& input) {
  if (!asksForChoice(options)) {
    return checked;
  }
  return settingsOf(options, std::make_shared<const MethodChoice>(chooseMethod(lookAt(input))));
}

}  // namespace sightline::tool
