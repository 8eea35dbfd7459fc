#include "tools/sightline/load.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>

#include "scenes/procedural.h"
#include "sightline/io/camera_path_json.h"
#include "sightline/io/import.h"
#include "tools/sightline/json_output.h"
#include "tools/sightline/names.h"
#include "tools/sightline/progress_bar.h"

namespace sightline::tool {
namespace {

constexpr const char* kPathBesideScene = "walk.path.json";

std::string pathNames(const Scene& scene) {
  std::string names;
  for (const CameraPath& path : scene.paths) {
    names += (names.empty() ? "" : ", ") + path.name;
  }
  return names;
}

Result<CameraPath> namedPath(const std::string& name, const Scene& scene) {
  for (const CameraPath& path : scene.paths) {
    if (path.name == name) {
      return path;
    }
  }
  std::error_code ignored;
  if (std::filesystem::exists(name, ignored)) {
    return readCameraPath(name);
  }
  const std::string walks = pathNames(scene);
  return Error{fmt::format("--path {}: there is no such file, and {}", name,
                           walks.empty() ? "the scene has no walks" : "the scene's walks are: " + walks)};
}

Result<CameraPath> defaultPath(const std::string& scene_name, const Scene& scene) {
  if (!isDemoUrl(scene_name)) {
    const std::filesystem::path beside = std::filesystem::path(scene_name).parent_path() / kPathBesideScene;
    std::error_code ignored;
    if (std::filesystem::is_regular_file(beside, ignored)) {
      Result<CameraPath> path = readCameraPath(beside.string());
      if (path) {
        fmt::print(stderr, "sightline: using the camera path {}\n", beside.string());
      }
      return path;
    }
  }
  if (!scene.paths.empty()) {
    return scene.paths.front();
  }
  return Error{fmt::format(
      "{}: has no camera; give a path with --path FILE.json, put a {} beside it, or add a camera to it",
      scene_name, kPathBesideScene)};
}

}  // namespace

Result<Scene> loadScene(const std::string& name) {
  Result<Scene> scene = isDemoUrl(name) ? makeDemoScene(name) : importScene(name);
  if (scene && scene->objects.empty()) {
    return Error{fmt::format("{}: there is nothing in it to draw; it has no triangles", name)};
  }
  return scene;
}

Result<Walk> loadWalk(const PathOptions& options, const std::string& scene_name, const Scene& scene) {
  Result<CameraPath> path =
      options.path.empty() ? defaultPath(scene_name, scene) : namedPath(options.path, scene);
  if (!path) {
    return path.error();
  }
  if (path->frames.empty()) {
    return Error{fmt::format("the camera path '{}' has no frames", path->name)};
  }
  Result<std::vector<std::uint32_t>> frames = chooseFrames(options.frames, path->frames.size());
  if (!frames) {
    return frames.error();
  }
  return Walk{std::move(*path), std::move(*frames)};
}

Result<SceneAndWalk> loadSceneAndWalk(const CommonOptions& common, const PathOptions& path) {
  if (const Status ok = checkOutput(common.json); !ok) {
    return ok.error();
  }
  Result<Scene> scene = loadScene(common.scene);
  if (!scene) {
    return scene.error();
  }
  Result<Walk> walk = loadWalk(path, common.scene, *scene);
  if (!walk) {
    return walk.error();
  }
  return SceneAndWalk{std::move(*scene), std::move(*walk)};
}

CullingData::CullingData(const Scene& scene, const ParallelFor& parallel_for, const Walk& walk)
    : parallel_for_(parallel_for), occluders_(findOccluders(scene.view(), {}, parallel_for)) {
  for (const std::uint32_t frame : walk.frames) {
    walk_.push_back(walk.view(frame, scene).eye);
  }
  for (const Object& object : scene.objects) {
    bounds_.push_back(object.bounds);
    triangles_.push_back(object.triangleCount());
  }
}

const Hierarchy& CullingData::hierarchy(HierarchyKind kind) {
  std::unique_ptr<Hierarchy>& hierarchy = hierarchies_[static_cast<std::size_t>(kind)];
  if (!hierarchy) {
    HierarchySettings settings;
    settings.kind = kind;
    hierarchy = std::make_unique<Hierarchy>(buildHierarchy(bounds_, triangles_, settings));
  }
  return *hierarchy;
}

namespace {

// build(progress): the database.
template <typename Database, typename Build>
std::unique_ptr<CullingData::Timed<Database>> buildTimed(const std::string& what, Build&& build) {
  ProgressBar progress(what);
  const auto start = std::chrono::steady_clock::now();
  Database database = build([&](double done) { progress.update(done); });
  const std::chrono::duration<double, std::micro> time = std::chrono::steady_clock::now() - start;
  return std::make_unique<CullingData::Timed<Database>>(
      CullingData::Timed<Database>{std::move(database), time.count()});
}

}  // namespace

// All settings of one run have the same databases.
const OccluderDatabase* CullingData::databaseFor(const Setting& setting, bool turned_away,
                                                 std::unique_ptr<TimedDatabase>& timed) {
  if (!timed) {
    const Hierarchy& cells = hierarchy(HierarchyKind::kKdTree);
    OccluderDatabaseSettings settings = setting.database;
    settings.turned_away = turned_away;
    timed = buildTimed<OccluderDatabase>(
        turned_away ? "occluder database for detail objects" : "occluder database",
        [&](const Progress& progress) {
          return OccluderDatabase::build(cells, occluders_, settings, parallel_for_, progress);
        });
  }
  return &timed->database;
}

const ViewpointDatabase* CullingData::viewpointsFor(const Setting& setting) {
  std::unique_ptr<TimedViewpoints>& timed =
      from_viewpoints_[static_cast<std::size_t>(setting.viewpoints.criterion)];
  if (!timed) {
    const Hierarchy& occludees = hierarchy(HierarchyKind::kBvh);
    timed = buildTimed<ViewpointDatabase>(
        "occluders by " + nameOf(kOccluderChoices, setting.culler.occluders), [&](const Progress& progress) {
          return ViewpointDatabase::build(occludees, occluders_, walk_, setting.viewpoints, parallel_for_,
                                          progress);
        });
  }
  return &timed->database;
}

Culler CullingData::makeCuller(const Setting& setting) {
  OccluderDatabases databases;
  if (setting.usesDatabase()) {
    databases.from_eye = databaseFor(setting, false, from_eye_);
  }
  if (setting.testsDetailObjects()) {
    databases.from_objects = databaseFor(setting, true, from_objects_);
  }
  if (setting.usesViewpoints()) {
    databases.from_viewpoints = viewpointsFor(setting);
  }
  Culler culler(hierarchy(setting.hierarchy), bounds_, occluders_, setting.culler, databases);
  culler.setParallelFor(parallel_for_);
  return culler;
}

std::uint64_t CullingData::trianglesOf(std::span<const ObjectId> objects) const {
  std::uint64_t sum = 0;
  for (const ObjectId object : objects) {
    sum += triangles_[object.value];
  }
  return sum;
}

Json sceneJson(const Scene& scene) {
  return {{"objects", scene.objects.size()}, {"triangles", scene.triangleCount()}};
}

void addDatabases(Json& json, const CullingData& data, bool times) {
  const auto add = [&](const char* key, const CullingData::TimedDatabase* timed) {
    if (timed != nullptr) {
      json[key] = {{"cells", timed->database.cellCount()},
                   {"directions", timed->database.directionCount()},
                   {"bytes", timed->database.bytes()},
                   {"build_us", times ? timed->build_us : 0.0}};
    }
  };
  add("database", data.database());
  add("detail_database", data.detailDatabase());
  for (const OccluderChoice choice :
       {OccluderChoice::kMinimumSets, OccluderChoice::kProjectedSize, OccluderChoice::kFirstHit}) {
    if (const CullingData::TimedViewpoints* timed = data.viewpoints(criterionOf(choice))) {
      json["viewpoints"][nameOf(kOccluderChoices, choice)] = {
          {"points", timed->database.pointCount()},
          {"directions", timed->database.directionCount()},
          {"spacing", timed->database.spacing()},
          {"bytes", timed->database.bytes()},
          {"build_us", times ? timed->build_us : 0.0}};
    }
  }
}

}  // namespace sightline::tool
