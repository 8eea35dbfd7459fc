#include "tools/sightline/reproduce/paper_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "sightline/io/file.h"
#include "tools/sightline/command_line/json_output.h"
#include "tools/sightline/command_line/output_files.h"
#include "tools/sightline/reproduce/paper_page.h"

namespace sightline::tool {
namespace {

// Makes a folder's name of a scene's name.
std::string folderName(const std::string& scene) {
  std::string name;
  for (const char c : std::filesystem::path(scene).filename().string()) {
    name += std::isalnum(static_cast<unsigned char>(c)) ? c : '-';
  }
  return name;
}

// The folder of the report for scene i, or for the paper if it makes its own scenes.
std::string reportFolder(const ReproduceOptions& options, std::size_t i) {
  const std::string& name = options.scenes.empty() ? options.paper : options.scenes[i];
  return fmt::format("{}-{}", i + 1, folderName(name));
}

CommandFiles filesOf(const ReproduceOptions& options) {
  CommandFiles files{.scenes = options.scenes,
                     .outputs = {{"--json", options.output.json}},
                     .folder = {"--output", options.folder, {kPage, kTables, kJson}}};
  for (const std::string& scene : options.scenes) {
    for (const NamedFile& input : walkInputs(scene, options.path)) {
      files.inputs.push_back(input);
    }
  }
  for (std::size_t i = 0; i < std::max<std::size_t>(options.scenes.size(), 1); ++i) {
    files.folder.files.push_back(reportFolder(options, i) + "/index.html");
  }
  return files;
}

std::string csvFile(const Experiment& experiment) {
  return experiment.key + ".csv";
}

Status writeReports(const ReproduceOptions& options, const Reproduction& result) {
  for (std::size_t i = 0; i < result.reports.size(); ++i) {
    const std::string folder = options.folder + "/" + reportFolder(options, i);
    if (const Status made = makeFolder(folder); !made) {
      return made;
    }
    if (const Status written = writeReport(result.reports[i], folder); !written) {
      return written;
    }
  }
  for (const ReportFile& file : result.files) {
    const std::string path = options.folder + "/" + reportFolder(options, file.report) + "/" + file.name;
    if (const Status ok = file.text.empty() ? writePng(file.picture, path) : writeFile(path, file.text);
        !ok) {
      return ok;
    }
  }
  return Success{};
}

Status writeTables(const ReproduceOptions& options, const Reproduction& result) {
  for (const Experiment& experiment : result.experiments) {
    if (const Status written = writeFile(options.folder + "/" + csvFile(experiment), toCsv(experiment));
        !written) {
      return written;
    }
  }
  return Success{};
}

}  // namespace

std::string measuredBy(const ReproduceOptions& options) {
  std::string text = "reproduce " + options.paper;
  for (const std::string& scene : options.scenes) {
    text += " --scene " + scene;
  }
  const auto add = [&text](const char* option, const std::string& value) {
    text += value.empty() || value == "0" ? "" : fmt::format(" {} {}", option, value);
  };
  add("--path", options.path.path);
  add("--frames", options.path.frames);
  add("--width", std::to_string(options.picture.width));
  add("--height", std::to_string(options.picture.height));
  add("--depth", std::to_string(options.depth));
  add("--triangle-budget", std::to_string(options.triangle_budget));
  return text + (options.fewer_frames ? " --short" : "");
}

std::string paperText(const Paper& paper, const Reproduction& result) {
  std::string text = std::string(paper.title) + "\n";
  for (const Experiment& experiment : result.experiments) {
    text += "\n" + toText(experiment);
  }
  text += result.findings.empty() ? "" : "\nThe paper's statements\n";
  for (const Finding& finding : result.findings) {
    text += toText(finding);
  }
  for (const std::string& note : result.notes) {
    text += "\n" + note + "\n";
  }
  return text;
}

std::string paperJson(const ReproduceOptions& options, const Paper& paper, const Reproduction& result) {
  Json experiments;
  for (const Experiment& experiment : result.experiments) {
    experiments[experiment.key] = toJson(experiment);
  }
  Json findings = Json::array();
  for (const Finding& finding : result.findings) {
    findings.push_back(toJson(finding));
  }
  return dump({{"paper", options.paper},
               {"title", paper.title},
               {"measured_by", measuredBy(options)},
               {"version", SIGHTLINE_VERSION},
               {"scenes", options.scenes},
               {"experiments", experiments},
               {"findings", findings},
               {"notes", result.notes}});
}

Status checkFilesOf(const ReproduceOptions& options) {
  return checkFiles(filesOf(options));
}

Status writeFolder(const ReproduceOptions& options, const Paper& paper, const Reproduction& result) {
  CommandFiles files = filesOf(options);
  for (const Experiment& experiment : result.experiments) {
    files.folder.files.push_back(csvFile(experiment));
  }
  if (const Status ok = checkFiles(files); !ok) {
    return ok;
  }
  if (const Status written = writeReports(options, result); !written) {
    return written;
  }
  if (const Status written = writeTables(options, result); !written) {
    return written;
  }
  std::vector<PageLink> links;
  for (std::size_t i = 0; i < result.reports.size(); ++i) {
    links.push_back({result.reports[i].title, reportFolder(options, i) + "/index.html"});
  }
  const std::string page = paperPage(paper.title, options.command_line, links, result);
  if (const Status written = writeFile(options.folder + "/" + kPage, page); !written) {
    return written;
  }
  const Status tables = writeFile(options.folder + "/" + kTables, paperText(paper, result));
  return tables ? writeOutput(options.folder + "/" + kJson, paperJson(options, paper, result)) : tables;
}

}  // namespace sightline::tool
