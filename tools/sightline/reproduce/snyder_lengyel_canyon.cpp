// Snyder and Lengyel 1997, section 12.2: the canyon's tables, as far as sorting and splitting decide them.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "sightline/layers/compositing.h"
#include "tools/sightline/command_line/progress_bar.h"
#include "tools/sightline/reproduce/saved_rendering.h"
#include "tools/sightline/reproduce/snyder_lengyel.h"

namespace sightline::tool {
namespace {

using Frame = LayerTotals::Frame;

// The numbers of the paper's tables for one division of the terrain.
struct CanyonRow {
  std::uint32_t grid = 0;
  double objects = 0, polygons = 0, hull_polygons = 0, cpu = 0, cpu_max = 0, expansion = 0, layers = 0,
         parts = 0, unit_agg = 0, unit = 0, poly_agg = 0, poly = 0;
};
constexpr std::array<CanyonRow, 5> kCanyon{
    {{20, 390, 31.98, 29.01, 17.33, 29.82, 5.04, 0.1, 0.2, 58.3, 58.1, 41.8, 40.7},
     {14, 191, 48.91, 37.78, 8.08, 14.59, 3.78, 0.4, 1.0, 51.3, 50.2, 38.0, 36.0},
     {10, 100, 76.48, 42.42, 5.17, 9.88, 3.09, 1.9, 6.4, 48.7, 40.9, 40.4, 30.7},
     {7, 49, 130.45, 57.51, 4.51, 9.68, 2.58, 5.2, 22.5, 51.9, 37.8, 42.4, 27.8},
     {5, 25, 225.32, 72.72, 5.37, 11.01, 2.28, 13.0, 53.1, 71.5, 32.3, 72.0, 26.1}}};

// The share of frames in which the paper assumes a part to be redrawn (section 12.2).
double updateRate(const std::string& part_class) {
  return part_class == "aircraft" ? 0.2 : part_class == "terrain" ? 0.7 : 0.4;
}

// Sums over the visible parts of all frames.
struct UpdateRates {
  double layers = 0, aggregated_layers = 0, parts = 0, aggregated_parts = 0;
  double unit = 0, unit_agg = 0, weight = 0, poly = 0, poly_agg = 0;

  // expansion is the number of the terrain's polygons after the split divided by that before it. Rates count
  // for the polygons after the split, relative to those of the scene before it.
  void add(double rate, bool aggregated, double polygons, double expansion) {
    const double with_penalty = aggregated ? 1.0 : rate;
    parts += 1.0;
    aggregated_parts += aggregated ? 1.0 : 0.0;
    unit += rate;
    unit_agg += with_penalty;
    weight += polygons / expansion;
    poly += rate * polygons;
    poly_agg += with_penalty * polygons;
  }
};

struct TerrainCounts {
  double pieces = 0, hull_polygons = 0;
};

TerrainCounts countTerrain(const MovingScene& scene) {
  TerrainCounts counts;
  for (const MovingPart& part : scene.parts) {
    if (scene.classes[part.class_of] == "terrain") {
      counts.pieces += 1.0;
      counts.hull_polygons += static_cast<double>(scene.hulls[part.hulls.front()].faces.size());
    }
  }
  return counts;
}

double terrainPolygons(const CanyonOptions& canyon) {
  return static_cast<double>(canyonTerrainTriangles(canyon));
}

void addFrame(const MovingScene& scene, const FrameLayers& layers, const std::vector<Mat4>& poses,
              const View& view, double expansion, UpdateRates& rates) {
  const Frustum frustum = frustumOf(view);
  std::vector<PartId> visible;
  for (std::uint32_t layer = 0; layer < layers.layers(); ++layer) {
    visible.clear();
    for (const PartId part : layers.partsOf(LayerId(layer))) {
      if (isPartInView(scene, part.value, poses[part.value], frustum)) {
        visible.push_back(part);
      }
    }
    const bool aggregated = visible.size() > 1;
    rates.layers += visible.empty() ? 0.0 : 1.0;
    rates.aggregated_layers += aggregated ? 1.0 : 0.0;
    for (const PartId part : visible) {
      const std::string& part_class = scene.classes[scene.parts[part.value].class_of];
      rates.add(updateRate(part_class), aggregated, scene.scene.objects[part.value].triangleCount(),
                part_class == "terrain" ? expansion : 1.0);
    }
  }
}

Experiment emptyTable() {
  return {"canyon",
          "The canyon by the terrain's grid (each second line: the paper's; cpu in us, the paper's in ms)",
          "the least polygon-weighted update rate, 38 %, with 14 x 14; coarser grids aggregate",
          {{"grid", "grid"},
           {"objects", "pieces", 0},
           {"polygons", "polygons each", 2},
           {"hull_polygons", "hull polygons", 2},
           {"cpu", "cpu mean", 1},
           {"cpu_max", "cpu max", 1},
           {"expansion", "expansion", 2},
           {"layers", "layers agg %", 1},
           {"parts", "parts agg %", 1},
           {"unit_agg", "unit agg", 1},
           {"unit", "no agg", 1},
           {"poly_agg", "poly agg", 1},
           {"poly", "no agg", 1}}};
}

// unsplit is the number of the terrain's polygons before the split.
Json measuredRow(std::uint32_t grid, double unsplit, const ReproduceOptions& options) {
  const MovingScene scene = makeCanyon({.grid = grid});
  const TerrainCounts terrain = countTerrain(scene);
  const double polygons = static_cast<double>(trianglesOfClass(scene, "terrain")),
               expansion = polygons / unsplit;
  UpdateRates rates;
  LayerMerger merger;
  std::vector<Mat4> poses(scene.parts.size());
  const LayerTotals totals = sortFrames(scene, canyonSorting(), options,
                                        [&](std::uint32_t frame, const LayerOrder& order, const View& view) {
                                          scene.pose(frame, poses);
                                          addFrame(scene, merger.merge(order), poses, view, expansion, rates);
                                        });
  return {{"grid", fmt::format("{0} x {0}", grid)},
          {"objects", terrain.pieces},
          {"polygons", polygons / terrain.pieces},
          {"hull_polygons", terrain.hull_polygons / terrain.pieces},
          {"cpu", totals.mean(&Frame::sort_us)},
          {"cpu_max", totals.largestAfterFirst(&Frame::sort_us)},
          {"expansion", expansion},
          {"layers", 100.0 * rates.aggregated_layers / rates.layers},
          {"parts", 100.0 * rates.aggregated_parts / rates.parts},
          {"unit_agg", 100.0 * rates.unit_agg / rates.parts},
          {"unit", 100.0 * rates.unit / rates.parts},
          {"poly_agg", 100.0 * rates.poly_agg / rates.weight},
          {"poly", 100.0 * rates.poly / rates.weight}};
}

Json paperRow(const CanyonRow& paper) {
  return {{"grid", "  paper"},
          {"objects", paper.objects},
          {"polygons", paper.polygons},
          {"hull_polygons", paper.hull_polygons},
          {"cpu", paper.cpu},
          {"cpu_max", paper.cpu_max},
          {"expansion", paper.expansion},
          {"layers", paper.layers},
          {"parts", paper.parts},
          {"unit_agg", paper.unit_agg},
          {"unit", paper.unit},
          {"poly_agg", paper.poly_agg},
          {"poly", paper.poly}};
}

// Overlaps of the pieces that are tried, as fractions of a cell's size.
constexpr std::array kInflations{0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7};

std::string gridKey(std::uint32_t grid) {
  return fmt::format("grid_{}", grid);
}

// The inflation at which a factor is reached, by linear interpolation between those that were tried; one
// factor for each of them, ascending. At most the last of them.
double inflationFor(const std::array<double, kInflations.size()>& factors, double wanted) {
  for (std::size_t i = 1; i < factors.size(); ++i) {
    if (factors[i] >= wanted) {
      const double part = std::max(0.0, (wanted - factors[i - 1]) / (factors[i] - factors[i - 1]));
      return kInflations[i - 1] + part * (kInflations[i] - kInflations[i - 1]);
    }
  }
  return kInflations.back();
}

}  // namespace

Experiment inflationTable() {
  Experiment table{"inflation",
                   "The canyon's expansion factors by the overlap of the terrain's pieces (inflation; a part "
                   "of a cell's size, half of it on each side)",
                   "5.04, 3.78, 3.09, 2.58 and 2.28 with an inflation factor of 20 %",
                   {{"inflation", "inflation"}}};
  const double unsplit = terrainPolygons({.grid = 1, .inflation = 0.0});
  for (const double inflation : kInflations) {
    const bool ours = inflation == CanyonOptions{}.inflation;
    table.rows.push_back({{"inflation", fmt::format("{:.1f}{}", inflation, ours ? ", used here" : "")}});
  }
  Json paper{{"inflation", "paper"}}, fits{{"inflation", "inflation that gives the paper's"}};
  ProgressBar progress("inflation");
  for (std::size_t g = 0; g < kCanyon.size(); ++g) {
    const std::uint32_t grid = kCanyon[g].grid;
    std::array<double, kInflations.size()> factors{};
    for (std::size_t i = 0; i < factors.size(); ++i) {
      factors[i] = terrainPolygons({.grid = grid, .inflation = kInflations[i]}) / unsplit;
      table.rows[i][gridKey(grid)] = factors[i];
    }
    paper[gridKey(grid)] = kCanyon[g].expansion;
    fits[gridKey(grid)] = inflationFor(factors, kCanyon[g].expansion);
    table.columns.push_back({gridKey(grid), fmt::format("{0} x {0}", grid), 2});
    progress.update(static_cast<double>(g + 1) / kCanyon.size());
  }
  table.rows.push_back(std::move(paper));
  table.rows.push_back(std::move(fits));
  return table;
}

Experiment canyonTable(const ReproduceOptions& options) {
  Experiment table = emptyTable();
  const double unsplit = terrainPolygons({.grid = 1, .inflation = 0.0});
  ProgressBar progress("canyon");
  for (std::size_t i = 0; i < kCanyon.size(); ++i) {
    table.rows.push_back(measuredRow(kCanyon[i].grid, unsplit, options));
    table.rows.push_back(paperRow(kCanyon[i]));
    progress.update(static_cast<double>(i + 1) / kCanyon.size());
  }
  return table;
}

}  // namespace sightline::tool
