#pragma once

// What cullers count beyond nodes and occluders: for JSON, the terminal and the report.

#include <cstdint>
#include <vector>

#include "tools/sightline/command_line/json_output.h"
#include "tools/sightline/methods/setting.h"

namespace sightline::tool {

struct Statistic {
  const char* group;    // "relations": an object in JSON
  const char* name;     // "reused": its key in there
  const char* caption;  // "relations reused"
  bool time = false;    // differs from run to run
  bool shown = true;    // in texts; false: in JSON alone, where it is always 0
};

// Returns the statistics that apply to the setting: those of its sets, and those of its method but for the
// groups that the method's row hides.
std::vector<Statistic> statisticsOf(const Setting& setting);

// Their values in the culler's last frame, in the same order.
std::vector<std::uint64_t> statisticValues(const std::vector<Statistic>& statistics, const Culler& culler);

// Adds {"relations":{"reused":n,...}} and so on; number: from a statistic's index to its value.
template <typename Number>
void addStatistics(Json& json, const std::vector<Statistic>& statistics, Number&& number) {
  for (std::size_t i = 0; i < statistics.size(); ++i) {
    json[statistics[i].group][statistics[i].name] = number(i);
  }
}

// The part of a hierarchy's nodes that the occlusion structure was asked about.
double testedShare(const CullStats& stats, std::size_t hierarchy_nodes);

}  // namespace sightline::tool
