#pragma once

#include <string>
#include <vector>

#include "tools/sightline/bench/bench_record.h"

namespace sightline::tool {

// The page of all scenes as HTML: for each the advice, a plot of the front, and the table. All text is
// escaped.
std::string benchReport(const std::vector<BenchRecord>& records, const std::string& command_line);

}  // namespace sightline::tool
