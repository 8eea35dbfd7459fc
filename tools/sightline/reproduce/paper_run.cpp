#include "tools/sightline/reproduce/paper_run.h"

#include <fmt/format.h>

#include "tools/sightline/command_line/json_output.h"
#include "tools/sightline/command_line/output_files.h"
#include "tools/sightline/command_line/signals.h"
#include "tools/sightline/reproduce/paper_files.h"

namespace sightline::tool {
namespace {

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

Status checkOptions(const ReproduceOptions& options, const Paper& paper) {
  if (!paper.bakes && (options.depth > 0 || options.triangle_budget > 0)) {
    return Error{
        fmt::format("--depth and --triangle-budget: {} bakes nothing; leave them out", options.paper)};
  }
  const bool nothing_chosen = options.scenes.empty() && options.path.path.empty() &&
                              options.path.frames.empty() && options.picture.width == 0;
  if (paper.makesItsScenes() && !nothing_chosen) {
    return Error{
        fmt::format("--scene, --path, --frames and --width: {} makes its own scenes and pictures; leave "
                    "them out",
                    options.paper)};
  }
  if (paper.makesItsScenes() && options.threads > 1) {
    return Error{
        fmt::format("--threads {}: {} works with one thread; leave it out", options.threads, options.paper)};
  }
  return Success{};
}

Result<ExitCode> writeResult(const ReproduceOptions& options, const Paper& paper,
                             const Reproduction& result) {
  const SignalGuard guard;  // writes all files or none
  if (const Status written = writeOutput(options.output.json, paperJson(options, paper, result)); !written) {
    return written.error();
  }
  if (!options.folder.empty()) {
    if (const Status written = writeFolder(options, paper, result); !written) {
      return written.error();
    }
  }
  if (options.output.textOnStdout()) {
    fmt::print("{}", paperText(paper, result));
  }
  return kOk;
}

}  // namespace

Result<ExitCode> runPaper(ReproduceOptions options) {
  const Paper& paper = findPaper(options.paper);
  if (const Status ok = checkOptions(options, paper); !ok) {
    return ok.error();
  }
  options.scenes = std::vector(paper.scenesFor(options));
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

}  // namespace sightline::tool
