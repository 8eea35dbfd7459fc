#pragma once

// Writes a walk's results as JSON, as a table for the terminal, and as the report.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "tools/sightline/report/report.h"
#include "tools/sightline/walk/walk_record.h"

namespace sightline::tool {

struct WalkInput {
  const std::string& scene_name;
  const Scene& scene;
  const Walk& walk;
  const CullingData& data;
  const CrackClosing& closing;
};

// The run's row in the table; numbers are means over all frames.
ReportRow rowOf(const WalkRun& run, const WalkRecord& record);
// A sentence with the share of the hierarchy that is tested and the setting's statistics (statisticsOf).
std::string statisticsText(const WalkRun& run);
// A plot, and its file in the report's folder, one of kPlotFiles.
struct WalkPlot {
  Plot plot{};
  const char* file = "";
};
inline constexpr std::array<const char*, 4> kPlotFiles{"triangles.svg", "frame_time.svg", "cull_time.svg",
                                                       "nodes_tested.svg"};
// Plots of the runs, with one value for each frame.
std::vector<WalkPlot> walkPlots(const WalkRecord& record, const Walk& walk);
std::vector<Plot> plotsOf(const WalkRecord& record, const Walk& walk);  // the same without their files
// Facts about the scene, the walk, and what was built for them.
std::vector<ReportFact> walkFacts(const WalkInput& input, const WalkRecord& record);

std::string walkJson(const WalkInput& input, const WalkRecord& record);
void printWalk(const WalkRecord& record);
Report walkReport(const WalkInput& input, const WalkRecord& record, std::vector<ReportPicture> pictures);

}  // namespace sightline::tool
