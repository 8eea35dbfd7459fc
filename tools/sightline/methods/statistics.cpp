#include "tools/sightline/methods/statistics.h"

#include <algorithm>

namespace sightline::tool {
namespace {

bool hasRelations(const Setting& setting) {
  return setting.planesThroughBox();
}
bool hasDetail(const Setting& setting) {
  return setting.testsDetailObjects();
}

bool hasSets(const Setting& setting) {
  return setting.usesVisibleSets();
}

bool hasMap(const Setting& setting) {
  return setting.usesMap();
}
bool hasPyramid(const Setting& setting) {
  return setting.culler.method == CullMethod::kDepthPyramid;
}
bool hasOpacity(const Setting& setting) {
  return setting.culler.method == CullMethod::kOpacityMap;
}
bool adapts(const Setting& setting) {
  return hasOpacity(setting) && setting.culler.triangle_us > 0.0;
}

constexpr Statistic kStatistics[] = {
    {"sets", "nodes", "nodes of the set", [](const CullStats& s) -> std::uint64_t { return s.set_nodes; },
     hasSets},
    {"sets", "objects", "objects of the set",
     [](const CullStats& s) -> std::uint64_t { return s.set_objects; }, hasSets},
    {"sets", "look_up_ns", "look-up, ns",
     [](const CullStats& s) -> std::uint64_t { return static_cast<std::uint64_t>(s.look_up_us * 1e3); },
     hasSets, true},
    {"map", "occluders_hidden", "occluders behind others",
     [](const CullStats& s) -> std::uint64_t { return s.occluders_hidden; }, hasMap},
    {"map", "focused", "frames with a finer map",
     [](const CullStats& s) -> std::uint64_t { return s.focused ? 1 : 0; }, hasPyramid},
    {"map", "overlap_tests", "overlap tests",
     [](const CullStats& s) -> std::uint64_t { return s.opacity.overlap_tests; }, hasOpacity},
    {"map", "overlap_failed", "of them failed",
     [](const CullStats& s) -> std::uint64_t { return s.opacity.overlap_failed; }, hasOpacity},
    {"map", "given_up", "given up for little coverage",
     [](const CullStats& s) -> std::uint64_t { return s.opacity.given_up; }, hasOpacity},
    {"map", "depth_tests", "depth tests",
     [](const CullStats& s) -> std::uint64_t { return s.opacity.depth_tests; }, hasOpacity},
    {"map", "depths_compared", "depths compared",
     [](const CullStats& s) -> std::uint64_t { return s.opacity.depths_compared; }, hasOpacity},
    {"map", "suspended", "frames without occlusion culling",
     [](const CullStats& s) -> std::uint64_t { return s.suspended ? 1 : 0; }, adapts},
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
