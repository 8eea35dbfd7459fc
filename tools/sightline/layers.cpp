// sightline layers: the order in which the parts of a scene must be drawn, in every frame of a walk.

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "sightline/layers/compositing.h"
#include "tools/sightline/commands.h"
#include "tools/sightline/json_output.h"
#include "tools/sightline/layer_input.h"
#include "tools/sightline/layer_totals.h"
#include "tools/sightline/names.h"
#include "tools/sightline/progress_bar.h"
#include "tools/sightline/stopwatch.h"

namespace sightline::tool {
namespace {

struct LayersOptions {
  CommonOptions common;
  PathOptions path;
  LayerPlaces places;
  std::string sort = "depth-first", search = "automatic", extents = "camera", arcs = "groups",
              expression = "cheapest", conditioning = "on", exact = "on";
  bool no_times = false;
};

template <typename Tag>
std::vector<std::uint32_t> numbersOf(std::span<const Id<Tag>> ids) {
  std::vector<std::uint32_t> numbers;
  for (const Id<Tag> id : ids) {
    numbers.push_back(id.value);
  }
  return numbers;
}

Json pairsJson(std::span<const LayerArc> pairs) {
  Json json = Json::array();
  for (const LayerArc& pair : pairs) {
    json.push_back({pair.front.value, pair.back.value});
  }
  return json;
}

Json orderJson(const LayerOrder& order) {
  Json json = Json::array();
  for (std::size_t i = 0; i < order.groups(); ++i) {
    json.push_back(numbersOf(order.group(i)));
  }
  return json;
}

LayerSettings settingsOf(const LayersOptions& options) {
  LayerSettings settings;
  settings.sort = valueOf(kLayerSorts, options.sort);
  settings.search = valueOf(kOccluderSearches, options.search);
  settings.extents = options.extents == "world" ? worldExtents() : cameraExtents();
  settings.exact = valueOf(kSwitch, options.exact);
  settings.all_arcs = options.arcs == "all";
  // The world's axes say nothing about what is near.
  if (!valueOf(kSwitch, options.conditioning) || options.extents == "world") {
    settings.conditioning_axis = -1;
  }
  return settings;
}

Json optionsJson(const LayersOptions& options) {
  return {{"sort", options.sort},  {"search", options.search},         {"extents", options.extents},
          {"arcs", options.arcs},  {"expression", options.expression}, {"conditioning", options.conditioning},
          {"exact", options.exact}};
}

Json layersJson(const FrameLayers& layers) {
  Json json = Json::array();
  for (std::uint32_t layer = 0; layer < layers.layers(); ++layer) {
    json.push_back(numbersOf(layers.partsOf(LayerId(layer))));
  }
  return json;
}

Json programJson(const CompositingProgram& program) {
  Json json = Json::array();
  for (const CompositingStep& step : program.steps) {
    json.push_back(describe(step));
  }
  return json;
}

std::string frameJson(std::uint32_t frame, const LayerOrder& order, const FrameLayers& layers,
                      const CompositingProgram& program, double sort_us) {
  const LayerStats& stats = order.stats;
  return dump({{"frame", frame},
               {"order", orderJson(order)},
               {"arcs", pairsJson(order.arcs)},
               {"collisions", pairsJson(order.collisions)},
               {"layers", layersJson(layers)},
               {"program", programJson(program)},
               {"sort_us", sort_us},
               {"occluder_queries", stats.occluder_queries},
               {"candidates", stats.candidates},
               {"pair_queries", stats.pair_queries},
               {"reinsertions", stats.reinsertions},
               {"search", stats.by_tree ? "tree" : "scan"}});
}

void print(const LayerTotals& totals, std::size_t parts) {
  const auto line = [](const char* what, double value, int decimals = 1) {
    fmt::print("  {:<38}{:12.{}f}\n", what, value, decimals);
  };
  fmt::print("{} parts, {} frames, means of a frame:\n", parts, totals.frames());
  line("groups", totals.mean(&LayerTotals::Frame::groups));
  line("of them with more than one part, %", 100.0 * totals.mean(&LayerTotals::Frame::grouped_share), 2);
  line("parts in those, %", 100.0 * totals.mean(&LayerTotals::Frame::parts_in_groups_share), 2);
  line("largest group", totals.mean(&LayerTotals::Frame::largest));
  line("layers", totals.mean(&LayerTotals::Frame::layers));
  line("arcs", totals.mean(&LayerTotals::Frame::arcs));
  line("collisions", totals.mean(&LayerTotals::Frame::collisions));
  line("compositing operations", totals.mean(&LayerTotals::Frame::operations));
  line("pairs tested exactly", totals.mean(&LayerTotals::Frame::pair_queries));
  line("sort time, us", totals.mean(&LayerTotals::Frame::sort_us));
  line("sort time, largest, us", totals.largest(&LayerTotals::Frame::sort_us));
}

Result<ExitCode> sortWalk(const LayersOptions& options, const LayerInput& input) {
  LayerSorter sorter = makeSorter(input.moving, settingsOf(options));
  const CompositingForm form = valueOf(kCompositingForms, options.expression);
  std::vector<std::string> frames;
  std::vector<Mat4> poses;
  LayerTotals totals;
  LayerMerger merger;
  CompositingCompiler compiler;
  ProgressBar progress("sorting");
  for (const std::uint32_t frame : input.walk.frames) {
    const View view = input.walk.view(frame, input.moving.scene);
    pose(input.moving, frame, poses, sorter);
    Stopwatch watch;
    const LayerOrder& order = sorter.update(view);
    const double sort_us = options.no_times ? 0.0 : watch.lap();
    const FrameLayers& layers = merger.merge(order);
    const CompositingProgram& program = compiler.compile(layers, form);
    totals.add(order, static_cast<double>(layers.layers()),
               static_cast<double>(countSteps(program.steps).operations()), sort_us);
    if (!options.common.json.empty()) {
      frames.push_back(frameJson(frame, order, layers, program, sort_us));
    }
    progress.update(static_cast<double>(frame + 1) / static_cast<double>(input.walk.frames.back() + 1));
  }
  const Json head = {{"scene", sceneJson(input.moving.scene)},
                     {"parts", input.moving.parts.size()},
                     {"options", optionsJson(options)}};
  if (const Status ok = writeOutput(options.common.json, dumpWithList(head, "frames", frames)); !ok) {
    return ok.error();
  }
  if (options.common.textOnStdout()) {
    print(totals, input.moving.parts.size());
  }
  return kOk;
}

Result<ExitCode> runLayers(const LayersOptions& options) {
  const Result<LayerInput> input = loadLayerInput(options.common, options.path, options.places);
  return input ? sortWalk(options, *input) : input.error();
}

}  // namespace

void addLayers(CLI::App& app, Command& chosen) {
  CLI::App* command = app.add_subcommand(
      "layers", "the order in which parts must be drawn, cycles, and compositing programs, frame by frame");
  const auto options = std::make_shared<LayersOptions>();
  addCommonOptions(*command, options->common);
  addPathOptions(*command, options->path);
  const auto addChoice = [&](const char* name, std::string& value, const std::vector<std::string>& values,
                             const char* help) {
    command->add_option(name, value, help)->check(CLI::IsMember(values))->capture_default_str();
  };
  addChoice("--sort", options->sort, textsOf(kLayerSorts),
            "depth-first search for strongly connected components, or the paper's reinsertion (incremental)");
  addChoice("--search", options->search, textsOf(kOccluderSearches), "how candidates are found");
  addChoice("--extents", options->extents, {"camera", "world"},
            "two angles and depth of the camera, or x, y, z of the world");
  addChoice("--arcs", options->arcs, {"groups", "all"}, "who occludes whom: within groups, or of all pairs");
  addChoice("--expression", options->expression, textsOf(kCompositingForms),
            "how cycles without mutual occlusion are composited");
  addChoice("--conditioning", options->conditioning, textsOf(kSwitch),
            "let near groups move forward in the order (camera extents only)");
  addChoice("--exact", options->exact, textsOf(kSwitch), "off: extents alone decide, groups grow");
  command->add_option("--backdrop", options->places.backdrops, "parts behind all others, by number")
      ->delimiter(',');
  command->add_option("--overlay", options->places.overlays, "parts before all others, by number")
      ->delimiter(',');
  command->add_flag("--no-times", options->no_times, "write all times as 0: runs can be compared bit by bit");
  command->footer(
      "A part is an object of the scene, taken as its convex hull. Groups are parts that occlude each other "
      "in "
      "a circle; layers, what must be drawn together within them.\n"
      "Examples:\n"
      "  sightline layers demo:toothpicks --json order.json\n"
      "  sightline layers \"demo:toothpicks?n=1600&scaling=ud\" --sort incremental\n"
      "  sightline layers demo:canyon --extents world --expression over-atop --json -\n"
      "  sightline layers model.glb --path walk.json --arcs all --backdrop 0");
  command->callback([options, &chosen] { chosen = [options] { return runLayers(*options); }; });
}

}  // namespace sightline::tool
