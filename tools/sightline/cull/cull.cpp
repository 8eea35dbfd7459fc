// sightline cull: lists the objects that may be visible in every frame of a camera path.

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tools/sightline/command_line/json_output.h"
#include "tools/sightline/command_line/progress_bar.h"
#include "tools/sightline/command_line/threads.h"
#include "tools/sightline/commands.h"
#include "tools/sightline/cull/cull_run.h"
#include "tools/sightline/input/scene_facts.h"
#include "tools/sightline/methods/statistics.h"

namespace sightline::tool {
namespace {

struct CullOptions {
  CommonOptions common;
  PathOptions path;
  MethodOptions method;
  bool no_times = false;
};

// Sums over all frames.
struct Totals {
  double objects = 0.0, clusters = 0.0, triangles = 0.0, cull_us = 0.0, nodes_tested = 0.0,
         tested_share = 0.0, occluders = 0.0;
  std::vector<double> statistics{};  // in the order of statisticsOf
};

std::vector<std::uint64_t> valuesOf(const std::vector<Statistic>& statistics, const Culler& culler,
                                    bool times) {
  std::vector<std::uint64_t> values = statisticValues(statistics, culler);
  for (std::size_t i = 0; i < statistics.size(); ++i) {
    values[i] = statistics[i].time && !times ? 0 : values[i];
  }
  return values;
}

std::string frameJson(std::uint32_t frame, const CullRun& run, const Clustering& clustering,
                      const std::vector<Statistic>& statistics, const std::vector<std::uint64_t>& values,
                      double tested_share, bool times) {
  std::vector<std::uint32_t> ids;
  for (const ObjectId object : run.culler.visible()) {
    ids.push_back(object.value);
  }
  const CullStats& stats = run.culler.stats();
  Json json = {{"frame", frame},
               {"visible", ids},
               {"cull_us", times ? run.cull_us : 0.0},
               {"nodes_tested", stats.nodes_tested},
               {"nodes_tested_share", tested_share},
               {"occluders", stats.occluders}};
  if (clustering.on()) {
    json["visible_clusters"] = std::exchange(json["visible"], objectsWith(clustering, run.culler.visible()));
  }
  addStatistics(json, statistics, [&](std::size_t i) { return values[i]; });
  return dump(json);
}

struct PrintedMean {
  std::string_view caption;
  double value = 0.0;
  std::string after{};  // the unit, or what it is a part of
};

// Prints one line each, with the numbers below each other.
void print(const std::vector<PrintedMean>& means) {
  std::size_t width = 0;
  for (const PrintedMean& mean : means) {
    width = std::max(width, mean.caption.size());
  }
  for (const PrintedMean& mean : means) {
    fmt::print("  {:<{}} {:12.1f}{}\n", mean.caption, width, mean.value, mean.after);
  }
}

void print(const Setting& setting, const CullingData& data, const SceneAndWalk& input, const Totals& sum) {
  if (setting.choice != nullptr) {
    fmt::print("{}\n", choiceText({setting}));
  }
  const double n = static_cast<double>(input.walk.frames.size());
  fmt::print("{} ({}){}{}, {} frames, means of a frame:\n", methodName(setting), optionsText(setting),
             crackText(input.closing.note()), clustersText(input.clustering), input.walk.frames.size());
  std::vector<PrintedMean> means;
  if (input.clustering.on()) {
    means.push_back({"visible clusters", sum.clusters / n, fmt::format(" of {}", data.bounds().size())});
  }
  means.push_back(
      {"visible objects", sum.objects / n,
       fmt::format(" of {}", input.clustering.on() ? input.clustering.objects : data.bounds().size())});
  means.push_back({"their triangles", sum.triangles / n});
  means.push_back({"cull time", sum.cull_us / n, " us"});
  means.push_back({"nodes tested", sum.nodes_tested / n,
                   fmt::format(" ({:.1f} % of the hierarchy)", 100.0 * sum.tested_share / n)});
  if (setting.choosesOccluders()) {
    means.push_back({"occluders", sum.occluders / n});
  }
  const std::vector<Statistic> statistics = statisticsOf(setting);
  for (std::size_t i = 0; i < statistics.size(); ++i) {
    if (statistics[i].shown) {
      means.push_back({statistics[i].caption, sum.statistics[i] / n});
    }
  }
  print(means);
}

Status checkSingle(const Result<std::vector<Setting>>& settings) {
  if (!settings) {
    return settings.error();
  }
  if (settings->size() != 1) {
    return Error{"cull takes one value an option; walk and verify take lists"};
  }
  return Success{};
}

Result<ExitCode> cullWalk(const CullOptions& options, const Setting& setting, const SceneAndWalk& input) {
  const Scene& scene = input.scene;
  const Walk& walk = input.walk;
  const Threads threads(options.common.threads);
  CullingData data(input, threads.parallelFor());
  CullRun run{data.makeCuller(setting)};
  std::vector<std::string> frames;
  const std::vector<Statistic> statistics = statisticsOf(setting);
  Totals sum;
  sum.statistics.assign(statistics.size(), 0.0);
  ProgressBar progress("culling");
  for (const std::uint32_t frame : walk.frames) {
    run.cull(walk.view(frame, scene));
    const CullStats& stats = run.culler.stats();
    const double tested_share = testedShare(stats, data.hierarchy(setting.hierarchy).nodes.size());
    const std::vector<std::uint64_t> values = valuesOf(statistics, run.culler, !options.no_times);
    if (!options.common.json.empty()) {
      frames.push_back(
          frameJson(frame, run, input.clustering, statistics, values, tested_share, !options.no_times));
    }
    sum.clusters += static_cast<double>(run.culler.visible().size());
    sum.objects +=
        static_cast<double>(input.clustering.on() ? objectsWith(input.clustering, run.culler.visible()).size()
                                                  : run.culler.visible().size());
    sum.triangles += static_cast<double>(data.trianglesOf(run.culler.visible()));
    sum.cull_us += options.no_times ? 0.0 : run.cull_us;
    sum.nodes_tested += stats.nodes_tested;
    sum.tested_share += tested_share;
    sum.occluders += stats.occluders;
    for (std::size_t i = 0; i < statistics.size(); ++i) {
      sum.statistics[i] += static_cast<double>(values[i]);
    }
    progress.update(static_cast<double>(frame + 1) / static_cast<double>(walk.frames.back() + 1));
  }
  data.noteUnknownSets();
  Json head = {
      {"scene", sceneJson(input)}, {"method", methodName(setting)}, {"options", optionsJson(setting)}};
  addChoice(head, setting);
  addDatabases(head, data, !options.no_times);
  if (input.clustering.on()) {
    head["clusters"] = clustersJson(input.clustering, scene);
  }
  if (const Status ok = writeOutput(options.common.json, dumpWithList(head, "frames", frames)); !ok) {
    return ok.error();
  }
  if (options.common.textOnStdout()) {
    print(setting, data, input, sum);
  }
  return kOk;
}

Result<ExitCode> runCull(const CullOptions& options) {
  const Result<std::vector<Setting>> checked = settingsOf(options.method);
  if (const Status single = checkSingle(checked); !single) {
    return single.error();
  }
  const Result<SceneAndWalk> input = checkAndLoad(options.common, options.path, options.method);
  if (!input) {
    return input.error();
  }
  const Result<std::vector<Setting>> settings = settingsFor(options.method, *checked, *input);
  if (const Status single = checkSingle(settings); !single) {
    return single.error();
  }
  return cullWalk(options, settings->front(), *input);
}

}  // namespace

void addCull(CLI::App& app, Command& chosen) {
  CLI::App* command = app.add_subcommand("cull", "the visible objects of every frame of a walk");
  const auto options = std::make_shared<CullOptions>();
  addCommonOptions(*command, options->common);
  addPathOptions(*command, options->path);
  addMethodOptions(*command, options->method, false);
  addClustersOption(*command, options->method.clusters);
  command->add_flag("--no-times", options->no_times, "write all times as 0: runs can be compared bit by bit");
  command->footer(
      "Examples:\n"
      "  sightline cull city.glb --path walk.json --json visible.json\n"
      "  sightline cull demo:city --path worst --method occlusion-tree --occluder-count 32 --json -\n"
      "  sightline cull demo:building --method supporting-planes --hierarchy kd --occluders database\n"
      "  sightline cull demo:building --method frustum --frames 0:400:10\n"
      "  sightline cull city.glb --method auto --json visible.json\n"
      "  sightline cull demo:ship --method visibility-octree --baked ship.sight");
  command->callback([options, &chosen] { chosen = [options] { return runCull(*options); }; });
}

}  // namespace sightline::tool
