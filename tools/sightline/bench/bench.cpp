// sightline bench: measures methods side by side on scenes, in one interleaved run, and says which one to
// use.

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <set>

#include "sightline/io/file.h"
#include "src/base/stopwatch.h"
#include "tools/sightline/bench/bench_report.h"
#include "tools/sightline/bench/bench_text.h"
#include "tools/sightline/bench/scene_bench.h"
#include "tools/sightline/command_line/command_line.h"
#include "tools/sightline/command_line/json_output.h"
#include "tools/sightline/command_line/note.h"
#include "tools/sightline/command_line/signals.h"
#include "tools/sightline/commands.h"
#include "tools/sightline/exact/exact_cache.h"
#include "tools/sightline/methods/baseline.h"

namespace sightline::tool {
namespace {

// Files in the folder of the report.
constexpr const char *kBenchPage = "index.html", *kBenchJson = "bench.json", *kBenchCsv = "bench.csv";

struct BenchOptions {
  std::vector<std::string> scenes;
  OutputOptions output;
  std::string csv, folder;
  std::uint32_t threads = 1;
  PathOptions path;
  MethodOptions method;
  BenchSettings measured;
  std::string cache;  // empty: the usual folder
  bool no_cache = false;
  std::string command_line;

  bool textOnStdout() const { return output.textOnStdout() && csv != "-"; }
};

// The settings with the baseline in front, each once: rows of a table are known by their method and options.
std::vector<Setting> distinctSettings(const std::vector<Setting>& settings) {
  std::vector<Setting> distinct;
  std::set<std::pair<std::string, std::string>> known;
  for (const Setting& setting : withBaseline(settings)) {
    if (known.emplace(methodName(setting), optionsText(setting)).second) {
      distinct.push_back(setting);
    }
  }
  return distinct;
}

// Loads all scenes before the work starts, so that errors show early.
Result<std::vector<BenchInput>> loadInputs(const BenchOptions& options) {
  std::vector<BenchInput> inputs;
  if (options.scenes.size() > 1 && !options.method.prepared.empty()) {
    return Error{
        fmt::format("--prepared {}: a file is of one scene; give one scene", options.method.prepared)};
  }
  for (const std::string& scene : options.scenes) {
    base::Stopwatch watch;
    Result<SceneAndWalk> input = loadSceneAndWalk(scene, options.path, options.method);
    if (!input) {
      return input.error();
    }
    inputs.push_back({std::move(*input), watch.lap()});
  }
  return inputs;
}

Status writeFolder(const BenchOptions& options, const std::vector<BenchRecord>& records) {
  const std::string page = benchReport(records, options.command_line);
  for (const Status& status : {writeFile(options.folder + "/" + kBenchPage, page),
                               writeOutput(options.folder + "/" + kBenchJson, benchJson(records)),
                               writeOutput(options.folder + "/" + kBenchCsv, benchCsv(records))}) {
    if (!status) {
      return status;
    }
  }
  return Success{};
}

// Says on stderr which settings have culled visible objects although they are not approximate. Returns true
// if there are none.
bool noneMissed(const std::vector<BenchRecord>& records) {
  bool none = true;
  for (const BenchRecord& record : records) {
    for (const SettingRecord& run : record.runs) {
      if (run.missed > 0 && !run.setting.approximate()) {
        printNote("{}: {} ({}) has culled {} visible objects; see: sightline verify", record.scene_name,
                  methodName(run.setting), optionsText(run.setting), run.missed);
        none = false;
      }
    }
  }
  return none;
}

Result<ExitCode> writeResults(const BenchOptions& options, const std::vector<BenchRecord>& records) {
  const SignalGuard guard;  // writes all files or none
  for (const Status& status :
       {writeOutput(options.output.json, options.output.json.empty() ? "" : benchJson(records)),
        writeOutput(options.csv, options.csv.empty() ? "" : benchCsv(records)),
        options.folder.empty() ? Status(Success{}) : writeFolder(options, records)}) {
    if (!status) {
      return status.error();
    }
  }
  if (options.textOnStdout()) {
    for (const BenchRecord& record : records) {
      fmt::print("{}{}{}\n\n", benchNotes(record), benchTable(record), record.advice.sentence);
    }
    if (!options.folder.empty()) {
      fmt::print("report: {}\n", (std::filesystem::path(options.folder) / kBenchPage).string());
    }
  }
  return noneMissed(records) ? kOk : kCheckFailed;
}

Status checkFilesOf(const BenchOptions& options) {
  CommandFiles files{.scenes = options.scenes,
                     .outputs = {{"--json", options.output.json},
                                 {"--csv", options.csv},
                                 {"--prepared", options.method.prepared}},
                     .folder = {"--output", options.folder, {kBenchPage, kBenchJson, kBenchCsv}}};
  for (const std::string& scene : options.scenes) {
    for (const NamedFile& input : walkInputs(scene, options.path, options.method.baked)) {
      files.inputs.push_back(input);
    }
  }
  if (options.output.json == "-" && options.csv == "-") {
    return Error{"--csv -: standard output has the JSON; name a file"};
  }
  if (options.scenes.size() > 1 && !options.method.baked.empty()) {
    return Error{"--baked: a baked file is of one scene; give one SCENE"};
  }
  for (const std::string& scene : options.scenes) {
    if (std::count(options.scenes.begin(), options.scenes.end(), scene) > 1) {
      return Error{fmt::format("SCENE {}: is given twice; give it once", scene)};
    }
  }
  return checkFiles(files);
}

// The cache in the folder that the options name, or in the usual one. If the usual one cannot be used, this
// is only said on stderr.
Result<ExactCache> openCache(const BenchOptions& options) {
  if (options.no_cache) {
    return ExactCache::open("");
  }
  if (!options.cache.empty()) {
    Result<ExactCache> cache = ExactCache::open(options.cache);
    return cache ? std::move(cache) : Result<ExactCache>(Error{"--cache " + cache.error().message});
  }
  Result<ExactCache> usual = ExactCache::open(ExactCache::usualFolder());
  if (usual) {
    return usual;
  }
  printNote("exact visibility is not kept: {}", usual.error().message);
  return ExactCache::open("");
}

Result<ExitCode> runBench(const BenchOptions& options) {
  const Result<std::vector<Setting>> chosen = settingsOf(options.method);
  if (!chosen) {
    return chosen.error();
  }
  if (asksForChoice(options.method)) {
    return Error{"--method auto: bench measures methods to choose from; walk, cull and verify can choose"};
  }
  if (const Status ok = checkFilesOf(options); !ok) {
    return ok.error();
  }
  Result<std::vector<BenchInput>> inputs = loadInputs(options);
  if (!inputs) {
    return inputs.error();
  }
  const Result<ExactCache> cache = openCache(options);
  if (!cache) {
    return cache.error();
  }
  if (!cache->folder().empty()) {
    keepWhenTold("no results were written; exact visibility is kept in " + cache->folder());
  }
  if (const Status made = options.folder.empty() ? Status(Success{}) : makeFolder(options.folder); !made) {
    return made.error();
  }
  SceneBench bench(distinctSettings(*chosen), options.measured, *cache, options.threads);
  std::vector<BenchRecord> records;
  for (std::size_t i = 0; i < inputs->size(); ++i) {
    records.push_back(bench.measure(options.scenes[i], (*inputs)[i]));
    (*inputs)[i].data = {};  // its memory is of use to the next scene
  }
  return writeResults(options, records);
}

// Unless told otherwise, all methods that need no baked file, with few, some and many occluders.
void setUsualMethods(MethodOptions& options) {
  std::string methods;
  for (const Method& method : allMethods()) {
    if (method.traits.sets != SetUse::kAlways) {
      methods += (methods.empty() ? "" : ",") + std::string(method.name);
    }
  }
  options.setDefault("method", methods);
  options.setDefault("occluder-count", "16,64,256");
}

void addBenchOptions(CLI::App& command, BenchOptions& options) {
  command
      .add_option(
          "SCENE", options.scenes,
          "a file (.glb .gltf .obj .ply .stl ...) or demo:NAME?key=value&...; several: one after the other")
      ->required()
      ->type_name(kFileType)
      ->check(isNotEmpty());
  addOutputOptions(command, options.output);
  command
      .add_option("--csv", options.csv,
                  "write a row for each scene and setting to this file; - is standard output")
      ->type_name(kFileType);
  command
      .add_option("-o,--output", options.folder,
                  "folder of the report index.html, with bench.json and bench.csv; made if needed")
      ->type_name(kFolderType)
      ->check(isNotEmpty());
  addThreadsOption(command, options.threads);
  command.get_option("--threads")
      ->description("threads to prepare and to find exact visibility; culling has one");
  addPathOptions(command, options.path);
  setUsualMethods(options.method);
  addMethodOptions(command, options.method, true);
  command
      .add_option("--repeats", options.measured.rounds,
                  "rounds along the path, after a first one that is not measured")
      ->check(CLI::Range(1u, 10000u))
      ->capture_default_str();
  command.add_flag("--draw", options.measured.draw, "measure drawing as well, with headless OpenGL");
  addPictureOptions(command, options.measured.picture);
  command
      .add_option("--proof-steps", options.measured.steps,
                  "steps after which an object that is neither seen nor proved hidden is left undecided")
      ->check(CLI::Range(0u, 1000000000u))
      ->capture_default_str();
  command
      .add_option("--cache", options.cache,
                  "folder in which exact visibility is kept for later runs; made if needed (default: "
                  "$XDG_CACHE_HOME/sightline or ~/.cache/sightline)")
      ->type_name(kFolderType)
      ->check(isNotEmpty());
  command.add_flag("--no-cache", options.no_cache, "neither read nor keep exact visibility")
      ->excludes(command.get_option("--cache"));
}

}  // namespace

void addBench(CLI::App& app, Command& chosen) {
  CLI::App* command = app.add_subcommand(
      "bench", "measures methods side by side and says which one to use: time, tightness, memory");
  const auto options = std::make_shared<BenchOptions>();
  addBenchOptions(*command, *options);
  command->footer(
      "All settings cull each frame one after the other, in an order that changes, on one core; view-frustum "
      "culling is always among them. Exit code 1 when a setting that is not approximate culled a visible "
      "object.\n"
      "kept/exact: objects kept for each exactly visible one, over all frames. boxes: the least that any "
      "test "
      "of one bounding box an object must keep, for each exactly visible object. /frustum: mean time divided "
      "by that of view-frustum culling. cpu: mean processor time of the thread, which other programs do not "
      "disturb. front: no other setting takes less of it and keeps no more. answers: hash of the objects "
      "kept, the same on every machine.\n"
      "Examples:\n"
      "  sightline bench demo:city\n"
      "  sightline bench demo:city demo:building --method occlusion-tree,depth-pyramid --occluder-count "
      "16,64,256 -o report\n"
      "  sightline bench city.glb --path walk.json --draw --csv city.csv\n"
      "  sightline bench demo:ship --baked ship.sight --method visibility-octree,depth-pyramid "
      "--visible-sets on,off\n"
      "  sightline bench demo:building --occluders area-angle,database --frames 0:400:10 --repeats 9 --json "
      "-");
  command->callback([options, command, &chosen] {
    options->command_line = commandLine(*command);
    chosen = [options] { return runBench(*options); };
  });
}

}  // namespace sightline::tool
