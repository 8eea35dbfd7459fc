#pragma once

// Loads scenes, camera paths and baked files by the names that the user gives.

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sightline/hierarchy/hierarchy.h"
#include "sightline/occluders/occluder_set.h"
#include "sightline/pvs/query/set_query.h"
#include "sightline/pvs/query/sight_file.h"
#include "sightline/scene/object_boxes.h"
#include "sightline/scene/scene.h"
#include "tools/sightline/command_line/options.h"
#include "tools/sightline/command_line/output_files.h"
#include "tools/sightline/input/clustering.h"
#include "tools/sightline/input/crack_note.h"
#include "tools/sightline/input/prepared_file.h"
#include "tools/sightline/methods/method_options.h"

namespace sightline::tool {

// Loads a scene from a file, or makes a demo:NAME?... scene.
Result<Scene> loadScene(const std::string& name);

// What closing the cracks of a scene has done to it; nothing, if the width is 0.
struct CrackClosing {
  double width = 0.0, slack = 0.0, margin = 0.0;  // metres: see ClosedScene
  std::vector<std::uint32_t> given_indices{};     // those of the scene before; empty: the same
  std::vector<Object> given_objects{};

  CrackNote note() const { return {width, slack}; }
};
// Closes the scene's cracks that are narrower than the width, and says so on stderr. The scene is then that
// of the command: what is found, culled, baked and exactly visible is so in it; only pictures are drawn of
// what was given.
CrackClosing closeCracksOf(Scene& scene, double width, const ParallelFor& parallel_for = serialFor);

// Opens a .sight file. Error if it was baked from another scene. None if `file` is empty.
Result<std::optional<SightFile>> loadBaked(const std::string& file, const Scene& scene);

// The doors of the baked file that --closed names, ascending. In the scene, the others hide nothing from here
// on. Error if something is named that is no door of the file, or if there is no file. name: of the file.
Result<std::vector<ObjectId>> closeDoors(const std::string& closed, const std::string& name,
                                         const std::optional<SightFile>& baked, Scene& scene);

struct Walk {
  CameraPath path;
  std::vector<std::uint32_t> frames{};  // the chosen frames, ascending
  std::vector<Vec3d> eyes{};  // exact eyes in scene space, one for each frame; empty: those of `path`

  View view(std::uint32_t frame, const Scene& scene) const {
    View view = path.view(frame, scene.origin);
    view.eye = eyes.empty() ? view.eye : eyes[frame];
    return view;
  }
};
// Loads a camera path and chooses its frames. baked is needed for kCellsPath. Says on stderr if it used a
// file that the user did not name.
Result<Walk> loadWalk(const PathOptions& options, const std::string& scene_name, const Scene& scene,
                      const std::optional<SightFile>& baked = {});

// The files, besides the scene, that a command along a walk reads. checkFiles ignores entries that name no
// file.
std::vector<NamedFile> walkInputs(const std::string& scene_name, const PathOptions& path,
                                  const std::string& baked = "");

// The input of a command along a walk.
struct SceneAndWalk {
  Scene scene;
  Walk walk;
  std::optional<SightFile> baked{};
  std::vector<ObjectId>
      closed{};  // doors of the baked file, ascending; in the scene, the others hide nothing
  CrackClosing closing{};
  Clustering clustering{};
  PreparedFile prepared{};

  // The triangles as the user gave them, for pictures.
  SceneView given() const {
    return closing.given_objects.empty()
               ? scene.view()
               : SceneView{scene.positions, closing.given_indices, closing.given_objects, scene.materials};
  }
};
// Loads all of it. Of `method`, its baked and its prepared file, the width of cracks, and clusters. Error if
// there are clusters and a baked file, whose sets are of objects.
Result<SceneAndWalk> loadSceneAndWalk(const std::string& scene_name, const PathOptions& path,
                                      const MethodOptions& method = {});
// loadSceneAndWalk for a command that writes no file but --json: checks first that this is none of the
// inputs.
Result<SceneAndWalk> checkAndLoad(const CommonOptions& common, const PathOptions& path,
                                  const MethodOptions& method);

// What all cullers of one scene share.
class CullingData {
 public:
  // Viewpoint databases are built for the viewpoints of `walk`. `baked` provides visible sets for the
  // settings that use them, and occluder databases.
  CullingData(const Scene& scene, const ParallelFor& parallel_for, const Walk& walk = {},
              std::optional<SightFile> baked = {});
  // The same for what a user asked for.
  CullingData(const SceneAndWalk& input, const ParallelFor& parallel_for)
      : CullingData(input.scene, parallel_for, input.walk, input.baked) {
    closed_ = input.closed;
    box_margin_ = input.closing.margin;
    prepared_ = input.prepared;
    countTriangles(input.given());
  }

  // Builds what cullers of the setting share with others, unless it is there: hierarchy and databases. Says
  // on stderr if a database of the baked file cannot be used.
  void prepare(const Setting& setting);
  // Prepares what is missing and makes the culler.
  Culler makeCuller(const Setting& setting);
  // Says on stderr how many look-ups in the baked file returned all objects, and why.
  void noteUnknownSets() const;
  // These are made on first use.
  const Hierarchy& hierarchy(HierarchyKind kind);
  const OccluderSet& occluders() const;
  const SurfaceSet& surfaces();
  const ObjectBoxes& objectBoxes(std::uint32_t most);  // at most so many an object
  // Keeps them in the prepared file, if there is one and they are not in it. makeCuller() does so too.
  void keepPrepared() { prepared_.keep(); }
  // What was made of these, in order, and how long it took.
  struct Stage {
    std::string name;
    double us = 0.0;
  };
  std::span<const Stage> stages() const { return stages_; }
  // The occluder databases of the first setting that uses them; null until a culler needs them.
  template <typename Database>
  struct Timed {
    Database database;
    double build_us = 0.0;  // time to build it or to read it from the baked file
  };
  using TimedDatabase = Timed<OccluderDatabase>;
  using TimedViewpoints = Timed<ViewpointDatabase>;
  const TimedDatabase* database() const { return from_eye_.get(); }
  const TimedDatabase* detailDatabase() const { return from_objects_.get(); }
  const TimedViewpoints* viewpoints(OccluderCriterion criterion) const {
    return from_viewpoints_[static_cast<std::size_t>(criterion)].get();
  }
  std::span<const Box> bounds() const { return bounds_; }
  std::span<const std::uint32_t> triangles() const { return triangles_; }  // one count for each object
  std::uint64_t trianglesOf(std::span<const ObjectId> objects) const;

 private:
  std::uint32_t objectCount() const;
  void countTriangles(const SceneView& scene);
  const OccluderDatabase* databaseFor(const Setting& setting, bool turned_away,
                                      std::unique_ptr<TimedDatabase>& database);
  const ViewpointDatabase* viewpointsFor(const Setting& setting);
  // The baked file's database; null if it has none for these occluders.
  template <typename Database>
  std::unique_ptr<Timed<Database>> bakedDatabase(const std::string& name);
  // Calls make() if there is nothing in `made`, and notes the time.
  template <typename Made, typename Make>
  const Made& makeOnce(std::unique_ptr<Made>& made, const std::string& name, Make&& make) const;

  ParallelFor parallel_for_;
  double box_margin_ = 0.0;  // ObjectBoxesSettings::margin
  mutable PreparedFile prepared_;
  std::vector<Vec3d> walk_;  // the walk's viewpoints in scene space
  std::vector<Box> bounds_;
  std::vector<std::uint32_t> triangles_;
  SceneView scene_;
  mutable std::unique_ptr<OccluderSet> occluders_;
  std::unique_ptr<SurfaceSet> surfaces_;
  std::array<std::unique_ptr<ObjectBoxes>, kMaxObjectBoxes + 1> object_boxes_;  // by the most of an object
  std::array<std::unique_ptr<Hierarchy>, 2> hierarchies_;
  mutable std::vector<Stage> stages_;
  std::unique_ptr<TimedDatabase> from_eye_, from_objects_;
  std::array<std::unique_ptr<TimedViewpoints>, 3> from_viewpoints_;  // by OccluderCriterion
  std::optional<SightFile> baked_;
  std::vector<ObjectId> closed_;                    // SceneAndWalk::closed
  std::vector<std::unique_ptr<SetQuery>> queries_;  // one for each culler that uses visible sets
};

// {"objects":n,"triangles":t}, and what addCracks() adds
Json sceneJson(const Scene& scene, const CrackClosing& closing = {});
// The same, and with clusters their number: "objects" are then those before.
Json sceneJson(const SceneAndWalk& input);
// Adds those that were built of "database" and "detail_database", each
// {"cells":n,"directions":n,"bytes":n,"build_us":t}, and "viewpoints",
// {"minimum-sets":{"points":n,"directions":n,"spacing":m,"bytes":n,"build_us":t},...}. Without `times` all
// times are 0.
void addDatabases(Json& json, const CullingData& data, bool times = true);

}  // namespace sightline::tool
