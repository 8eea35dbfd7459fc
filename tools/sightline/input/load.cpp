#include "tools/sightline/input/load.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "scenes/procedural.h"
#include "sightline/io/import.h"
#include "sightline/occluders/closed_scene.h"
#include "sightline/pvs/format/scene_id.h"
#include "src/base/stopwatch.h"
#include "tools/sightline/command_line/json_output.h"
#include "tools/sightline/command_line/names.h"
#include "tools/sightline/command_line/note.h"
#include "tools/sightline/command_line/progress_bar.h"
#include "tools/sightline/input/camera_path_file.h"
#include "tools/sightline/input/cell_path.h"
#include "tools/sightline/input/doors.h"

namespace sightline::tool {
namespace {

constexpr const char* kCameraPathBesideScene = "walk.path.json";

std::string cameraPathNames(const Scene& scene) {
  std::string names;
  for (const CameraPath& path : scene.paths) {
    names += (names.empty() ? "" : ", ") + path.name;
  }
  return names;
}

Result<CameraPath> namedCameraPath(const std::string& name, const Scene& scene) {
  for (const CameraPath& path : scene.paths) {
    if (path.name == name) {
      return path;
    }
  }
  std::error_code ignored;
  if (std::filesystem::exists(name, ignored)) {
    return readCameraPathFile(name);
  }
  const std::string walks = cameraPathNames(scene);
  return Error{fmt::format(
      "--path {}: there is no such file, and {}{}", name,
      walks.empty() ? "the scene has no walks" : "the scene's walks are: " + walks,
      name == kCellsPath ? "; the cells of a baked file are walked when it is given with --baked" : "")};
}

// The camera path's file beside the scene's file; empty if there is none.
std::string cameraPathBeside(const std::string& scene_name) {
  const std::filesystem::path beside =
      std::filesystem::path(scene_name).parent_path() / kCameraPathBesideScene;
  std::error_code ignored;
  return !isDemoUrl(scene_name) && std::filesystem::is_regular_file(beside, ignored) ? beside.string() : "";
}

Result<CameraPath> defaultCameraPath(const std::string& scene_name, const Scene& scene) {
  if (const std::string beside = cameraPathBeside(scene_name); !beside.empty()) {
    Result<CameraPath> path = readCameraPathFile(beside);
    if (path) {
      printNote("using the camera path {}", beside);
    }
    return path;
  }
  if (!scene.paths.empty()) {
    return scene.paths.front();
  }
  return Error{fmt::format(
      "{}: has no camera; give a path with --path FILE.json, put a {} beside it, or add a camera to it",
      scene_name, kCameraPathBesideScene)};
}

}  // namespace

Result<Scene> loadScene(const std::string& name) {
  Result<Scene> scene = isDemoUrl(name) ? makeDemoScene(name) : importScene(name);
  if (scene && scene->objects.empty()) {
    return Error{fmt::format("{}: there is nothing in it to draw; it has no triangles", name)};
  }
  if (scene) {
    for (const std::string& note : scene->notes) {
      printNote("{}: {}", name, note);
    }
  }
  return scene;
}

CrackClosing closeCracksOf(Scene& scene, double width, const ParallelFor& parallel_for) {
  CrackClosing closing;
  if (width > 0.0) {
    ClosedScene closed = closeCracks(scene.view(), width, parallel_for);
    closing = {width, closed.slack, closed.margin(), std::move(scene.indices), std::move(scene.objects)};
    scene.indices = std::move(closed.indices);
    scene.objects = std::move(closed.objects);
    printNote(
        "cracks narrower than {} m count as closed: {} vertices are joined, edges are led "
        "through {}, nothing by more than {:.3g} m",
        width, closed.merged, closed.bent, closed.slack);
  }
  return closing;
}

Result<std::optional<SightFile>> loadBaked(const std::string& file, const Scene& scene) {
  if (file.empty()) {
    return std::optional<SightFile>();
  }
  Result<SightFile> baked = SightFile::open(file);
  if (!baked) {
    return baked.error();
  }
  if (const Status same = baked->matches(sceneId(scene.view())); !same) {
    const CrackNote closed = cracksOf(baked->record());
    return Error{same.error().message + (closed.width > 0.0
                                             ? ", or give the" + crackText(closed) + " that it was baked with"
                                             : std::string())};
  }
  if (const Status whole = baked->verifyAll(); !whole) {
    return whole.error();
  }
  return std::optional<SightFile>(std::move(*baked));
}

Result<std::vector<ObjectId>> closeDoors(const std::string& closed, const std::string& name,
                                         const std::optional<SightFile>& baked, Scene& scene) {
  if (!baked) {
    return closed.empty()
               ? Result<std::vector<ObjectId>>(std::vector<ObjectId>())
               : Error{fmt::format("--closed {}: it names doors of a baked file; give the file with --baked",
                                   closed)};
  }
  Result<std::vector<ObjectId>> doors = closedDoors(closed, *baked, name);
  if (doors) {
    openOtherDoors(baked->doors(), *doors, scene);
  }
  return doors;
}

Result<Walk> loadWalk(const PathOptions& options, const std::string& scene_name, const Scene& scene,
                      const std::optional<SightFile>& baked) {
  const bool cells = baked && options.path == kCellsPath;
  CellPath at_cells = cells ? cellPath(*baked, scene) : CellPath{};
  Result<CameraPath> path = cells                  ? Result<CameraPath>(std::move(at_cells.path))
                            : options.path.empty() ? defaultCameraPath(scene_name, scene)
                                                   : namedCameraPath(options.path, scene);
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
  return Walk{std::move(*path), std::move(*frames), std::move(at_cells.eyes)};
}

std::vector<NamedFile> walkInputs(const std::string& scene_name, const PathOptions& path,
                                  const std::string& baked) {
  return {{"--path", path.path.empty() ? cameraPathBeside(scene_name) : path.path}, {"--baked", baked}};
}

Result<SceneAndWalk> loadSceneAndWalk(const std::string& scene_name, const PathOptions& path,
                                      const MethodOptions& method) {
  Result<Scene> scene = loadScene(scene_name);
  if (!scene) {
    return scene.error();
  }
  if (method.clusters > 0 && !method.baked.empty()) {
    return Error{"--clusters, --baked: the sets of a baked file are of whole objects; leave one of them out"};
  }
  CrackClosing closing = closeCracksOf(*scene, method.crack_width);
  Clustering clustering = divideIntoClusters(*scene, method.clusters, closing.margin);
  if (clustering.on()) {
    closing.given_indices.clear();  // no cluster has given triangles of its own
    closing.given_objects.clear();
  }
  Result<std::optional<SightFile>> file = loadBaked(method.baked, *scene);
  if (!file) {
    return file.error();
  }
  Result<std::vector<ObjectId>> closed = closeDoors(method.closed, method.baked, *file, *scene);
  if (!closed) {
    return closed.error();
  }
  Result<Walk> walk = loadWalk(path, scene_name, *scene, *file);
  if (!walk) {
    return walk.error();
  }
  Result<PreparedFile> prepared = PreparedFile::open(method.prepared, scene->view(), closing.width);
  if (!prepared) {
    return prepared.error();
  }
  return SceneAndWalk{std::move(*scene),  std::move(*walk),      std::move(*file),    std::move(*closed),
                      std::move(closing), std::move(clustering), std::move(*prepared)};
}

Result<SceneAndWalk> checkAndLoad(const CommonOptions& common, const PathOptions& path,
                                  const MethodOptions& method) {
  if (const Status ok = checkFiles({.scenes = {common.scene},
                                    .inputs = walkInputs(common.scene, path, method.baked),
                                    .outputs = {{"--json", common.json}, {"--prepared", method.prepared}}});
      !ok) {
    return ok.error();
  }
  return loadSceneAndWalk(common.scene, path, method);
}

CullingData::CullingData(const Scene& scene, const ParallelFor& parallel_for, const Walk& walk,
                         std::optional<SightFile> baked)
    : parallel_for_(parallel_for), scene_(scene.view()), baked_(std::move(baked)) {
  for (const std::uint32_t frame : walk.frames) {
    walk_.push_back(walk.view(frame, scene).eye);
  }
  for (const Object& object : scene.objects) {
    bounds_.push_back(object.bounds);
  }
  countTriangles(scene.view());
}

void CullingData::countTriangles(const SceneView& scene) {
  triangles_.clear();
  for (const Object& object : scene.objects) {
    triangles_.push_back(object.triangleCount());
  }
}

template <typename Made, typename Make>
const Made& CullingData::makeOnce(std::unique_ptr<Made>& made, const std::string& name, Make&& make) const {
  if (!made) {
    base::Stopwatch watch;
    made = std::make_unique<Made>(make());
    stages_.push_back({name, watch.lap()});
  }
  return *made;
}

std::uint32_t CullingData::objectCount() const {
  return static_cast<std::uint32_t>(bounds_.size());
}

const Hierarchy& CullingData::hierarchy(HierarchyKind kind) {
  const std::string name = nameOf(kHierarchies, kind);
  return makeOnce(hierarchies_[static_cast<std::size_t>(kind)], "hierarchy " + name, [&] {
    return prepared_.get(
        name,
        [&] {
          HierarchySettings settings;
          settings.kind = kind;
          return buildHierarchy(bounds_, triangles_, settings);
        },
        [&](const SharedBytes& bytes) -> Result<Hierarchy> {
          Result<Hierarchy> found = hierarchyFrom(bytes.bytes, objectCount());
          if (found && found->kind != kind) {
            return Error{"its hierarchies are of other kinds"};
          }
          return found;
        },
        hierarchyBytes);
  });
}

const OccluderSet& CullingData::occluders() const {
  return makeOnce(occluders_, "occluders", [&] {
    return prepared_.get(
        "occluders", [&] { return findOccluders(scene_, {}, parallel_for_); },
        [&](const SharedBytes& bytes) { return occludersFrom(bytes, objectCount()); }, occluderBytes);
  });
}

const SurfaceSet& CullingData::surfaces() {
  return makeOnce(surfaces_, "surfaces", [&] {
    return prepared_.get(
        "surfaces", [&] { return findSurfaces(scene_, {}, parallel_for_); },
        [&](const SharedBytes& bytes) { return surfacesFrom(bytes, objectCount()); }, surfaceBytes);
  });
}

const ObjectBoxes& CullingData::objectBoxes(std::uint32_t most) {
  return makeOnce(object_boxes_[most], "object boxes", [&] {
    return prepared_.get(
        fmt::format("boxes {}", most),
        [&] { return findObjectBoxes(scene_, {.max_boxes = most, .margin = box_margin_}, parallel_for_); },
        [&](const SharedBytes& bytes) { return objectBoxesFrom(bytes.bytes, objectCount()); },
        objectBoxesBytes);
  });
}

namespace {

// Builds a database by build(progress) and measures the time.
template <typename Database, typename Build>
std::unique_ptr<CullingData::Timed<Database>> buildTimed(const std::string& what, Build&& build) {
  ProgressBar progress(what);
  base::Stopwatch watch;
  Database database = build([&](double done) { progress.update(done); });
  const double time_us = watch.lap();
  return std::make_unique<CullingData::Timed<Database>>(
      CullingData::Timed<Database>{std::move(database), time_us});
}

}  // namespace

template <typename Database>
std::unique_ptr<CullingData::Timed<Database>> CullingData::bakedDatabase(const std::string& name) {
  if (!baked_) {
    return nullptr;
  }
  const std::vector<std::string> names = baked_->databaseNames();
  if (std::find(names.begin(), names.end(), name) == names.end()) {
    return nullptr;
  }
  base::Stopwatch watch;
  const Result<DatabaseBlob> blob = baked_->readDatabase(name);
  std::string unusable;
  if (!blob) {
    unusable = blob.error().message;
  } else if (blob->occluders != occluderSetHash(occluders())) {
    unusable = "it was made for other occluders";
  } else {
    const auto count = static_cast<std::uint32_t>(occluders().occluders.size());
    Result<Database> database = Database::load(blob->bytes, count);
    if (database) {
      return std::make_unique<Timed<Database>>(Timed<Database>{std::move(*database), watch.lap()});
    }
    unusable = database.error().message;
  }
  printNote("the occluder database '{}' of the baked file is not used ({}); building one", name, unusable);
  return nullptr;
}

// The database is built once: all settings of one run have the same options for it.
const OccluderDatabase* CullingData::databaseFor(const Setting& setting, bool turned_away,
                                                 std::unique_ptr<TimedDatabase>& timed) {
  if (!timed) {
    timed = bakedDatabase<OccluderDatabase>(turned_away ? "detail" : "area-angle");
  }
  if (!timed) {
    const Hierarchy& cells = hierarchy(HierarchyKind::kKdTree);
    OccluderDatabaseSettings settings = setting.database;
    settings.turned_away = turned_away;
    timed = buildTimed<OccluderDatabase>(
        turned_away ? "occluder database for detail objects" : "occluder database",
        [&](const Progress& progress) {
          return OccluderDatabase::build(cells, occluders(), settings, parallel_for_, progress);
        });
  }
  return &timed->database;
}

const ViewpointDatabase* CullingData::viewpointsFor(const Setting& setting) {
  std::unique_ptr<TimedViewpoints>& timed =
      from_viewpoints_[static_cast<std::size_t>(setting.viewpoints.criterion)];
  if (!timed) {
    timed = bakedDatabase<ViewpointDatabase>(nameOf(kOccluderChoices, setting.occluders));
  }
  if (!timed) {
    const Hierarchy& occludees = hierarchy(HierarchyKind::kBvh);
    timed = buildTimed<ViewpointDatabase>(
        "occluders by " + nameOf(kOccluderChoices, setting.occluders), [&](const Progress& progress) {
          return ViewpointDatabase::build(occludees, occluders(), walk_, setting.viewpoints, parallel_for_,
                                          progress);
        });
  }
  return &timed->database;
}

void CullingData::prepare(const Setting& setting) {
  hierarchy(setting.hierarchy);
  if (setting.usesDatabase()) {
    databaseFor(setting, false, from_eye_);
  }
  if (setting.testsDetailObjects()) {
    databaseFor(setting, true, from_objects_);
  }
  if (setting.usesViewpoints()) {
    viewpointsFor(setting);
  }
}

Culler CullingData::makeCuller(const Setting& setting) {
  CullingScene scene{.hierarchy = &hierarchy(setting.hierarchy), .object_bounds = bounds_};
  if (setting.choosesOccluders() || setting.testsDetailObjects()) {
    scene.occluders = &occluders();
  }
  if (setting.surfaces() != SurfaceUse::kNone) {
    scene.surfaces = &surfaces();
  }
  if (const std::uint32_t most = setting.objectBoxes(); most > 1) {
    scene.object_boxes = &objectBoxes(most);
  }
  if (setting.usesDatabase()) {
    scene.occluder_lists = databaseFor(setting, false, from_eye_);
  }
  if (setting.testsDetailObjects()) {
    scene.near_objects = databaseFor(setting, true, from_objects_);
  }
  if (setting.usesViewpoints()) {
    scene.occluder_lists = viewpointsFor(setting);
  }
  if (baked_ && setting.usesVisibleSets()) {
    queries_.push_back(std::make_unique<SetQuery>(*baked_));
    queries_.back()->setClosedDoors(closed_);
    scene.sets = queries_.back().get();
  }
  keepPrepared();
  Culler culler(scene, makeMethod(setting), setting.culler);
  culler.setParallelFor(parallel_for_);
  return culler;
}

void CullingData::noteUnknownSets() const {
  SetQueryStats sum;
  for (const std::unique_ptr<SetQuery>& query : queries_) {
    const SetQueryStats& stats = query->stats();
    sum.finds += stats.finds;
    sum.outside += stats.outside;
    sum.beyond_near += stats.beyond_near;
    sum.broken += stats.broken;
  }
  if (sum.outside + sum.beyond_near + sum.broken > 0) {
    printNote(
        "{} of {} look-ups in the baked file gave everything: {} outside its cells, {} with a "
        "near plane that clips beyond its {} m, {} broken",
        sum.outside + sum.beyond_near + sum.broken, sum.finds, sum.outside, sum.beyond_near,
        baked_->record().near_distance, sum.broken);
  }
}

std::uint64_t CullingData::trianglesOf(std::span<const ObjectId> objects) const {
  std::uint64_t sum = 0;
  for (const ObjectId object : objects) {
    sum += triangles_[object.value];
  }
  return sum;
}

Json sceneJson(const Scene& scene, const CrackClosing& closing) {
  Json json = {{"objects", scene.objects.size()}, {"triangles", scene.triangleCount()}};
  addCracks(json, closing.note());
  return json;
}

Json sceneJson(const SceneAndWalk& input) {
  Json json = sceneJson(input.scene, input.closing);
  if (input.clustering.on()) {
    json["clusters"] = json["objects"];
    json["objects"] = input.clustering.objects;
    json["cluster_triangles"] = input.clustering.max_triangles;
  }
  return json;
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
