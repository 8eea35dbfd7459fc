// sightline walk: culls and draws every frame of a walk with each setting, compares the pictures, writes the
// report.

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "sightline/io/file.h"
#include "sightline/render/compare.h"
#include "sightline/render/renderer.h"
#include "tools/sightline/command_line/command_line.h"
#include "tools/sightline/command_line/json_output.h"
#include "tools/sightline/command_line/note.h"
#include "tools/sightline/command_line/progress_bar.h"
#include "tools/sightline/command_line/signals.h"
#include "tools/sightline/command_line/threads.h"
#include "tools/sightline/commands.h"
#include "tools/sightline/input/scene_facts.h"
#include "tools/sightline/methods/baseline.h"
#include "tools/sightline/report/plot.h"
#include "tools/sightline/walk/walk_pictures.h"
#include "tools/sightline/walk/walk_report.h"
#include "tools/sightline/walk/walk_runs.h"

namespace sightline::tool {
namespace {

// The baseline is compared with all objects drawn after so many frames each.
constexpr std::size_t kEverythingEvery = 10;

// Files in the report's folder, beside the pictures of frames.
constexpr const char* kJsonFile = "walk.json";

// The names of the files in the report's folder. frames are those that get pictures, if they are known
// already; each run may add one picture for each frame that differs.
std::vector<std::string> filesOfFolder(std::span<const std::uint32_t> frames = {}, std::size_t runs = 0) {
  std::vector<std::string> files(kPlotFiles.begin(), kPlotFiles.end());
  files.insert(files.end(), {"index.html", kJsonFile});
  for (const std::uint32_t frame : frames) {
    for (const char* picture : {"frame", "coverage", "plan"}) {
      files.push_back(fmt::format("{}_{:04}.png", picture, frame));
    }
    for (std::size_t run = 0; run < runs; ++run) {
      files.push_back(fmt::format("differs_{}_{:04}.png", run, frame));
    }
  }
  return files;
}

struct WalkOptions {
  CommonOptions common;
  PathOptions path;
  MethodOptions method;
  std::string folder;
  PictureOptions picture;
  bool no_pictures = false;  // draw nothing, without OpenGL
  bool measure_renderer = false;
  std::string command_line;
};

// renderer: null draws and compares nothing. measured: is told what drawing takes.
class Walker {
 public:
  Walker(const Scene& scene, const Walk& walk, CullingData& data, Renderer* renderer,
         const std::string& folder, std::vector<WalkRun> runs, MeasuredRenderer& measured)
      : scene_(scene),
        walk_(walk),
        data_(data),
        renderer_(renderer),
        folder_(folder),
        measured_(measured),
        chooser_(walk.frames) {
    record_.runs = std::move(runs);
    for (std::uint32_t o = 0; o < scene.objects.size(); ++o) {
      everything_.push_back(ObjectId(o));
    }
  }

  // Walks all frames. If the process is told to end, stops after the current frame.
  Result<WalkRecord> run() {
    record_.shown = record_.runs.size() > 1 ? 1 : 0;
    record_.device = renderer_ != nullptr ? renderer_->device() : "";
    images_.resize(record_.runs.size());
    ProgressBar progress("walking");
    for (std::size_t i = 0; i < walk_.frames.size(); ++i) {
      if (const Status drawn = step(i); !drawn) {
        return drawn.error();
      }
      progress.update(static_cast<double>(i + 1) / static_cast<double>(walk_.frames.size()));
      if (toldToEnd() != 0) {
        break;
      }
    }
    record_.pictures = chooser_.chosen();
    return std::move(record_);
  }

 private:
  Status step(std::size_t i) {
    const std::uint32_t frame = walk_.frames[i];
    const View view = walk_.view(frame, scene_);
    cullFrame(record_.runs, data_, frame, view);
    chooser_.offer(keptFrame(record_, data_, frame, view));
    return renderer_ != nullptr ? drawAndCompare(i, view) : Status(Success{});
  }

  Status drawAndCompare(std::size_t i, const View& view) {
    drawFrame(record_.runs, view, *renderer_, &images_, &measured_);
    if (i % kEverythingEvery == 0) {
      if (const Status drawn = compare(renderer_->draw(view, everything_), everything_, 0, view); !drawn) {
        return drawn;
      }
    }
    for (std::size_t r = 1; r < images_.size(); ++r) {
      if (const Status drawn = compare(images_[0], record_.baseline().run.culler.visible(), r, view);
          !drawn) {
        return drawn;
      }
    }
    return Success{};
  }

  // Compares the picture of run r with the reference, the picture of reference_objects.
  Status compare(const Image& reference, std::span<const ObjectId> reference_objects, std::size_t r,
                 const View& view) {
    const ImageDifference difference = compareImages(reference, images_[r]);
    if (difference.equal()) {
      return Success{};
    }
    WalkRun& run = record_.runs[r];
    const std::uint32_t frame = run.frames.back().frame;
    const std::span<const ObjectId> kept = run.run.culler.visible();
    const std::vector<ObjectId> culled = culledOf(reference_objects, kept);
    if (!culled.empty() && renderer_->countShowing(view, kept, culled) == 0) {
      run.frames.back().tie = true;
      return Success{};
    }
    const bool first = run.differingFrames().empty();
    run.frames.back().differs = true;
    if (!first) {
      return Success{};
    }
    const std::string file = fmt::format("differs_{}_{:04}.png", r, frame);
    const std::string caption =
        fmt::format("DIFFERS: {} ({}), {} pixels, the first at {}, {}", methodName(run.setting),
                    optionsText(run.setting), difference.pixels, difference.x, difference.y);
    record_.changed.push_back({frame, file, caption});
    return writePng(sideBySide(images_[r], differenceImage(reference, images_[r])), folder_ + "/" + file);
  }

  std::vector<ObjectId> culledOf(std::span<const ObjectId> objects, std::span<const ObjectId> kept) const {
    std::vector<bool> is_kept(scene_.objects.size(), false);
    for (const ObjectId object : kept) {
      is_kept[object.value] = true;
    }
    std::vector<ObjectId> culled;
    for (const ObjectId object : objects) {
      if (!is_kept[object.value]) {
        culled.push_back(object);
      }
    }
    return culled;
  }

  const Scene& scene_;
  const Walk& walk_;
  CullingData& data_;
  Renderer* renderer_;
  const std::string& folder_;
  MeasuredRenderer& measured_;
  std::vector<ObjectId> everything_;
  PictureChooser chooser_;
  WalkRecord record_;
  std::vector<Image> images_;  // the current frame's picture of each run
};

Status writePlots(const std::vector<WalkPlot>& plots, const std::string& folder) {
  for (const WalkPlot& made : plots) {
    if (const Status ok = writeFile(folder + "/" + made.file, toSvg(made.plot)); !ok) {
      return ok;
    }
  }
  return Success{};
}

Status writeAll(const WalkOptions& options, const WalkInput& input, const WalkRecord& record,
                Renderer* renderer) {
  Result<std::vector<ReportPicture>> pictures =
      drawPictures(record, input.scene, input.data.occluders(), renderer,
                   [&](const Image& image, const std::string& file) {
                     return writePng(image, options.folder + "/" + file);
                   });
  if (!pictures) {
    return pictures.error();
  }
  Report report = walkReport(input, record, std::move(*pictures));
  report.command = options.command_line;
  const std::string json = walkJson(input, record);
  for (const Status& status : {writePlots(walkPlots(record, input.walk), options.folder),
                               writeOutput(options.folder + "/" + kJsonFile, json),
                               writeReport(report, options.folder), writeOutput(options.common.json, json)}) {
    if (!status) {
      return status;
    }
  }
  return Success{};
}

Result<ExitCode> walkScene(const WalkOptions& options, std::vector<Setting> settings,
                           const SceneAndWalk& input) {
  const Scene& scene = input.scene;
  const Walk& walk = input.walk;
  const auto [width, height] = pictureSize(options.picture, walk.path);
  std::optional<Renderer> renderer;
  if (!options.no_pictures) {
    Result<Renderer> created = Renderer::create(input.given(), width, height);
    if (!created) {
      return Error{created.error().message + "; --no-pictures walks without it"};
    }
    renderer.emplace(std::move(*created));
  }
  if (const Status made = makeFolder(options.folder); !made) {
    return made.error();
  }
  const Threads threads(options.common.threads);
  CullingData data(input, threads.parallelFor());
  Renderer* const drawing = renderer ? &*renderer : nullptr;
  MeasuredRenderer measured;
  for (Setting& setting : settings) {
    setting.opacity_map.renderer = options.measure_renderer ? &measured : nullptr;
  }
  Walker walker(scene, walk, data, drawing, options.folder, makeRuns(settings, data), measured);
  const SignalGuard guard;  // if told to end, the walker stops early and its results are still written
  Result<WalkRecord> record = walker.run();
  if (!record) {
    return record.error();
  }
  const std::size_t done = record->baseline().frames.size();
  const bool interrupted = done < walk.frames.size();
  data.noteUnknownSets();
  record->width = width;
  record->height = height;
  const std::string name = options.common.scene + crackText(input.closing.note());
  const WalkInput walked{name, scene, walk, data, input.closing};
  if (const Status written = writeAll(options, walked, *record, drawing); !written) {
    return written.error();
  }
  if (!interrupted) {
    data.keepPrepared();  // the report shows all potential occluders
  }
  if (options.common.textOnStdout()) {
    if (input.closing.width > 0.0) {
      fmt::print("{}:\n", name);
    }
    printWalk(*record);
    fmt::print("report: {}\n", (std::filesystem::path(options.folder) / "index.html").string());
  }
  if (interrupted) {
    printNote("walk was interrupted after {} of {} frames; the report in {} is of these", done,
              walk.frames.size(), options.folder);
    return static_cast<ExitCode>(interruptedExitCode());
  }
  return record->differing() == 0 ? kOk : kCheckFailed;
}

Status checkFilesOf(const WalkOptions& options, const std::vector<std::string>& in_folder) {
  return checkFiles({.scenes = {options.common.scene},
                     .inputs = walkInputs(options.common.scene, options.path, options.method.baked),
                     .outputs = {{"--json", options.common.json}, {"--prepared", options.method.prepared}},
                     .folder = {"--output", options.folder, in_folder}});
}

Status checkMeasuring(const WalkOptions& options, const std::vector<Setting>& settings) {
  if (!options.measure_renderer) {
    return Success{};
  }
  if (options.no_pictures) {
    return Error{"--measure-renderer: --no-pictures draws nothing; give --triangle-us in its place"};
  }
  const auto adapts = [](const Setting& setting) { return setting.method->name == "opacity-map"; };
  return std::ranges::any_of(settings, adapts)
             ? Status(Success{})
             : Error{"--measure-renderer: only opacity-map uses it; add --method opacity-map"};
}

Result<ExitCode> runWalk(const WalkOptions& options) {
  const Result<std::vector<Setting>> checked = settingsOf(options.method);
  if (!checked) {
    return checked.error();
  }
  if (const Status ok = checkMeasuring(options, *checked); !ok) {
    return ok.error();
  }
  if (const Status ok = checkFilesOf(options, filesOfFolder()); !ok) {
    return ok.error();
  }
  const Result<SceneAndWalk> input = loadSceneAndWalk(options.common.scene, options.path, options.method);
  if (!input) {
    return input.error();
  }
  const Result<std::vector<Setting>> settings = settingsFor(options.method, *checked, *input);
  if (!settings) {
    return settings.error();
  }
  if (const Status ok =
          checkFilesOf(options, filesOfFolder(input->walk.frames, withBaseline(*settings).size()));
      !ok) {
    return ok.error();
  }
  return walkScene(options, withBaseline(*settings), *input);
}

}  // namespace

void addWalk(CLI::App& app, Command& chosen) {
  CLI::App* command = app.add_subcommand(
      "walk",
      "walks a path with each method, measures, compares all pictures, writes the report DIR/index.html");
  const auto options = std::make_shared<WalkOptions>();
  addCommonOptions(*command, options->common);
  addPathOptions(*command, options->path);
  addMethodOptions(*command, options->method, true);
  command->add_option("-o,--output", options->folder, "folder of the report; made if needed")
      ->required()
      ->type_name(kFolderType)
      ->check(isNotEmpty());
  addPictureOptions(*command, options->picture);
  command->add_flag(
      "--no-pictures", options->no_pictures,
      "draw and compare nothing, so that no OpenGL is needed; of the pictures, only coverage maps "
      "are written");
  command->add_flag(
      "--measure-renderer", options->measure_renderer,
      "opacity-map: the coverage ratio follows what drawing is measured to take for a triangle, "
      "in place of --triangle-us, so that runs differ");
  command->footer(
      "View-frustum culling is always walked too, for comparison. Exit code 1 when culling changed any "
      "picture, "
      "ties of the depth buffer apart.\n"
      "With a method that has a depth buffer of occluders (opacity-map, depth-pyramid) as the first one, the "
      "report shows in some frames which of its pixels are covered, and how far away what covers them is.\n"
      "Interrupted (Ctrl-C), it writes the report of the frames walked so far and ends with exit code 130.\n"
      "Examples:\n"
      "  sightline walk demo:city -o report\n"
      "  sightline walk city.glb --method auto -o report\n"
      "  sightline walk city.glb --path walk.json --method occlusion-tree --variant FSE,FME --occluder-count "
      "8,16,32 -o report\n"
      "  sightline walk demo:city --method occlusion-tree,supporting-planes --hierarchy kd "
      "--occluders area-angle,database -o report\n"
      "  sightline walk demo:city --method opacity-map,depth-pyramid --occluders area-angle,minimum-sets -o "
      "report\n"
      "  sightline walk demo:ship --baked ship.sight --method visibility-octree,depth-pyramid --visible-sets "
      "on,off -o report\n"
      "  sightline walk demo:building --frames 0:400:4 --width 640 --height 360 -o report\n"
      "  sightline walk demo:terrain --method depth-pyramid --no-pictures -o report");
  command->callback([options, command, &chosen] {
    options->command_line = commandLine(*command);
    chosen = [options] { return runWalk(*options); };
  });
}

}  // namespace sightline::tool
