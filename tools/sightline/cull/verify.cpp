// sightline verify: compares culling with exact visibility, found by ray casting and by proofs.

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <memory>

#include "oracle/exact_visibility.h"
#include "src/io/point_json.h"
#include "tools/sightline/command_line/json_output.h"
#include "tools/sightline/command_line/progress_bar.h"
#include "tools/sightline/command_line/text_table.h"
#include "tools/sightline/command_line/threads.h"
#include "tools/sightline/commands.h"
#include "tools/sightline/cull/verify_regions.h"
#include "tools/sightline/exact/exact_frame.h"
#include "tools/sightline/input/scene_facts.h"

namespace sightline::tool {
namespace {

constexpr std::size_t kMaxListedCulls = 20;  // false culls listed on the terminal; JSON has all

struct VerifyOptions {
  CommonOptions common;
  PathOptions path;
  MethodOptions method;
  RegionOptions regions;
  std::uint32_t width = 1280, height = 720;
  std::uint32_t aimed_rays = 16, edge_rays = 16;
  std::uint32_t gap_steps = 16, proof_steps = 20000;
  bool proof = false;

  ExactSettings exact() const {
    return {width, height, aimed_rays, edge_rays, proof ? proof_steps : gap_steps};
  }
};

// An object that was culled although it is visible.
struct FalseCull {
  Sighting sighting;
  std::uint32_t frame = 0;
};

struct FrameCounts {
  std::uint32_t frame = 0;
  std::size_t culled = 0, kept = 0;
  std::size_t proved = 0, undecided = 0;  // of the culled ones
};

struct VerifyRun {
  Setting setting;
  Culler culler;
  std::vector<FrameCounts> frames;
  std::vector<FalseCull> false_culls;

  FrameCounts total() const {
    FrameCounts sum;
    for (const FrameCounts& frame : frames) {
      sum.culled += frame.culled;
      sum.kept += frame.kept;
      sum.proved += frame.proved;
      sum.undecided += frame.undecided;
    }
    return sum;
  }
  double overestimate(std::size_t exact) const {
    const auto kept = static_cast<double>(total().kept);
    return exact > 0 ? kept / static_cast<double>(exact) : kept > 0.0 ? std::nan("") : 1.0;
  }
};

struct ExactCounts {
  std::size_t visible = 0, undecided = 0;
};

// Compares all runs with one exact answer for each frame.
class Verifier {
 public:
  Verifier(const VerifyOptions& options, const Scene& scene, const Walk& walk,
           const ParallelFor& parallel_for)
      : options_(options), scene_(scene), walk_(walk), parallel_for_(parallel_for), oracle_(scene.view()) {}

  void compare(std::uint32_t frame, std::vector<VerifyRun>& runs) {
    view_ = walk_.view(frame, scene_);
    frame_ = frame;
    for (VerifyRun& run : runs) {
      run.culler.cull(view_);
    }
    exact_ = exactFrame(oracle_, view_, static_cast<std::uint32_t>(scene_.objects.size()), options_.exact(),
                        parallel_for_);
    of_frame.push_back({exact_.visible.size(), exact_.undecided.size()});
    total.visible += exact_.visible.size();
    total.undecided += exact_.undecided.size();
    for (VerifyRun& run : runs) {
      judge(run);
    }
  }

  std::vector<ExactCounts> of_frame;
  ExactCounts total;

 private:
  void judge(VerifyRun& run) {
    const std::span<const ObjectId> kept = run.culler.visible();
    const auto isCulled = [&](ObjectId object) {
      return !std::binary_search(kept.begin(), kept.end(), object);
    };
    FrameCounts counts{frame_, scene_.objects.size() - kept.size(), kept.size(), 0, 0};
    counts.undecided =
        static_cast<std::size_t>(std::count_if(exact_.undecided.begin(), exact_.undecided.end(), isCulled));
    counts.proved = counts.culled - counts.undecided;
    for (const auto& [object, sighting] : exact_.visible) {
      if (isCulled(object)) {
        run.false_culls.push_back({sighting, frame_});
        counts.proved -= 1;
      }
    }
    run.frames.push_back(counts);
  }

  const VerifyOptions& options_;
  const Scene& scene_;
  const Walk& walk_;
  ParallelFor parallel_for_;
  ExactVisibility oracle_;
  View view_;
  std::uint32_t frame_ = 0;
  ExactFrame exact_;
};

Json runJson(const VerifyRun& run, const Verifier& verifier, const Scene& scene) {
  Json frames = Json::array(), witnesses = Json::array();
  for (std::size_t i = 0; i < run.frames.size(); ++i) {
    frames.push_back({{"frame", run.frames[i].frame},
                      {"culled", run.frames[i].culled},
                      {"kept", run.frames[i].kept},
                      {"exact", verifier.of_frame[i].visible},
                      {"exact_at_most", verifier.of_frame[i].visible + verifier.of_frame[i].undecided},
                      {"proved", run.frames[i].proved},
                      {"undecided", run.frames[i].undecided}});
  }
  for (const FalseCull& wrong : run.false_culls) {
    const Vec3d point = wrong.sighting.witness.point + scene.origin;
    witnesses.push_back({{"object", wrong.sighting.witness.object.value},
                         {"name", scene.object_names[wrong.sighting.witness.object.value]},
                         {"frame", wrong.frame},
                         {"point", io::pointJson(point)},
                         {"by", nameOf(wrong.sighting.by)}});
  }
  const double overestimate = run.overestimate(verifier.total.visible),
               at_least = run.overestimate(verifier.total.visible + verifier.total.undecided);
  const FrameCounts total = run.total();
  Json json = {{"method", methodName(run.setting)},
               {"options", optionsJson(run.setting)},
               {"false_culls", run.false_culls.size()},
               {"proved", total.proved},
               {"undecided", total.undecided},
               {"overestimate", std::isfinite(overestimate) ? Json(overestimate) : Json()},
               {"overestimate_at_least", std::isfinite(at_least) ? Json(at_least) : Json()},
               {"frames", frames},
               {"witnesses", witnesses}};
  addChoice(json, run.setting);
  return json;
}

std::string toJson(const std::vector<VerifyRun>& runs, const Verifier& verifier, const SceneAndWalk& input) {
  const Scene& scene = input.scene;
  if (runs.size() == 1) {
    Json json = runJson(runs.front(), verifier, scene);
    json["scene"] = sceneJson(input);
    return dump(json);
  }
  std::vector<std::string> items;
  for (const VerifyRun& run : runs) {
    items.push_back(dump(runJson(run, verifier, scene)));
  }
  return dumpWithList({{"scene", sceneJson(input)}}, "runs", items);
}

void printFalseCulls(const std::vector<VerifyRun>& runs, const Scene& scene) {
  std::size_t total = 0, listed = 0;
  for (const VerifyRun& run : runs) {
    total += run.false_culls.size();
    for (const FalseCull& wrong : run.false_culls) {
      if (listed < kMaxListedCulls) {
        const Vec3d point = wrong.sighting.witness.point + scene.origin;
        fmt::print("false cull: object {} '{}' in frame {}, seen at {:.6f} {:.6f} {:.6f} ({}); {} ({})\n",
                   wrong.sighting.witness.object.value,
                   scene.object_names[wrong.sighting.witness.object.value], wrong.frame, point.x, point.y,
                   point.z, nameOf(wrong.sighting.by), methodName(run.setting), optionsText(run.setting));
        listed += 1;
      }
    }
  }
  if (total > listed) {
    fmt::print("... and {} more false culls; --json lists all\n", total - listed);
  }
}

// more_certain: what decides about more objects.
void print(const std::vector<VerifyRun>& runs, const Verifier& verifier, const SceneAndWalk& input,
           const char* more_certain) {
  printFalseCulls(runs, input.scene);
  const std::string with = crackText(input.closing.note()) + clustersText(input.clustering);
  const auto a_frame = [&](std::size_t count) {
    return static_cast<double>(count) / static_cast<double>(verifier.of_frame.size());
  };
  fmt::print("{} frames, {} {}, exactly visible {:.1f} to {:.1f} a frame{}\n", verifier.of_frame.size(),
             input.scene.objects.size(), input.clustering.on() ? "clusters" : "objects",
             a_frame(verifier.total.visible), a_frame(verifier.total.visible + verifier.total.undecided),
             with.empty() ? "" : ", with" + with);
  TextTable table{
      {"method", "options", "kept", "overestimate", "culled", "proved", "undecided", "false culls"}, {}, 2};
  for (const VerifyRun& run : runs) {
    const FrameCounts total = run.total();
    table.rows.push_back({methodName(run.setting), optionsText(run.setting),
                          fmt::format("{:.1f}", a_frame(total.kept)),
                          fmt::format("{:.3f}", run.overestimate(verifier.total.visible)),
                          std::to_string(total.culled), std::to_string(total.proved),
                          std::to_string(total.undecided), std::to_string(run.false_culls.size())});
  }
  fmt::print("{}", toText(table));
  const bool undecided =
      std::any_of(runs.begin(), runs.end(), [](const auto& run) { return run.total().undecided > 0; });
  if (undecided) {
    fmt::print("undecided: culled, but neither seen nor proved hidden; {}\n", more_certain);
  }
}

Result<ExitCode> verifyWalk(const VerifyOptions& options, const std::vector<Setting>& settings,
                            const SceneAndWalk& input) {
  const Scene& scene = input.scene;
  const Walk& walk = input.walk;
  const Threads threads(options.common.threads);
  CullingData data(input, threads.parallelFor());
  std::vector<VerifyRun> runs;
  for (const Setting& setting : settings) {
    runs.push_back({setting, data.makeCuller(setting), {}, {}});
  }
  Verifier verifier(options, scene, walk, threads.parallelFor());
  {
    ProgressBar progress("verifying");
    for (std::size_t i = 0; i < walk.frames.size(); ++i) {
      verifier.compare(walk.frames[i], runs);
      progress.update(static_cast<double>(i + 1) / static_cast<double>(walk.frames.size()));
    }
  }
  if (!options.common.json.empty()) {
    if (const Status ok = writeOutput(options.common.json, toJson(runs, verifier, input)); !ok) {
      return ok.error();
    }
  }
  if (options.common.textOnStdout()) {
    const std::string choice = choiceText(settings);
    fmt::print("{}{}", choice, choice.empty() ? "" : "\n");
    print(runs, verifier, input,
          options.proof ? "a larger --proof-steps decides about more of them" : "--proof decides about them");
  }
  data.noteUnknownSets();
  const bool clean =
      std::all_of(runs.begin(), runs.end(), [](const auto& run) { return run.false_culls.empty(); });
  return clean ? kOk : kCheckFailed;
}

Result<ExitCode> runVerify(const VerifyOptions& options, const CLI::App& command) {
  const Result<bool> regions = asksForRegions(command);
  if (!regions) {
    return regions.error();
  }
  if (*regions) {
    return verifyRegions(options.common, options.method, options.regions);
  }
  const Result<std::vector<Setting>> checked = settingsOf(options.method);
  if (!checked) {
    return checked.error();
  }
  const Result<SceneAndWalk> input = checkAndLoad(options.common, options.path, options.method);
  if (!input) {
    return input.error();
  }
  const Result<std::vector<Setting>> settings = settingsFor(options.method, *checked, *input);
  return settings ? verifyWalk(options, *settings, *input) : settings.error();
}

}  // namespace

void addVerify(CLI::App& app, Command& chosen) {
  CLI::App* command = app.add_subcommand(
      "verify",
      "compares culling with exact visibility, by rays or, with --proof, by exact proofs; exit "
      "code 1 on a false cull");
  const auto options = std::make_shared<VerifyOptions>();
  addCommonOptions(*command, options->common);
  addPathOptions(*command, options->path);
  addMethodOptions(*command, options->method, true);
  addClustersOption(*command, options->method.clusters);
  command->add_option("--width", options->width, "rays in a row, one a pixel")
      ->check(CLI::Range(1u, 16384u))
      ->capture_default_str();
  command->add_option("--height", options->height, "rows of rays")
      ->check(CLI::Range(1u, 16384u))
      ->capture_default_str();
  command
      ->add_option("--aimed-rays", options->aimed_rays,
                   "rays aimed at points of each object that no pixel shows")
      ->check(CLI::Range(0u, 4096u))
      ->capture_default_str();
  command
      ->add_option("--edge-rays", options->edge_rays,
                   "rays close beside edges of each visible object: along silhouettes, through gaps")
      ->check(CLI::Range(0u, 4096u))
      ->capture_default_str();
  command
      ->add_option("--gap-steps", options->gap_steps,
                   "steps of the search for a gap through which an object shows that no ray has reached")
      ->check(CLI::Range(0u, 1000000u))
      ->capture_default_str();
  command->add_flag("--proof", options->proof, "goes on until each object that is not seen is proved hidden");
  command
      ->add_option("--proof-steps", options->proof_steps,
                   "steps after which --proof leaves an object undecided")
      ->check(CLI::Range(1u, 1000000000u))
      ->capture_default_str();
  addRegionOptions(*command, options->regions);
  command->footer(
      "For certainty, give --proof: each culled object is then seen, or proved hidden, in exact arithmetic.\n"
      "Without it, rays are cast and each is confirmed by exact arithmetic, and proofs end after "
      "--gap-steps;\n"
      "'undecided' culled objects are neither seen nor proved hidden; they do not change the exit code.\n"
      "A proof subtracts the images of nearer triangles from that of the object.\n"
      "overestimate is kept / visible objects over all frames.\n"
      "With --baked and --proof, and no path, method or rays: takes pairs of a cell and an object that\n"
      "is not in its set, and searches a place in the cell from where the object is visible.\n"
      "Examples:\n"
      "  sightline verify city.glb --path walk.json --frames 0:400:20 --proof\n"
      "  sightline verify city.glb --path walk.json\n"
      "  sightline verify demo:building --method occlusion-tree --variant FSE,FSC,FME,FMC --hierarchy kd,bvh "
      "--coherence on,off\n"
      "  sightline verify demo:city --method supporting-planes --joint on,off --occluders "
      "area-angle,database\n"
      "  sightline verify demo:boxes --method depth-pyramid --resolution 64x36,320x180 --focus 0,8 --frames "
      "0:400:50\n"
      "  sightline verify demo:ship --baked ship.sight --path cells --method visibility-octree,depth-pyramid "
      "--visible-sets on,off\n"
      "  sightline verify demo:ship --baked ship.sight --proof --pairs 10000 --seed 7\n"
      "  sightline verify demo:city --frames 0:400:20 --width 3840 --height 2160 --aimed-rays 64 --json "
      "verify.json");
  command->callback(
      [options, command, &chosen] { chosen = [options, command] { return runVerify(*options, *command); }; });
}

}  // namespace sightline::tool
