// sightline bake: the visibility octree of a scene, and its occluder databases, as a file.

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <utility>

#include "sightline/io/file.h"
#include "src/base/stopwatch.h"
#include "tools/sightline/bake/bake_databases.h"
#include "tools/sightline/bake/bake_options.h"
#include "tools/sightline/bake/bake_report.h"
#include "tools/sightline/bake/bake_run.h"
#include "tools/sightline/bake/bake_warning.h"
#include "tools/sightline/command_line/json_output.h"
#include "tools/sightline/command_line/note.h"
#include "tools/sightline/command_line/output_files.h"
#include "tools/sightline/command_line/progress_bar.h"
#include "tools/sightline/command_line/signals.h"
#include "tools/sightline/command_line/threads.h"
#include "tools/sightline/commands.h"
#include "tools/sightline/cull/info_sight.h"
#include "tools/sightline/input/doors.h"
#include "tools/sightline/input/load.h"

namespace sightline::tool {
namespace {

// The plan of a bake and what it was made from; every process of the bake makes its own.
struct Planned {
  Scene scene;
  CrackNote cracks;
  ViewerSpace viewers;
  Bake bake;
  double load_us = 0.0, plan_us = 0.0;
  std::vector<Vec3d> viewpoints{};  // scene space: see DatabaseChoice::places
  std::optional<Bake::TakenOver> update{};
  bool without_doors = false;  // the baked file that is updated has doors, and none are given now
};

CheckpointUse useOf(const BakeOptions& options) {
  return options.resume    ? CheckpointUse::kResume
         : options.restart ? CheckpointUse::kRestart
                           : CheckpointUse::kNew;
}

// Whether the file is baked or empty: another bake can make such a file again.
bool mayBeReplaced(const std::string& file) {
  std::error_code error;
  return beginsAsSightFile(file) || (std::filesystem::file_size(file, error) == 0 && !error);
}

// The same for a file of answers.
bool mayBeReplacedByAnswers(const std::string& file) {
  std::array<char, 8> start{};
  std::ifstream stream(file, std::ios::binary);
  std::error_code error;
  return (stream.read(start.data(), start.size()) &&
          Bake::beginsAsAnswers(std::as_bytes(std::span(start)))) ||
         (std::filesystem::file_size(file, error) == 0 && !error);
}

// Error if something is there that the bake would write over, and it is not what a bake wrote.
Status mayWrite(const std::string& file, const char* kind, bool may_be_replaced, bool force) {
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) {
    return Success{};
  }
  if (!std::filesystem::is_regular_file(file, ignored)) {
    return Error{fmt::format("--output {}: is not a file; name another output", file)};
  }
  if (!force && !may_be_replaced) {
    return Error{
        fmt::format("--output {}: is there and is not {}; name another output, or give --force to write over "
                    "it",
                    file, kind)};
  }
  return Success{};
}

// Opens the output files before the work starts. Called by the process that writes them.
Result<Checkpoint> openOutputs(const BakeOptions& options) {
  if (options.output.empty() || options.output == "-") {
    return Error{"--output: give the name of a file, F.sight"};
  }
  std::vector<NamedFile> inputs = options.viewers.usesPath()
                                      ? walkInputs(options.common.scene, options.viewers.path)
                                      : std::vector<NamedFile>{};
  inputs.push_back({"--update", options.update});
  inputs.push_back({"--update, its answers,", options.answersBefore()});
  if (const Status ok = checkFiles({.scenes = {options.common.scene},
                                    .inputs = std::move(inputs),
                                    .outputs = {{"--output", options.output},
                                                {"--output, for its parts,", options.partsFile()},
                                                {"--output, for its answers,", options.answersFile()},
                                                {"--witnesses", options.witnesses},
                                                {"--json", options.common.json}}});
      !ok) {
    return ok.error();
  }
  Status free = mayWrite(options.output, "a baked file", mayBeReplaced(options.output), options.force);
  if (const std::string answers = options.answersFile(); free && !answers.empty()) {
    free = mayWrite(answers, "the answers of a bake", mayBeReplacedByAnswers(answers), options.force);
  }
  if (!free) {
    return free.error();
  }
  return Checkpoint::open(options.partsFile(), useOf(options));
}

// The answers that the update takes over.
Result<std::vector<std::byte>> loadAnswers(const BakeOptions& options) {
  const std::string file = options.answersBefore();
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) {
    return Error{
        fmt::format("--update {}: {} is not there, which --answers or --update would have written; "
                    "bake in full, without --update",
                    options.update, file)};
  }
  const Result<std::string> text = readFile(file);
  if (!text) {
    return text.error();
  }
  const std::span<const std::byte> read = std::as_bytes(std::span(*text));
  return std::vector<std::byte>(read.begin(), read.end());
}

// What an update goes on from.
struct Before {
  SightFile file;
  std::vector<std::byte> answers;
};

// The files that --update names; nothing without it.
Result<std::optional<Before>> openBefore(const BakeOptions& options) {
  if (options.update.empty()) {
    return std::optional<Before>();
  }
  Result<SightFile> file = SightFile::open(options.update);
  if (!file) {
    return file.error();
  }
  Result<std::vector<std::byte>> answers = loadAnswers(options);
  if (!answers) {
    return answers.error();
  }
  return std::optional(Before{std::move(*file), std::move(*answers)});
}

// Takes over the answers of the bake that wrote the file.
Result<Bake::TakenOver> takeOver(Before& before, const BakeOptions& options, Bake& bake) {
  Result<Bake::TakenOver> taken = bake.takeOver(std::move(before.answers));
  if (!taken) {
    return Error{fmt::format("{}: {}", options.answersBefore(), taken.error().message)};
  }
  if (taken->scene != before.file.scene()) {
    return Error{fmt::format("{}: is of another bake than {}; bake in full, without --update",
                             options.answersBefore(), options.update)};
  }
  return taken;
}

// The scene in which nothing is left of the doors: viewers walk through open ones.
Scene withoutDoors(const Scene& scene, std::span<const std::vector<ObjectId>> doors) {
  Scene without = scene;
  for (const std::vector<ObjectId>& group : doors) {
    for (const ObjectId door : group) {
      without.objects[door.value].index_count = 0;
    }
  }
  return without;
}

// The eyes of the camera path that databases of viewpoints follow; none if no path is given.
Result<std::vector<Vec3d>> viewpointsOf(const BakeOptions& options, const Scene& scene) {
  std::vector<Vec3d> eyes;
  if (options.viewpoint_path.empty()) {
    return eyes;
  }
  const Result<Walk> walk = loadWalk({.path = options.viewpoint_path}, options.common.scene, scene);
  if (!walk) {
    return walk.error();
  }
  for (const std::uint32_t frame : walk->frames) {
    eyes.push_back(walk->view(frame, scene).eye);
  }
  return eyes;
}

Result<Planned> planBake(const BakeOptions& options) {
  base::Stopwatch watch;
  Result<std::optional<Before>> before = openBefore(options);
  if (!before) {
    return before.error();
  }
  Result<Scene> scene = loadScene(options.common.scene);
  if (!scene) {
    return scene.error();
  }
  Result<std::vector<std::vector<ObjectId>>> doors = doorsOf(options.doors, *scene);
  if (!doors) {
    return doors.error();
  }
  const Threads threads(options.common.threads);
  const CrackClosing closing = closeCracksOf(*scene, options.crack_width, threads.parallelFor());
  const double load_us = watch.lap();
  std::optional<Scene> walked;
  if (!doors->empty()) {
    walked = withoutDoors(*scene, *doors);
  }
  Result<ViewerSpace> viewers =
      findViewers(options.viewers, options.common.scene, walked ? *walked : *scene, threads.parallelFor());
  if (!viewers) {
    return viewers.error();
  }
  Result<std::vector<Vec3d>> viewpoints = viewpointsOf(options, *scene);
  if (!viewpoints) {
    return viewpoints.error();
  }
  BakeSettings settings = bakeSettings(options, *scene, *viewers);
  settings.doors = std::move(*doors);
  settings.box_margin = closing.margin;
  const OccluderSet occluders = findOccluders(scene->view(), {.area_fraction = 1.0}, threads.parallelFor());
  Result<Bake> bake = Bake::plan(scene->view(), occluders, settings, threads.parallelFor());
  if (!bake) {
    return bake.error();
  }
  std::optional<Bake::TakenOver> update;
  bool without_doors = false;
  if (*before) {
    without_doors = settings.doors.empty() && (*before)->file.doors().groupCount() > 0;
    Result<Bake::TakenOver> taken = takeOver(**before, options, *bake);
    if (!taken) {
      return taken.error();
    }
    update = std::move(*taken);
  }
  return Planned{std::move(*scene), closing.note(),         std::move(*viewers), std::move(*bake), load_us,
                 watch.lap(),       std::move(*viewpoints), std::move(update),   without_doors};
}

// Writes the files that belong beside the baked one.
Status writeCompanions(const BakeOptions& options, const Bake& bake, const ReadPart& parts) {
  const auto save = [](const std::string& file, const std::vector<std::byte>& bytes) {
    return saveFile(file, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  };
  if (!options.witnesses.empty()) {
    const Result<Witnesses> witnesses = bake.witnesses(parts);
    if (!witnesses) {
      return witnesses.error();
    }
    if (const Status ok = save(options.witnesses, witnessBytes(*witnesses)); !ok) {
      return ok;
    }
  }
  if (const std::string file = options.answersFile(); !file.empty()) {
    const Result<std::vector<std::byte>> answers = bake.answers(parts);
    return answers ? save(file, *answers) : Status(answers.error());
  }
  return Success{};
}

// What the baked file has beside its cells.
SightExtras extrasOf(const BakeOptions& options, const Planned& planned) {
  SightExtras extras;
  extras.settings = dump(settingsJson(planned.bake, planned.viewers, planned.scene.origin, planned.cracks));
  const Threads threads(options.common.threads);
  std::optional<Scene> open;  // with all doors open, if there are any
  if (const std::vector<std::vector<ObjectId>>& groups = planned.bake.settings().doors; !groups.empty()) {
    open = planned.scene;
    for (const std::vector<ObjectId>& group : groups) {
      openOtherDoors({.doors = group}, {}, *open);
    }
  }
  extras.databases = buildDatabases(open ? *open : planned.scene,
                                    {*databaseNames(options), options.viewpoints, planned.viewpoints},
                                    threads.parallelFor());
  return extras;
}

// Writes the baked file. If the process is told to end before all parts are read for it, which may take
// minutes, it ends here and leaves the parts alone. Precondition: a SignalGuard lives.
Status writeBaked(const BakeOptions& options, const Bake& bake, const SightExtras& extras,
                  std::uint64_t part_count, Checkpoint& checkpoint) {
  ProgressBar bar("writing");
  std::uint64_t begun = 0;
  const auto read = [&](std::uint64_t part) -> std::optional<BakedPart> {
    bar.update(static_cast<double>(begun) / static_cast<double>(part_count));
    begun += 1;
    return toldToEnd() == 0 ? checkpoint.read(part) : std::nullopt;
  };
  const Status written = bake.writeSight(options.output, read, extras);
  if (!written && toldToEnd() != 0) {
    endInterrupted(bar, checkpoint, part_count, part_count, "");
  }
  return written;
}

// Writes the files of the bake from all of its parts, and reports what is in them.
Result<ExitCode> finish(const BakeOptions& options, const Planned& planned, BakeReport& report,
                        Checkpoint& checkpoint) {
  const auto unfinished = [&](const Error& error) {
    return Error{fmt::format("{}; the finished parts are kept in {}, and --resume goes on from there",
                             error.message, options.partsFile())};
  };
  base::Stopwatch watch;
  const SightExtras extras = extrasOf(options, planned);
  report.times.databases = watch.lap();
  const SignalGuard guard;
  if (const Status ok = writeBaked(options, planned.bake, extras, report.parts, checkpoint); !ok) {
    return unfinished(ok.error());
  }
  const ReadPart parts = [&](std::uint64_t part) { return checkpoint.read(part); };
  if (const Status ok = writeCompanions(options, planned.bake, parts); !ok) {
    return unfinished(ok.error());
  }
  report.times.write = watch.lap();
  const Result<SightFile> file = SightFile::open(options.output);
  if (!file) {
    return file.error();
  }
  const Result<SightFacts> facts = factsOf(*file);
  if (!facts) {
    return facts.error();
  }
  if (const Status ok = checkpoint.remove(); !ok) {
    return ok.error();
  }
  report.effort.peak_bytes = std::max(report.effort.peak_bytes, peakBytes());
  report.effort.all_peak_bytes += peakBytes();
  if (!options.common.json.empty()) {
    const Status ok = writeOutput(options.common.json, dump(bakeJson(report, *file, *facts)));
    if (!ok) {
      return ok.error();
    }
  }
  if (const std::string warning = bakeWarning(*file, *facts); !warning.empty()) {
    printNote("warning: {}: {}", options.output, warning);
  }
  if (options.common.textOnStdout()) {
    fmt::print("{}", bakeText(report, options.output, *file, *facts));
  }
  return kOk;
}

// Bakes with all processes. An error in one ends all of them, and the first process reports it.
Result<ExitCode> bakeTogether(const BakeOptions& options, MpiWorld& world) {
  std::optional<Checkpoint> checkpoint;
  Status own = checkOptions(options);
  if (own && world.first()) {
    Result<Checkpoint> opened = openOutputs(options);
    opened ? void(checkpoint.emplace(std::move(*opened))) : void(own = opened.error());
  }
  if (own = agree(world, own, 0); !own) {
    return own.error();
  }
  Result<Planned> planned = planBake(options);
  std::vector<std::uint64_t> parts;  // that are kept from before
  if (!planned) {
    own = planned.error();
  } else if (checkpoint) {
    if (Result<KeptParts> kept = checkpoint->begin(planned->bake.hash())) {
      if (const std::string loss = lossText(options.partsFile(), *kept); !loss.empty()) {
        printNote("{}{}", kept->damaged ? "warning: " : "", loss);
      }
      parts = std::move(kept->parts);
    } else {
      own = kept.error();
    }
    if (planned->update && !planned->update->difference.empty()) {
      printNote("--update {}: was baked with {}; all is baked anew", options.update,
                planned->update->difference);
    }
    if (planned->without_doors) {
      printNote("--update {}: had doors, and no --doors are given now: there will be none", options.update);
    }
    keepWhenTold(fmt::format("finished parts are kept in {}; the same command with --resume goes on",
                             options.partsFile()));
  }
  if (own = agree(world, own, planned ? planned->bake.hash() : 0); !own) {
    return own.error();
  }
  if (!checkpoint) {
    bakeAsOther(planned->bake, world, options.common.threads);
    return kOk;
  }
  BakeReport report{.plan = planned->bake.hash(),
                    .occluders = planned->bake.occluders().all,
                    .budget_chosen = options.settings.triangle_budget == 0,
                    .depth_chosen = options.settings.max_depth == BakeSettings::kChooseDepth};
  report.update = planned->update;
  report.times.load = planned->load_us;
  report.times.plan = planned->plan_us;
  base::Stopwatch watch;
  const Result<std::uint64_t> all =
      bakeAsFirst(planned->bake, world, options.common.threads, *checkpoint, parts, report.effort);
  if (!all) {
    return all.error();
  }
  report.times.bake = watch.lap();
  report.parts = *all;
  return finish(options, *planned, report, *checkpoint);
}

Result<ExitCode> runBake(const BakeOptions& options) {
  MpiWorld world;
  try {
    Result<ExitCode> result = bakeTogether(options, world);
    if (!result && !world.first()) {
      return kOk;  // the first process reports the error and fails, upon which mpirun ends the others
    }
    return result;
  } catch (const std::exception& error) {
    if (world.size() == 1) {
      throw;
    }
    printNote("process {}: {}", world.rank(), error.what());
    world.abort(kBadUsage);
  }
}

}  // namespace

void addBake(CLI::App& app, Command& chosen) {
  CLI::App* command = app.add_subcommand(
      "bake", "for every cell of space what may be seen from it, as a file; mpirun spreads it");
  const auto options = std::make_shared<BakeOptions>();
  addBakeOptions(*command, *options);
  command->footer(
      "Finished parts are kept in F.sight.parts until F.sight is written. What an interrupted bake left "
      "there is only used with --resume and only removed with --restart; without either it is an error. "
      "--resume may always be given. Of what is there, each part counts only as it was written: one that is "
      "altered or cut off is told of in a line, and is baked again.\n"
      "After a change of the scene, --update OLD.sight takes over what does not depend on the change, from "
      "OLD.sight.answers, which is trusted; the file has the bytes of a full bake with the settings that are "
      "given now. With another --occlusion, --near-distance, --occluder-size, --narrowings or --divisions, "
      "or if the bounds of the scene changed, all is baked anew, and a line says so.\n"
      "The file is the same bit for bit, whatever the threads and processes. --threads and --sample-memory "
      "are of each process.\n"
      "Examples:\n"
      "  sightline bake city.glb -o city.sight --threads 8\n"
      "  sightline bake city.glb -o city.sight --threads 8 --resume\n"
      "  sightline bake changed.glb -o new.sight --update city.sight\n"
      "  sightline bake demo:building -o building.sight --triangle-budget 5000 --depth 5 --databases "
      "area-angle,minimum-sets\n"
      "  mpirun -n 4 --bind-to none sightline bake city.glb -o city.sight --threads 2");
  command->callback([options, &chosen] { chosen = [options] { return runBake(*options); }; });
}

}  // namespace sightline::tool
