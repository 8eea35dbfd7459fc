#include <fmt/format.h>

#include <filesystem>

#include "sightline/io/file.h"
#include "tools/sightline/command_line/json_output.h"
#include "tools/sightline/command_line/output_files.h"
#include "tools/sightline/command_line/signals.h"
#include "tools/sightline/reproduce/paper_files.h"
#include "tools/sightline/reproduce/paper_page.h"
#include "tools/sightline/reproduce/paper_run.h"

namespace sightline::tool {
namespace {

// The options of one paper: what means nothing for it is left out.
ReproduceOptions optionsFor(const std::string& name, const Paper& paper, const ReproduceOptions& all) {
  ReproduceOptions options = all;
  options.paper = name;
  options.folder = all.folder + "/" + name;
  options.output.json.clear();
  if (paper.makesItsScenes()) {
    options.scenes.clear();
    options.path = {};
    options.picture.width = 0;
    options.threads = 1;
  }
  if (!paper.bakes) {
    options.depth = 0;
    options.triangle_budget = 0;
  }
  options.command_line = fmt::format("sightline {} -o {}", measuredBy(options), options.folder);
  return options;
}

// The paper's reproduce.json; null if it is not there, or was measured with other options or by another
// version.
Json finished(ReproduceOptions options, const Paper& paper) {
  options.scenes = std::vector(paper.scenesFor(options));
  const Result<std::string> text = readFile(options.folder + "/" + kJson);
  Json json = text ? Json::parse(*text, nullptr, false) : Json();
  const bool same = json.is_object() && json.value("version", "") == SIGHTLINE_VERSION &&
                    json.value("measured_by", "") == measuredBy(options) && json.contains("experiments") &&
                    json.contains("findings") && json.contains("notes");
  return same ? json : Json();
}

PaperSummary summaryOf(const std::string& name, const Json& json) {
  PaperSummary summary{{json.value("title", name), name + "/" + kPage}, json.value("measured_by", "")};
  for (const auto& [key, experiment] : json["experiments"].items()) {
    summary.tables.push_back(experiment.value("title", key));
  }
  for (const Json& finding : json["findings"]) {
    summary.findings.push_back(
        {finding.value("claim", ""), finding.value("agrees", false), finding.value("text", "")});
  }
  for (const Json& note : json["notes"]) {
    summary.notes.push_back(note.is_string() ? note.get<std::string>() : note.dump());
  }
  return summary;
}

}  // namespace

Result<ExitCode> runAllPapers(const ReproduceOptions& options) {
  if (options.folder.empty()) {
    return Error{"reproduce all: -o DIR says where the reports go; give it"};
  }
  const CommandFiles files{.scenes = options.scenes,
                           .outputs = {{"--json", options.output.json}},
                           .folder = {"--output", options.folder, {kPage}}};
  if (const Status ok = checkFiles(files); !ok) {
    return ok.error();
  }
  keepWhenTold("the papers that are finished are kept in " + options.folder +
               "; the same command goes on with the others");
  std::vector<PaperSummary> summaries;
  Json all = Json::array();
  for (const auto& [name, paper] : papers()) {
    const ReproduceOptions own = optionsFor(name, paper, options);
    Json json = finished(own, paper);
    if (json.is_null()) {
      if (const Result<ExitCode> ran = runPaper(own); !ran) {
        return Error{fmt::format("{}: {}", name, ran.error().message)};
      }
      json = finished(own, paper);
    } else if (options.output.textOnStdout()) {
      fmt::print("{}: finished before, in {}\n", name, own.folder);
    }
    if (options.output.textOnStdout()) {
      fmt::print("\n");
    }
    summaries.push_back(summaryOf(name, json));
    all.push_back(std::move(json));
  }
  const SignalGuard guard;  // writes all files or none
  if (const Status written =
          writeFile(options.folder + "/" + kPage, papersPage(options.command_line, summaries));
      !written) {
    return written.error();
  }
  if (const Status written = writeOutput(options.output.json, dump({{"paper", kAllPapers}, {"papers", all}}));
      !written) {
    return written.error();
  }
  return kOk;
}

}  // namespace sightline::tool
