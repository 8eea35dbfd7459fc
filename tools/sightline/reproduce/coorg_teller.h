#pragma once

// The results of the experiments of Coorg and Teller, and the tables, plots and sentences made of them.

#include <string>
#include <vector>

#include "tools/sightline/reproduce/observer_speeds.h"
#include "tools/sightline/reproduce/reproduction.h"
#include "tools/sightline/walk/walk_record.h"

namespace sightline::tool::coorg_teller {

inline constexpr std::size_t kBaseline = 0, kKeptPlanes = 1;  // indices in kCullings

// The methods that are compared, with their names in the tables. The paper's own method follows the baseline.
struct Culling {
  const char* name;
  const char* method = "supporting-planes";
  OccluderChoice occluders = OccluderChoice::kDatabase;
  PlaneForm form = PlaneForm::kThroughEye;
  bool detail_objects = false;
};
inline constexpr Culling kCullings[] = {
    {.name = "frustum", .method = "frustum"},
    {.name = "database, kept planes", .form = PlaneForm::kThroughBox},
    {.name = "database, planes through the eye"},
    {.name = "... and detail objects", .detail_objects = true},
    {.name = "area-angle, planes through the eye", .occluders = OccluderChoice::kAreaAngle},
};

// All that is measured on one scene.
struct SceneTimes {
  const std::string& name;
  const SceneAndWalk& input;
  CullingData data;
  WalkRecord record{};
  double nodes_in_frustum = 0.0;  // mean over all frames
  std::vector<SpeedResult> speeds{};
  std::vector<ReportPicture> plate{};  // snapshots of the walk; none if nothing was drawn

  bool drawn() const { return !record.device.empty(); }
};

std::vector<Experiment> tablesOf(const std::vector<SceneTimes>& scenes);
std::vector<Finding> findingsOf(const std::vector<SceneTimes>& scenes);
// The report of one scene. The paper's claims are taken from `experiments`.
Report reportOf(const SceneTimes& measured, const std::vector<Experiment>& experiments,
                const ReproduceOptions& options);

}  // namespace sightline::tool::coorg_teller
