#pragma once

// A walk's numbers as JSON, as a table for the terminal, and as the report.

#include <cstdint>
#include <string>

#include "sightline/render/report.h"
#include "tools/sightline/walk_record.h"

namespace sightline::tool {

struct WalkInput {
  const std::string& scene_name;
  const Scene& scene;
  const Walk& walk;
  const OccluderSet& occluders;
};

// 1104233 -> "1,104,233"
std::string grouped(std::uint64_t number);

std::string walkJson(const WalkInput& input, const WalkRecord& record);
void printWalk(const WalkRecord& record);
Report walkReport(const WalkInput& input, const WalkRecord& record, std::vector<ReportPicture> pictures);

}  // namespace sightline::tool
