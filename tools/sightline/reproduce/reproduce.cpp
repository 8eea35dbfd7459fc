// sightline reproduce: repeats the experiments of a paper on the scenes of today.

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <memory>

#include "sightline/io/file.h"
#include "sightline/pvs/format/visibility_octree.h"
#include "tools/sightline/command_line/command_line.h"
#include "tools/sightline/command_line/json_output.h"
#include "tools/sightline/command_line/names.h"
#include "tools/sightline/command_line/output_files.h"
#include "tools/sightline/command_line/signals.h"
#include "tools/sightline/commands.h"
#include "tools/sightline/reproduce/papers.h"

namespace sightline::tool {
namespace {

// Files in the output folder.
constexpr const char *kTables = "tables.txt", *kJson = "reproduce.json";

struct Paper {
  const char* title;
  std::vector<std::string> scenes;  // unless the user names others; empty if the paper makes its own
  Result<Reproduction> (*reproduce)(const ReproduceOptions&, const std::vector<SceneAndWalk>&);
  bool bakes = false;
  std::vector<std::string> short_scenes{};  // the scenes with --short; empty: the same
};

// The papers by their names on the command line. Each has its function in papers.h.
const std::vector<std::pair<std::string, Paper>>& papers() {
  static const std::vector<std::pair<std::string, Paper>> kPapers{
      {"coorg-teller",
       {"Coorg, Teller. Real-Time Occlusion Culling for Models with Large Occluders. I3D 1997.",
        {"demo:building?plants=100", "demo:city"},
        reproduceCoorgTeller}},
      {"poon-wang",
       {"Poon, Wang. Occlusion Culling Using Minimum Occluder Set and Opacity Map. IV 1999.",
        {"demo:city"},
        reproducePoonWang}},
      {"saona-vazquez",
       {"Saona-Vazquez, Navazo, Brunet. The Visibility Octree: A Data Structure for 3D Navigation. "
        "Computers & Graphics 1999.",
        {"demo:ship"},
        reproduceSaonaVazquez,
        true,
        {"demo:ship?decks=3&rooms=4&machinery=8"}}},
      {"snyder-lengyel",
       {"Snyder, Lengyel. Visibility Sorting and Compositing for Image-Based Rendering. MSR-TR-97-11, 1997.",
        {},
        reproduceSnyderLengyel}},
  };
  return kPapers;
}

std::vector<std::string> paperNames() {
  std::vector<std::string> names;
  for (const auto& [name, paper] : papers()) {
    names.push_back(name);
  }
  return names;
}

// Precondition: name is one of paperNames().
const Paper& findPaper(const std::string& name) {
  return std::ranges::find(papers(), name, &std::pair<std::string, Paper>::first)->second;
}

// Loads all scenes before the work starts, so that errors show early.
Result<std::vector<SceneAndWalk>> loadAll(const ReproduceOptions& options) {
  std::vector<SceneAndWalk> inputs;
  for (const std::string& scene : options.scenes) {
    Result<SceneAndWalk> input = loadSceneAndWalk(scene, options.path);
    if (!input) {
      return input.error();
    }
    input->walk.frames = fewerFrames(options, input->walk.frames);
    inputs.push_back(std::move(*input));
  }
  return inputs;
}

std::string toJson(const ReproduceOptions& options, const Paper& paper, const Reproduction& result) {
  Json experiments;
  for (const Experiment& experiment : result.experiments) {
    experiments[experiment.key] = toJson(experiment);
  }
  return dump({{"paper", options.paper},
               {"title", paper.title},
               {"scenes", options.scenes},
               {"experiments", experiments},
               {"notes", result.notes}});
}

std::string toText(const Paper& paper, const Reproduction& result) {
  std::string text = std::string(paper.title) + "\n";
  for (const Experiment& experiment : result.experiments) {
    text += "\n" + toText(experiment);
  }
  for (const std::string& note : result.notes) {
    text += "\n" + note + "\n";
  }
  return text;
}

// Makes a folder's name of a scene's name.
std::string folderName(const std::string& scene) {
  std::string name;
  for (const char c : std::filesystem::path(scene).filename().string()) {
    name += std::isalnum(static_cast<unsigned char>(c)) ? c : '-';
  }
  return name;
}

Status writeFiles(const std::vector<ReportFile>& files, const std::string& folder) {
  for (const ReportFile& file : files) {
    const std::string path = folder + "/" + file.name;
    if (const Status ok = file.text.empty() ? writePng(file.picture, path) : writeFile(path, file.text);
        !ok) {
      return ok;
    }
  }
  return Success{};
}

// The folder of the report for scene i, or for the paper if it makes its own scenes.
std::string reportFolder(const ReproduceOptions& options, std::size_t i) {
  const std::string& name = options.scenes.empty() ? options.paper : options.scenes[i];
  return fmt::format("{}-{}", i + 1, folderName(name));
}

Status checkFilesOf(const ReproduceOptions& options) {
  CommandFiles files{.scenes = options.scenes,
                     .outputs = {{"--json", options.output.json}},
                     .folder = {"--output", options.folder, {kTables, kJson}}};
  for (const std::string& scene : options.scenes) {
    for (const NamedFile& input : walkInputs(scene, options.path)) {
      files.inputs.push_back(input);
    }
  }
  for (std::size_t i = 0; i < std::max<std::size_t>(options.scenes.size(), 1); ++i) {
    files.folder.files.push_back(reportFolder(options, i) + "/index.html");
  }
  return checkFiles(files);
}

Status writeFolder(const ReproduceOptions& options, const std::string& text, const std::string& json,
                   const Reproduction& result) {
  for (std::size_t i = 0; i < result.reports.size(); ++i) {
    const std::string folder = options.folder + "/" + reportFolder(options, i);
    if (const Status made = makeFolder(folder); !made) {
      return made;
    }
    if (const Status written = writeReport(result.reports[i], folder); !written) {
      return written;
    }
    if (const Status written = i == 0 ? writeFiles(result.files, folder) : Success{}; !written) {
      return written;
    }
  }
  const Status tables = writeFile(options.folder + "/" + kTables, text);
  return tables ? writeOutput(options.folder + "/" + kJson, json) : tables;
}

Result<ExitCode> writeResult(const ReproduceOptions& options, const Paper& paper,
                             const Reproduction& result) {
  const SignalGuard guard;  // writes all files or none
  const std::string text = toText(paper, result), json = toJson(options, paper, result);
  if (const Status written = writeOutput(options.output.json, json); !written) {
    return written.error();
  }
  if (!options.folder.empty()) {
    if (const Status written = writeFolder(options, text, json, result); !written) {
      return written.error();
    }
  }
  if (options.output.textOnStdout()) {
    fmt::print("{}", text);
  }
  return kOk;
}

Result<ExitCode> runReproduce(ReproduceOptions options) {
  const Paper& paper = findPaper(options.paper);
  if (!paper.bakes && (options.depth > 0 || options.triangle_budget > 0)) {
    return Error{
        fmt::format("--depth and --triangle-budget: {} bakes nothing; leave them out", options.paper)};
  }
  const bool nothing_chosen = options.scenes.empty() && options.path.path.empty() &&
                              options.path.frames.empty() && options.picture.width == 0;
  if (paper.scenes.empty() && !nothing_chosen) {
    return Error{
        fmt::format("--scene, --path, --frames and --width: {} makes its own scenes and pictures; leave "
                    "them out",
                    options.paper)};
  }
  if (paper.scenes.empty() && options.threads > 1) {
    return Error{
        fmt::format("--threads {}: {} works with one thread; leave it out", options.threads, options.paper)};
  }
  if (options.scenes.empty()) {
    options.scenes = options.fewer_frames && !paper.short_scenes.empty() ? paper.short_scenes : paper.scenes;
  }
  if (const Status ok = checkFilesOf(options); !ok) {
    return ok.error();
  }
  const Result<std::vector<SceneAndWalk>> inputs = loadAll(options);
  if (!inputs) {
    return inputs.error();
  }
  if (!options.folder.empty()) {
    if (const Status made = makeFolder(options.folder); !made) {
      return made.error();
    }
  }
  const Result<Reproduction> result = paper.reproduce(options, *inputs);
  return result ? writeResult(options, paper, *result) : result.error();
}

}  // namespace

void addReproduce(CLI::App& app, Command& chosen) {
  CLI::App* command = app.add_subcommand("reproduce", "a paper's experiments, on the scenes of today");
  const auto options = std::make_shared<ReproduceOptions>();
  command->add_option("PAPER", options->paper, "the paper, by its authors")
      ->required()
      ->check(isOneOf(paperNames()));
  command
      ->add_option("--scene", options->scenes,
                   "a file or demo:NAME?key=value&...; several: once for each (default: the paper's)")
      ->type_name(kFileType)
      ->allow_extra_args(false);
  addOutputOptions(*command, options->output);
  addThreadsOption(*command, options->threads);
  addPathOptions(*command, options->path);
  addPictureOptions(*command, options->picture);
  for (const char* side : {"width", "height"}) {
    command->get_option(std::string("--") + side)
        ->description(fmt::format("{} of the pictures, pixels (default: the paper's or the path's)", side));
  }
  command->add_flag(
      "--short", options->fewer_frames,
      "few frames, unless --frames says which; experiments on stretches of the path have their own; of "
      "snyder-lengyel small pictures too, unless --height is given; of saona-vazquez a small ship and depth "
      "4 as well, unless --scene and --depth say others");
  command->add_option("--depth", options->depth, "saona-vazquez: of the octree (default: 6)")
      ->check(CLI::Range(1u, kMaxOctreeDepth));
  command
      ->add_option("--triangle-budget", options->triangle_budget,
                   "saona-vazquez: of a leaf (default: that of `sightline bake`)")
      ->check(CLI::Range(std::uint64_t{1}, std::numeric_limits<std::uint64_t>::max() / 2));
  command
      ->add_option("-o,--output", options->folder,
                   "folder of the tables and a report for each scene; made if needed")
      ->type_name(kFolderType);
  command->footer(
      "poon-wang has routes of its own where the scene has walks best, average and worst, saona-vazquez "
      "where it has walk and random; --path takes the place of them.\n"
      "Examples:\n"
      "  sightline reproduce coorg-teller\n"
      "  sightline reproduce poon-wang -o report\n"
      "  sightline reproduce saona-vazquez --threads 8 -o report\n"
      "  sightline reproduce snyder-lengyel -o report\n"
      "  sightline reproduce coorg-teller --short --scene \"demo:city?copies=4\" --json tables.json\n"
      "  sightline reproduce coorg-teller --scene office.glb --path walk.json -o report");
  command->callback([options, command, &chosen] {
    options->command_line = commandLine(*command);
    chosen = [options] { return runReproduce(*options); };
  });
}

}  // namespace sightline::tool
