#include "tools/sightline/statistics.h"

#include <algorithm>

namespace sightline::tool {
namespace {

bool hasRelations(const Setting& setting) {
  return setting.planesThroughBox();
}
bool hasDetail(const Setting& setting) {
  return setting.testsDetailObjects();
}

constexpr Statistic kStatistics[] = {
    {"relations", "reused", "relations reused",
     [](const CullStats& s) -> std::uint64_t { return s.relations.reused; }, hasRelations},
    {"relations", "unchanged", "of them unchanged",
     [](const CullStats& s) -> std::uint64_t { return s.relations.unchanged; }, hasRelations},
    {"relations", "rebuilt", "relations rebuilt",
     [](const CullStats& s) -> std::uint64_t { return s.relations.rebuilt; }, hasRelations},
    {"relations", "evicted", "relations evicted",
     [](const CullStats& s) -> std::uint64_t { return s.relations.evicted; }, hasRelations},
    {"relations", "dropped", "relations dropped",
     [](const CullStats& s) -> std::uint64_t { return s.relations.dropped; }, hasRelations},
    {"relations", "kept", "relations kept",
     [](const CullStats& s) -> std::uint64_t { return s.relations.kept; }, hasRelations},
    {"relations", "bytes", "bytes for them",
     [](const CullStats& s) -> std::uint64_t { return s.relations.bytes; }, hasRelations},
    {"detail", "tested", "detail tested", [](const CullStats& s) -> std::uint64_t { return s.detail_tested; },
     hasDetail},
    {"detail", "culled", "detail culled", [](const CullStats& s) -> std::uint64_t { return s.detail_culled; },
     hasDetail},
};

}  // namespace

std::vector<Statistic> statisticsOf(const Setting& setting) {
  std::vector<Statistic> chosen;
  std::copy_if(std::begin(kStatistics), std::end(kStatistics), std::back_inserter(chosen),
               [&](const Statistic& statistic) { return statistic.belongs(setting); });
  return chosen;
}

double testedShare(const CullStats& stats, std::size_t hierarchy_nodes) {
  return hierarchy_nodes > 0 ? static_cast<double>(stats.nodes_tested) / static_cast<double>(hierarchy_nodes)
                             : 0.0;
}

}  // namespace sightline::tool
