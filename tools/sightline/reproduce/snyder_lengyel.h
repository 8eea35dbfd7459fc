#pragma once

// The tables of `reproduce snyder-lengyel`.

#include <cstdint>
#include <functional>
#include <vector>

#include "scenes/moving_scene.h"
#include "sightline/layers/layer_sorter.h"
#include "tools/sightline/layers/layer_totals.h"
#include "tools/sightline/report/plot.h"
#include "tools/sightline/reproduce/reproduction.h"

namespace sightline::tool {

// Sorts a scene's frames one after another; only the first ones if `options` ask for few. Calls visit, if
// given, after each frame.
LayerTotals sortFrames(
    const MovingScene& scene, const LayerSettings& settings, const ReproduceOptions& options,
    const std::function<void(std::uint32_t frame, const LayerOrder& order, const View& view)>& visit = {});

// The paper's sorting of the canyon: three orthogonal extents of the world.
inline LayerSettings canyonSorting() {
  return {.extents = worldExtents()};
}

struct SortingTables {
  std::vector<Experiment> experiments{};
  std::vector<Plot> plots{};
};
SortingTables sortingTables(const ReproduceOptions& options);

Experiment canyonTable(const ReproduceOptions& options);
// By how many times the terrain's polygons grow with other overlaps of its pieces than the scene's own.
Experiment inflationTable();

// Statements of the paper about what is in these tables; tables that are not there have none.
std::vector<Finding> snyderLengyelFindings(const std::vector<Experiment>& tables);

}  // namespace sightline::tool
