#include "tools/sightline/methods/statistics.h"

#include <algorithm>
#include <memory>
#include <string_view>

namespace sightline::tool {
namespace {

constexpr std::string_view kSets = "sets";
constexpr std::string_view kHiddenOccluders = "occluders_hidden";

// The culler's own statistics of potentially visible sets.
std::uint64_t ofSets(std::string_view name, const CullStats& stats) {
  return name == "nodes"     ? stats.set_nodes
         : name == "objects" ? stats.set_objects
                             : static_cast<std::uint64_t>(stats.look_up_us * 1e3);
}

}  // namespace

std::vector<Statistic> statisticsOf(const Setting& setting) {
  std::vector<Statistic> chosen;
  if (setting.usesVisibleSets()) {
    chosen = {{kSets.data(), "nodes", "nodes of the set"},
              {kSets.data(), "objects", "objects of the set"},
              {kSets.data(), "look_up_ns", "look-up, ns", true}};
  }
  const std::vector<std::string_view>& hidden = setting.method->hidden_statistics;
  const std::unique_ptr<CullingMethod> method = makeMethod(setting);
  for (const MethodStatistic& statistic : method->statistics()) {
    if (std::find(hidden.begin(), hidden.end(), statistic.group) == hidden.end()) {
      const bool of_occluders = statistic.name == kHiddenOccluders;
      chosen.push_back({.group = statistic.group,
                        .name = statistic.name,
                        .caption = statistic.caption,
                        .shown = !of_occluders || setting.choosesOccluders()});
    }
  }
  return chosen;
}

std::vector<std::uint64_t> statisticValues(const std::vector<Statistic>& statistics, const Culler& culler) {
  std::vector<std::uint64_t> values;
  for (const Statistic& statistic : statistics) {
    values.push_back(statistic.group == kSets ? ofSets(statistic.name, culler.stats())
                                              : culler.statistic(statistic.group, statistic.name));
  }
  return values;
}

double testedShare(const CullStats& stats, std::size_t hierarchy_nodes) {
  return hierarchy_nodes > 0 ? static_cast<double>(stats.nodes_tested) / static_cast<double>(hierarchy_nodes)
                             : 0.0;
}

}  // namespace sightline::tool
