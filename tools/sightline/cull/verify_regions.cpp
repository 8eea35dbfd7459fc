#include "tools/sightline/cull/verify_regions.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <string_view>

#include "oracle/region_search.h"
#include "src/io/point_json.h"
#include "tools/sightline/command_line/json_output.h"
#include "tools/sightline/command_line/progress_bar.h"
#include "tools/sightline/command_line/threads.h"
#include "tools/sightline/cull/hidden_pairs.h"
#include "tools/sightline/input/load.h"

namespace sightline::tool {
namespace {

constexpr std::size_t kMaxListedPairs = 20;  // on the terminal; JSON has all
constexpr std::uint32_t kPairsAtOnce = 64;   // between two steps of the progress bar
constexpr std::array<std::string_view, 2> kSearchOptions{"--pairs", "--seed"};
constexpr std::array<std::string_view, 7> kCommonOptions{"SCENE",   "--json",        "--threads", "--baked",
                                                         "--proof", "--crack-width", "--closed"};

std::string nameOf(FoundBy by) {
  return by == FoundBy::kLine ? "line" : by == FoundBy::kPlane ? "plane" : "eye";
}

std::string nameOf(CellPart part) {
  return part == CellPart::kWhole   ? "whole"
         : part == CellPart::kFront ? "front"
         : part == CellPart::kBack  ? "back"
                                    : "between";
}

struct RegionsReport {
  HiddenPairs sample;
  std::vector<RegionAnswer> answers;  // one for each pair
  std::uint32_t seed = 0;

  std::size_t falseCulls() const {
    return static_cast<std::size_t>(
        std::count_if(answers.begin(), answers.end(), [](const auto& answer) { return answer.found; }));
  }
  std::uint64_t sum(std::uint64_t RegionAnswer::*count) const {
    std::uint64_t sum = 0;
    for (const RegionAnswer& answer : answers) {
      sum += answer.*count;
    }
    return sum;
  }
};

RegionsReport search(const Scene& scene, const SightFile& baked, HiddenPairs sample,
                     const RegionOptions& options, const ParallelFor& parallel_for) {
  const RegionSearch searcher(scene.view());
  RegionSearchSettings settings;
  settings.near_distance = baked.record().near_distance;
  RegionsReport report{std::move(sample), {}, options.seed};
  const std::vector<HiddenPair>& pairs = report.sample.pairs;
  report.answers.resize(pairs.size());
  const auto count = static_cast<std::uint32_t>(pairs.size());
  ProgressBar progress("verifying");
  for (std::uint32_t first = 0; first < count; first += kPairsAtOnce) {
    const std::uint32_t size = std::min(kPairsAtOnce, count - first);
    parallel_for(size, [&](std::uint32_t begin, std::uint32_t end) {
      for (std::uint32_t i = first + begin; i < first + end; ++i) {
        const EyeRegion region =
            regionOf(baked.octree(), report.sample.cells[pairs[i].leaf], pairs[i].leaf, pairs[i].part);
        const std::uint64_t seed = std::uint64_t{i} << 32 | options.seed;
        report.answers[i] = searcher.contradict(region, pairs[i].object, settings, seed);
      }
    });
    progress.update(static_cast<double>(first + size) / count);
  }
  return report;
}

std::string toJson(const RegionsReport& report, const Scene& scene, const CrackClosing& closing) {
  Json witnesses = Json::array();
  for (std::size_t i = 0; i < report.answers.size(); ++i) {
    const RegionAnswer& answer = report.answers[i];
    if (answer.found) {
      const HiddenPair& pair = report.sample.pairs[i];
      const Vec3d eye = answer.eye + scene.origin, point = answer.witness.point + scene.origin;
      witnesses.push_back({{"cell", pair.leaf},
                           {"part", nameOf(pair.part)},
                           {"object", pair.object.value},
                           {"name", scene.object_names[pair.object.value]},
                           {"eye", io::pointJson(eye)},
                           {"point", io::pointJson(point)},
                           {"by", nameOf(answer.by)}});
    }
  }
  return dump({{"scene", sceneJson(scene, closing)},
               {"seed", report.seed},
               {"cells", report.sample.cells.size()},
               {"pairs", report.answers.size()},
               {"false_culls", report.falseCulls()},
               {"lines", report.sum(&RegionAnswer::lines)},
               {"planes", report.sum(&RegionAnswer::planes)},
               {"eyes", report.sum(&RegionAnswer::eyes)},
               {"hidden_views", report.sum(&RegionAnswer::hidden_views)},
               {"undecided_views", report.sum(&RegionAnswer::undecided_views)},
               {"witnesses", witnesses}});
}

void print(const RegionsReport& report, const Scene& scene, const CrackClosing& closing) {
  if (report.answers.empty()) {
    fmt::print("the sets of the cells hold every object; there is nothing to contradict\n");
    return;
  }
  std::size_t listed = 0;
  for (std::size_t i = 0; i < report.answers.size() && listed < kMaxListedPairs; ++i) {
    const RegionAnswer& answer = report.answers[i];
    if (answer.found) {
      const HiddenPair& pair = report.sample.pairs[i];
      const Vec3d eye = answer.eye + scene.origin, point = answer.witness.point + scene.origin;
      fmt::print(
          "false cull: object {} '{}' is not in the set of cell {} ({}), but from {:.9f} {:.9f} {:.9f} it is "
          "seen at {:.9f} {:.9f} {:.9f} ({})\n",
          pair.object.value, scene.object_names[pair.object.value], pair.leaf, nameOf(pair.part), eye.x,
          eye.y, eye.z, point.x, point.y, point.z, nameOf(answer.by));
      listed += 1;
    }
  }
  if (report.falseCulls() > listed) {
    fmt::print("... and {} more false culls; --json lists all\n", report.falseCulls() - listed);
  }
  fmt::print("{} pairs of a cell and an object that is not in its set{}; {} false culls\n",
             report.answers.size(), closing.width > 0.0 ? ", with" + crackText(closing.note()) : "",
             report.falseCulls());
  fmt::print("searched {} lines, {} planes of lines and {} eyes; exact pictures: {} hidden, {} undecided\n",
             report.sum(&RegionAnswer::lines), report.sum(&RegionAnswer::planes),
             report.sum(&RegionAnswer::eyes), report.sum(&RegionAnswer::hidden_views),
             report.sum(&RegionAnswer::undecided_views));
}

}  // namespace

void addRegionOptions(CLI::App& command, RegionOptions& options) {
  command
      .add_option(
          "--pairs", options.pairs,
          "pairs of a cell of --baked and an object hidden from it, which --proof tries to contradict")
      ->check(CLI::Range(1u, 100000000u))
      ->capture_default_str();
  command.add_option("--seed", options.seed, "seed of the choice of pairs and of the search")
      ->check(CLI::Range(0u, 4294967295u))
      ->capture_default_str();
}

Result<bool> asksForRegions(const CLI::App& command) {
  std::string of_regions, of_paths;
  for (const CLI::Option* option : command.get_options()) {
    if (option->count() == 0) {
      continue;
    }
    const std::string name = option->get_name();
    const auto isOneOf = [&](const auto& names) {
      return std::find(names.begin(), names.end(), name) != names.end();
    };
    if (isOneOf(kSearchOptions)) {
      of_regions = name;
    } else if (!isOneOf(kCommonOptions)) {
      of_paths = name;
    }
  }
  const bool asks = command.count("--baked") > 0 && command.count("--proof") > 0 && of_paths.empty();
  if (!asks && !of_regions.empty()) {
    return Error{fmt::format("{}: it is about the cells of a baked file; {}", of_regions,
                             of_paths.empty() ? "give the file with --baked, and --proof"
                                              : "leave out " + of_paths + ", which is not")};
  }
  return asks;
}

Result<ExitCode> verifyRegions(const CommonOptions& common, const MethodOptions& method,
                               const RegionOptions& options) {
  if (const Status ok = checkFiles({.scenes = {common.scene},
                                    .inputs = {{"--baked", method.baked}},
                                    .outputs = {{"--json", common.json}}});
      !ok) {
    return ok.error();
  }
  Result<Scene> scene = loadScene(common.scene);
  if (!scene) {
    return scene.error();
  }
  const CrackClosing closing = closeCracksOf(*scene, method.crack_width);
  const Result<std::optional<SightFile>> file = loadBaked(method.baked, *scene);
  if (!file) {
    return file.error();
  }
  const Result<std::vector<ObjectId>> closed = closeDoors(method.closed, method.baked, *file, *scene);
  if (!closed) {
    return closed.error();
  }
  Result<HiddenPairs> sample = sampleHiddenPairs(**file, *closed, *scene, options.pairs, options.seed);
  if (!sample) {
    return sample.error();
  }
  const Threads threads(common.threads);
  const RegionsReport report = search(*scene, **file, std::move(*sample), options, threads.parallelFor());
  if (const Status ok = writeOutput(common.json, common.json.empty() ? "" : toJson(report, *scene, closing));
      !ok) {
    return ok.error();
  }
  if (common.textOnStdout()) {
    print(report, *scene, closing);
  }
  return report.falseCulls() == 0 ? kOk : kCheckFailed;
}

}  // namespace sightline::tool
