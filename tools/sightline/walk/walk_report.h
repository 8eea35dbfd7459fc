#pragma once

// A walk's numbers as JSON, as a table for the terminal, and as the report.

#include <cstdint>
#include <string>

#include "tools/sightline/report/report.h"
#include "tools/sightline/walk/walk_record.h"

namespace sightline::tool {

struct WalkInput {
  const std::string& scene_name;
  const Scene& scene;
  const Walk& walk;
  const CullingData& data;
};

// 1104233 -> "1,104,233"
std::string grouped(std::uint64_t number);

// The run's line of the table, means of a frame.
ReportRow rowOf(const WalkRun& run, const WalkRecord& record);
// In a sentence: how much of the hierarchy is tested, and what statisticsOf the setting has.
std::string statisticsText(const WalkRun& run);
// The curves of the runs, frame by frame.
std::vector<Plot> plotsOf(const WalkRecord& record, const Walk& walk);
// Of the scene, the walk, and what was made for them.
std::vector<ReportFact> walkFacts(const WalkInput& input, const WalkRecord& record);

std::string walkJson(const WalkInput& input, const WalkRecord& record);
void printWalk(const WalkRecord& record);
Report walkReport(const WalkInput& input, const WalkRecord& record, std::vector<ReportPicture> pictures);

}  // namespace sightline::tool
