#pragma once

// The results of the experiments of Bittner, Havran and Slavik, and the tables and figures made of them.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "sightline/comparison/tree_shape.h"
#include "tools/sightline/reproduce/reproduction.h"
#include "tools/sightline/walk/walk_record.h"

namespace sightline::tool::bittner {

// A line of the paper's table 2: how often what was measured.
struct Published {
  const char* scene;
  const char* method;
  std::uint32_t occluders;  // 0 for F
  double polygons, overhead_ms, time_ms;
};
const std::vector<Published>& publishedTable();
inline constexpr std::array<const char*, 3> kPublishedScenes{"soda-5", "big-7", "soda"};

// A setting that is measured, with its name in the tables.
struct Case {
  std::string method;
  std::uint32_t occluders = 0;
  Setting setting{};
};
// F first, then the variants with each number of occluders, then kOwn.
std::vector<Case> allCases();
inline constexpr const char* kOwn = "FME, defaults";  // the library's own parameters in place of the paper's

// The case of figures 9 and 10 with one parameter of the paper replaced by the library's. The first is the
// paper's, the last has all of the library's.
std::vector<Case> parameterCases();

// The case of figures 9 and 10.
inline constexpr const char* kPlotted = "FME";
inline constexpr std::uint32_t kPlottedOccluders = 32;

// Means of a frame.
struct TreeWork {
  double nodes = 0.0;        // of the tree
  double plane_tests = 0.0;  // of all queries together
};

// Everything that is measured on one scene.
struct Measured {
  const std::string& name;
  const SceneAndWalk& input;
  CullingData data;
  std::vector<Case> cases{};
  WalkRecord record{};                    // one run for each case
  std::vector<WalkRun> parameter_runs{};  // one for each of parameterCases(), culled but not drawn
  std::vector<TreeWork> trees{};          // one for each case

  bool drawn() const { return !record.device.empty(); }
  // Null if it was not measured.
  const WalkRun* runOf(const std::string& method, std::uint32_t occluders) const;
};

std::vector<Experiment> tablesOf(const std::vector<Measured>& scenes);
std::vector<Finding> findingsOf(const std::vector<Measured>& scenes);

struct Figures {
  std::vector<ReportPicture> pictures{};
  std::vector<ReportFile> files{};  // of the pictures
};
// Figures 1, 2, 7 and 8: trees of a few polygons.
Figures treeFigures();
// Figures 5 and 6: the traversal of a scene's kd-tree.
Figures traversalFigures(Measured& measured);

// What figure 8 shows: a box that two occluders hide together.
struct Figure8 {
  View view{};
  OccluderSet occluders{};
  Box box{};
  TreeShape tree{};
  Visibility by_the_paper{}, here{};  // the box's state by the paper's test, and by the library's
};
Figure8 figure8();

}  // namespace sightline::tool::bittner
