#include "tools/sightline/input/layer_input.h"

#include <fmt/format.h>

#include <algorithm>

#include "scenes/procedural.h"
#include "tools/sightline/command_line/progress_bar.h"

namespace sightline::tool {
namespace {

// The hull of an object's vertices.
Result<ConvexHull> hullOf(const Scene& scene, std::size_t object) {
  std::vector<std::uint32_t> corners(
      scene.indices.begin() + scene.objects[object].first_index,
      scene.indices.begin() + scene.objects[object].first_index + scene.objects[object].index_count);
  std::sort(corners.begin(), corners.end());
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  std::vector<Vec3d> points;
  for (const std::uint32_t corner : corners) {
    points.emplace_back(scene.positions[corner]);
  }
  Result<ConvexHull> hull = buildHull(points);
  return hull ? std::move(hull)
              : Error{fmt::format("object {} ({}) has no convex hull: {}", object, scene.object_names[object],
                                  hull.error().message)};
}

Result<MovingScene> withoutMotion(Scene scene) {
  MovingScene moving;
  ProgressBar progress("convex hulls");
  for (std::size_t object = 0; object < scene.objects.size(); ++object) {
    Result<ConvexHull> hull = hullOf(scene, object);
    if (!hull) {
      return hull.error();
    }
    moving.hulls.push_back(std::move(*hull));
    moving.parts.push_back({.name = scene.object_names[object],
                            .hulls = {static_cast<std::uint32_t>(object)},
                            .settings = {.is_static = true}});
    progress.update(static_cast<double>(object + 1) / static_cast<double>(scene.objects.size()));
  }
  moving.frames = 0;
  moving.scene = std::move(scene);
  return moving;
}

Result<MovingScene> loadMoving(const std::string& name) {
  if (isMovingDemoUrl(name)) {
    return makeMovingDemoScene(name);
  }
  Result<Scene> scene = loadScene(name);
  return scene ? withoutMotion(std::move(*scene)) : scene.error();
}

Status setPlaces(MovingScene& scene, const std::vector<std::uint32_t>& parts, PartSettings::Place place,
                 const char* option) {
  for (const std::uint32_t part : parts) {
    if (part >= scene.parts.size()) {
      return Error{fmt::format("{} {}: there is no such part; the scene has {}, numbered from 0", option,
                               part, scene.parts.size())};
    }
    scene.parts[part].settings.place = place;
  }
  return Success{};
}

}  // namespace

Result<LayerInput> loadLayerInput(const std::string& scene_name, const PathOptions& path,
                                  const LayerPlaces& places) {
  Result<MovingScene> scene = loadMoving(scene_name);
  if (!scene) {
    return scene.error();
  }
  for (const std::uint32_t part : places.overlays) {
    if (std::find(places.backdrops.begin(), places.backdrops.end(), part) != places.backdrops.end()) {
      return Error{fmt::format("--overlay {}: the part is in --backdrop too", part)};
    }
  }
  if (const Status ok = setPlaces(*scene, places.backdrops, PartSettings::Place::kBackdrop, "--backdrop");
      !ok) {
    return ok.error();
  }
  if (const Status ok = setPlaces(*scene, places.overlays, PartSettings::Place::kOverlay, "--overlay"); !ok) {
    return ok.error();
  }
  Result<Walk> walk = loadWalk(path, scene_name, scene->scene);
  if (!walk) {
    return walk.error();
  }
  return LayerInput{std::move(*scene), std::move(*walk)};
}

}  // namespace sightline::tool
