#include "tools/sightline/input/layer_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "scenes/procedural.h"
#include "scenes/split_scene.h"
#include "sightline/layers/convex_pieces.h"
#include "tools/sightline/command_line/progress_bar.h"

namespace sightline::tool {
namespace {

// The hull of an object's vertices, or several of pieces of its triangles.
Result<std::vector<ConvexHull>> hullsOf(const Scene& scene, std::size_t object, std::uint32_t max_pieces) {
  const std::span<const std::uint32_t> indices = scene.view().indicesOf(scene.objects[object]);
  std::vector<std::uint32_t> corners(indices.begin(), indices.end());
  std::sort(corners.begin(), corners.end());
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  std::vector<Vec3d> points;
  for (const std::uint32_t corner : corners) {
    points.emplace_back(scene.positions[corner]);
  }
  Result<std::vector<ConvexHull>> hulls = std::vector<ConvexHull>();
  if (max_pieces > 1) {
    std::vector<std::array<std::uint32_t, 3>> triangles(indices.size() / 3);
    for (std::size_t i = 0; i < 3 * triangles.size(); ++i) {
      const auto corner = std::lower_bound(corners.begin(), corners.end(), indices[i]);
      triangles[i / 3][i % 3] = static_cast<std::uint32_t>(corner - corners.begin());
    }
    hulls = convexPieces(points, triangles, {.max_pieces = max_pieces});
  } else if (Result<ConvexHull> hull = buildHull(points)) {
    hulls->push_back(std::move(*hull));
  } else {
    hulls = hull.error();
  }
  return hulls ? std::move(hulls)
               : Error{fmt::format("object {} ({}) has no convex hull: {}", object,
                                   scene.object_names[object], hulls.error().message)};
}

Result<MovingScene> withoutMotion(Scene scene, std::uint32_t max_pieces) {
  MovingScene moving;
  ProgressBar progress("convex hulls");
  for (std::size_t object = 0; object < scene.objects.size(); ++object) {
    Result<std::vector<ConvexHull>> hulls = hullsOf(scene, object, max_pieces);
    if (!hulls) {
      return hulls.error();
    }
    MovingPart& part = moving.parts.emplace_back();
    part.name = scene.object_names[object];
    part.settings.is_static = true;
    for (ConvexHull& hull : *hulls) {
      part.hulls.push_back(static_cast<std::uint32_t>(moving.hulls.size()));
      moving.hulls.push_back(std::move(hull));
    }
    progress.update(static_cast<double>(object + 1) / static_cast<double>(scene.objects.size()));
  }
  moving.frames = 0;
  moving.scene = std::move(scene);
  return moving;
}

Result<MovingScene> loadMoving(const std::string& name, const LayerDivision& division) {
  if (isMovingDemoUrl(name)) {
    if (division.max_pieces > 1) {
      return Error{fmt::format("--pieces {}: the parts of {} move and have hulls of their own",
                               division.max_pieces, name)};
    }
    if (division.split_width > 0.0) {
      return Error{
          fmt::format("--pre-split {}: the parts of {} move and stay whole", division.split_width, name)};
    }
    return makeMovingDemoScene(name);
  }
  Result<Scene> scene = loadScene(name);
  if (!scene) {
    return scene.error();
  }
  if (!(division.split_width > 0.0)) {
    return withoutMotion(std::move(*scene), division.max_pieces);
  }
  ProgressBar progress("large objects cut");
  SplitScene split = splitScene(*scene, division.split_width, division.split_overlap,
                                [&](double done) { progress.update(done); });
  Result<MovingScene> moving = withoutMotion(std::move(split.scene), division.max_pieces);
  if (moving) {
    moving->planes = std::move(split.planes);
  }
  return moving;
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
                                  const LayerPlaces& places, const LayerDivision& division) {
  Result<MovingScene> scene = loadMoving(scene_name, division);
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
