#pragma once

// From what the user names to what commands work on.

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sightline/hierarchy/hierarchy.h"
#include "sightline/occluders/occluder_set.h"
#include "sightline/pvs/query/set_query.h"
#include "sightline/pvs/query/sight_file.h"
#include "sightline/scene/scene.h"
#include "tools/sightline/command_line/options.h"
#include "tools/sightline/command_line/output_files.h"
#include "tools/sightline/methods/method_options.h"

namespace sightline::tool {

// A file or a demo:NAME?...
Result<Scene> loadScene(const std::string& name);

// A .sight file, which must have been baked from this scene. No name: none.
Result<std::optional<SightFile>> loadBaked(const std::string& file, const Scene& scene);

struct Walk {
  CameraPath path;
  std::vector<std::uint32_t> frames{};  // chosen ones, ascending
  std::vector<Vec3d> eyes{};            // by frame, scene space, where the path's are not exact; else none

  View view(std::uint32_t frame, const Scene& scene) const {
    View view = path.view(frame, scene.origin);
    view.eye = eyes.empty() ? view.eye : eyes[frame];
    return view;
  }
};
// baked: for kCellsPath. Says on stderr when it took a file that the user did not name.
Result<Walk> loadWalk(const PathOptions& options, const std::string& scene_name, const Scene& scene,
                      const std::optional<SightFile>& baked = {});

// The files of these options that a command along a walk reads, but for the scene: those of the options that
// name none are passed over by checkFiles.
std::vector<NamedFile> walkInputs(const std::string& scene_name, const PathOptions& path,
                                  const std::string& baked = "");

// What a command along a walk begins with.
struct SceneAndWalk {
  Scene scene;
  Walk walk;
  std::optional<SightFile> baked{};
};
// baked: a .sight file, or empty.
Result<SceneAndWalk> loadSceneAndWalk(const std::string& scene_name, const PathOptions& path,
                                      const std::string& baked = "");
// loadSceneAndWalk for a command that writes no file but --json: checks first that this is none of the
// inputs.
Result<SceneAndWalk> checkAndLoad(const CommonOptions& common, const PathOptions& path,
                                  const std::string& baked);

// What cullers of one scene share.
class CullingData {
 public:
  // walk: viewpoint databases are made for it. baked: sets of settings that use them, and databases.
  CullingData(const Scene& scene, const ParallelFor& parallel_for, const Walk& walk = {},
              std::optional<SightFile> baked = {});

  // Says on stderr where a database of the baked file is of no use.
  Culler makeCuller(const Setting& setting);
  // Says on stderr how many look-ups in the baked file found nothing better than everything, and why.
  void noteUnknownSets() const;
  const Hierarchy& hierarchy(HierarchyKind kind);  // built when asked for first
  // The occluder databases of the first setting that uses them; null until a culler needed them.
  template <typename Database>
  struct Timed {
    Database database;
    double build_us = 0.0;  // or to read it from the baked file
  };
  using TimedDatabase = Timed<OccluderDatabase>;
  using TimedViewpoints = Timed<ViewpointDatabase>;
  const TimedDatabase* database() const { return from_eye_.get(); }
  const TimedDatabase* detailDatabase() const { return from_objects_.get(); }
  const TimedViewpoints* viewpoints(OccluderCriterion criterion) const {
    return from_viewpoints_[static_cast<std::size_t>(criterion)].get();
  }
  const OccluderSet& occluders() const { return occluders_; }
  std::span<const Box> bounds() const { return bounds_; }
  std::span<const std::uint32_t> triangles() const { return triangles_; }  // of each object
  std::uint64_t trianglesOf(std::span<const ObjectId> objects) const;

 private:
  const OccluderDatabase* databaseFor(const Setting& setting, bool turned_away,
                                      std::unique_ptr<TimedDatabase>& database);
  const ViewpointDatabase* viewpointsFor(const Setting& setting);
  // That of the baked file; null where it has none for these occluders.
  template <typename Database>
  std::unique_ptr<Timed<Database>> bakedDatabase(const std::string& name) const;

  ParallelFor parallel_for_;
  std::vector<Vec3d> walk_;  // its viewpoints, scene space
  std::vector<Box> bounds_;
  std::vector<std::uint32_t> triangles_;
  OccluderSet occluders_;
  std::array<std::unique_ptr<Hierarchy>, 2> hierarchies_;
  std::unique_ptr<TimedDatabase> from_eye_, from_objects_;
  std::array<std::unique_ptr<TimedViewpoints>, 3> from_viewpoints_;  // by OccluderCriterion
  std::optional<SightFile> baked_;
  std::vector<std::unique_ptr<SetQuery>> queries_;  // one a culler that has sets
};

Json sceneJson(const Scene& scene);  // {"objects":n,"triangles":t}
// Adds "database" and "detail_database", {"cells":n,"directions":n,"bytes":n,"build_us":t} each, and
// "viewpoints", {"minimum-sets":{"points":n,"directions":n,"spacing":m,"bytes":n,"build_us":t},...}, as far
// as they were built. times: else 0 for them.
void addDatabases(Json& json, const CullingData& data, bool times = true);

}  // namespace sightline::tool
