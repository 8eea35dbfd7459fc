// The experiments of Saona-Vazquez, Navazo and Brunet 1999, section 4: tables 2 to 5 and the histograms.
//
// Differs from the paper in: scenes, machine and renderer are those of today. Leaves where no viewer can be
// count for the size of the octree only. A leaf that a plane divides has a set on each side; both count.

#include "tools/sightline/reproduce/saona_vazquez.h"

#include <fmt/format.h>
#include <cstdlib>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "sightline/pvs/bake/write_sight.h"
#include "src/base/stopwatch.h"
#include "tools/sightline/bake/bake_options.h"
#include "tools/sightline/bake/bake_run.h"
#include "tools/sightline/command_line/progress_bar.h"
#include "tools/sightline/command_line/signals.h"
#include "tools/sightline/command_line/threads.h"
#include "tools/sightline/reproduce/papers.h"
#include "tools/sightline/reproduce/renderer_or_note.h"
#include "tools/sightline/reproduce/timed_bake.h"
#include "tools/sightline/walk/walk_runs.h"

namespace sightline::tool {

using namespace saona_vazquez;

namespace {

constexpr const char* kNavigations[] = {"walk", "random"};
constexpr std::uint32_t kShortDepth = 4;
constexpr double kBudgets[] = {10.0, 25.0, 50.0};  // percent of the scene's triangles
constexpr std::size_t kMinFinds = 100'000;         // look-ups that are timed, at least

// Writes a file, opens it and removes it; the memory map outlives the file's name.
Result<SightFile> written(const BakedVisibility& baked) {
  std::error_code error;
  std::string folder = (std::filesystem::temp_directory_path(error) / "sightline-XXXXXX").string();
  if (error || mkdtemp(folder.data()) == nullptr) {
    return Error{
        fmt::format("{}: no such folder can be made; set TMPDIR to one that can be written", folder)};
  }
  const SignalGuard guard;  // the folder is removed in any case
  const std::string name = folder + "/baked.sight";
  const Status status = writeSight(name, baked);
  Result<SightFile> file = status ? SightFile::open(name) : Result<SightFile>(status.error());
  std::filesystem::remove_all(folder, error);
  return file;
}

// The settings of `sightline bake` for viewers with these cameras.
BakeSettings settingsFor(const Scene& scene, const std::vector<Walk>& navigations,
                         const ReproduceOptions& options) {
  BakeOptions bake;
  bake.common.threads = options.threads;
  bake.sample_mib = 1024;  // samples are kept, as in the paper
  bake.settings.triangle_budget = options.triangle_budget;
  if (options.depth > 0 || options.fewer_frames) {
    bake.settings.max_depth = options.depth > 0 ? options.depth : kShortDepth;
  }
  bake.settings.near_distance = 0.0;
  for (const Walk& walk : navigations) {
    const double near = nearDistance(walk.view(walk.frames.front(), scene));
    if (std::isfinite(near)) {  // orthographic views see everything, however the file was baked
      bake.settings.near_distance = std::max(bake.settings.near_distance, near);
    }
  }
  return bakeSettings(bake, scene, {});
}

void measurePieces(const Bake& bake, const ParallelFor& parallel_for, Effort& effort) {
  ProgressBar bar("baking pieces");
  base::Stopwatch watch;
  const TimedBake apart =
      bakeTimed(bake, BakedAs::kApart, parallel_for, [&](double done) { bar.update(done); });
  effort.apart_s = 1e-6 * watch.lap();
  effort.apart_samples = apart.stats.samples;
  effort.part_ms = spreadOf(apart.part_ms);
  std::vector<double> mib;
  for (const double bytes : apart.part_bytes) {
    mib.push_back(bytes / kMebibyte);
  }
  effort.part_mib = spreadOf(mib);
}

enum class Pieces : std::uint8_t { kNotMeasured, kMeasured };

Result<Baked> bakeScene(const Scene& scene, const BakeSettings& settings, Pieces pieces,
                        const ParallelFor& parallel_for) {
  Effort effort;
  base::Stopwatch watch;
  const OccluderSet occluders = findOccluders(scene.view(), {.area_fraction = 1.0}, parallel_for);
  const Result<Bake> bake = Bake::plan(scene.view(), occluders, settings);
  if (!bake) {
    return bake.error();
  }
  effort.plan_s = 1e-6 * watch.lap();
  effort.occluders = bake->occluders().all;
  ProgressBar bar("baking");
  const Progress progress = [&](double done) { bar.update(done); };
  const TimedBake parts = bakeTimed(*bake, BakedAs::kWhole, parallel_for, progress);
  effort.whole_s = 1e-6 * watch.lap();
  effort.stats = parts.stats;
  Result<BakedVisibility> baked = bake->assemble(parts.parts);
  if (!baked) {
    return baked.error();
  }
  effort.bake_s = effort.whole_s + 1e-6 * watch.lap();
  baked->record.settings = settingsJson(*bake, {}, scene.origin, {}).dump();
  Result<SightFile> file = written(*baked);
  if (!file) {
    return file.error();
  }
  effort.peak_bytes = peakBytes();
  if (pieces == Pieces::kMeasured) {
    measurePieces(*bake, parallel_for, effort);
  }
  return Baked{std::move(*file), effort};
}

Leaves leavesOf(const SightFile& file) {
  const OctreeView octree = file.octree();
  Leaves leaves;
  leaves.reasons.resize(kMaxOctreeDepth + 1);
  forEachLeaf(octree, [&](std::uint32_t leaf, const OctreeCell& cell) {
    if (static_cast<StopReason>(octree.reasons[leaf]) != StopReason::kOutside) {
      leaves.depths.push_back(cell.level);
      leaves.reasons[cell.level][octree.reasons[leaf]] += 1;
    }
  });
  return leaves;
}

// Bakes the same scene with budgets that leaves can meet.
Status tryBudgets(BakeSettings settings, const ParallelFor& parallel_for, Measured& measured) {
  settings.max_depth = measured.baked.file.record().max_depth;
  for (const double percent : kBudgets) {
    BudgetResult result{percent};
    result.triangles = static_cast<std::uint64_t>(
        std::max(1.0, 0.01 * percent * static_cast<double>(measured.scene.triangleCount())));
    settings.triangle_budget = result.triangles;
    const Result<Baked> baked = bakeScene(measured.scene, settings, Pieces::kNotMeasured, parallel_for);
    if (!baked) {
      return baked.error();
    }
    const Result<SightFacts> facts = factsOf(baked->file);
    if (!facts) {
      return facts.error();
    }
    const Leaves leaves = leavesOf(baked->file);
    for (const auto& of_level : leaves.reasons) {
      result.met += of_level[static_cast<std::size_t>(StopReason::kBudgetMet)];
    }
    result.bake_s = baked->effort.bake_s;
    result.depths = leaves.depths;
    result.mean_triangles = facts->sizes.triangles.mean;
    result.file_bytes = baked->file.fileBytes();
    measured.budgets.push_back(std::move(result));
  }
  return Success{};
}

// Measures look-ups alone: first along the camera path, while sets must be decoded, then with all sets
// decoded.
void timeFinds(const SightFile& file, const Scene& scene, Navigation& navigation) {
  std::vector<View> views;
  for (const std::uint32_t frame : navigation.walk.frames) {
    views.push_back(navigation.walk.view(frame, scene));
  }
  const double near = nearDistance(views.front());
  SetQuery query(file, {.cache_bytes = std::size_t{1} << 30});
  const auto round = [&] {
    for (const View& view : views) {
      query.find(view.eye, near);
    }
  };
  const auto finds = static_cast<double>(views.size());
  base::Stopwatch watch;
  round();
  navigation.first_find_us = watch.lap() / finds;
  const std::size_t rounds = kMinFinds / views.size() + 1;
  for (std::size_t i = 0; i < rounds; ++i) {
    round();
  }
  navigation.find_ns = 1e3 * watch.lap() / (finds * static_cast<double>(rounds));
}

std::vector<Setting> settingsToCompare() {
  std::vector<Setting> settings(2);
  settings[0].method = &methodNamed("frustum");
  settings[1].method = &methodNamed("visibility-octree");
  for (Setting& setting : settings) {
    setting.baked = true;
  }
  return settings;
}

// Without a renderer (null) nothing is drawn.
void navigate(Measured& measured, Navigation& navigation, Renderer* renderer) {
  const Walk& walk = navigation.walk;
  navigation.record.runs = makeRuns(settingsToCompare(), measured.data);
  navigation.record.device = renderer != nullptr ? renderer->device() : "";
  navigation.record.width = walk.path.width;
  navigation.record.height = walk.path.height;
  ProgressBar progress("walking " + walk.path.name);
  for (std::size_t i = 0; i < walk.frames.size(); ++i) {
    const View view = walk.view(walk.frames[i], measured.scene);
    cullFrame(navigation.record.runs, measured.data, walk.frames[i], view);
    if (renderer != nullptr) {
      drawFrame(navigation.record.runs, view, *renderer, nullptr);
    }
    progress.update(static_cast<double>(i + 1) / static_cast<double>(walk.frames.size()));
  }
  timeFinds(measured.baked.file, measured.scene, navigation);
}

// The navigations, with pictures of the size that the user asks for.
Result<std::vector<Walk>> navigationsOf(const SceneAndWalk& input, const ReproduceOptions& options) {
  Result<std::vector<Walk>> walks = namedWalks(input, options, kNavigations);
  if (walks) {
    for (Walk& walk : *walks) {
      const PictureOptions picture = pictureSize(options.picture, walk.path);
      walk.path.width = picture.width;
      walk.path.height = picture.height;
    }
  }
  return walks;
}

Result<Measured> bakeAndMeasure(const std::string& name, const Scene& scene, const std::vector<Walk>& walks,
                                const ReproduceOptions& options, const ParallelFor& parallel_for) {
  const BakeSettings settings = settingsFor(scene, walks, options);
  Result<Baked> baked = bakeScene(scene, settings, Pieces::kMeasured, parallel_for);
  if (!baked) {
    return baked.error();
  }
  const Result<SightFacts> facts = factsOf(baked->file);
  if (!facts) {
    return facts.error();
  }
  const SightFile file = baked->file;
  Measured measured{name,   scene,          std::move(*baked),
                    *facts, leavesOf(file), CullingData(scene, parallel_for, {}, file)};
  if (const Status tried = tryBudgets(settings, parallel_for, measured); !tried) {
    return tried.error();
  }
  return measured;
}

void navigateAll(Measured& measured, const std::vector<Walk>& walks, std::vector<std::string>& notes) {
  for (const Walk& walk : walks) {
    std::optional<Renderer> renderer =
        rendererOrNote(measured.scene.view(), {walk.path.width, walk.path.height},
                       measured.name + ", " + walk.path.name, notes);
    measured.navigations.push_back({walk});
    navigate(measured, measured.navigations.back(), renderer ? &*renderer : nullptr);
  }
}

}  // namespace

Result<Reproduction> reproduceSaonaVazquez(const ReproduceOptions& options,
                                           const std::vector<SceneAndWalk>& inputs) {
  const Threads threads(options.threads);
  std::vector<std::vector<Walk>> walks;
  for (const SceneAndWalk& input : inputs) {  // check all inputs before the work starts
    Result<std::vector<Walk>> of_scene = navigationsOf(input, options);
    if (!of_scene) {
      return of_scene.error();
    }
    walks.push_back(std::move(*of_scene));
  }
  Reproduction result;
  std::vector<Measured> scenes;
  scenes.reserve(inputs.size());  // cullers hold on to their scene's data
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    Result<Measured> measured =
        bakeAndMeasure(options.scenes[i], inputs[i].scene, walks[i], options, threads.parallelFor());
    if (!measured) {
      return measured.error();
    }
    navigateAll(scenes.emplace_back(std::move(*measured)), walks[i], result.notes);
  }
  result.experiments = tablesOf(scenes);
  result.findings = findingsOf(scenes);
  for (const Measured& measured : scenes) {
    result.reports.push_back(reportOf(measured, result.experiments, options));
  }
  return result;
}

}  // namespace sightline::tool
