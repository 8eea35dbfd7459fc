#pragma once

// What cullers count beyond nodes and occluders: one table for JSON, the terminal and the report.

#include <cstdint>
#include <vector>

#include "tools/sightline/methods/method_options.h"

namespace sightline::tool {

struct Statistic {
  const char* group;  // "relations": an object in JSON
  const char* name;   // "reused": its key in there
  const char* text;   // "relations reused"
  std::uint64_t (*of)(const CullStats& stats);
  bool (*belongs)(const Setting& setting);
  bool time = false;  // differs from run to run
};

// Those that mean something for the setting.
std::vector<Statistic> statisticsOf(const Setting& setting);

// Adds {"relations":{"reused":n,...}} and so on for the setting's statistics; number: of each.
template <typename Number>
void addStatistics(Json& json, const Setting& setting, Number&& number) {
  for (const Statistic& statistic : statisticsOf(setting)) {
    json[statistic.group][statistic.name] = number(statistic);
  }
}

// The part of a hierarchy's nodes that was asked of the occlusion structure.
double testedShare(const CullStats& stats, std::size_t hierarchy_nodes);

}  // namespace sightline::tool
