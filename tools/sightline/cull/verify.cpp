// sightline verify: compares culling with exact visibility by ray casting.

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "oracle/exact_visibility.h"
#include "tools/sightline/command_line/json_output.h"
#include "tools/sightline/command_line/progress_bar.h"
#include "tools/sightline/command_line/text_table.h"
#include "tools/sightline/command_line/threads.h"
#include "tools/sightline/commands.h"
#include "tools/sightline/input/load.h"

namespace sightline::tool {
namespace {

constexpr std::size_t kMaxTries = 256;  // pixels that are tried to confirm one false cull
constexpr std::size_t kMaxListed = 20;  // false culls listed on the terminal; JSON has all

struct VerifyOptions {
  CommonOptions common;
  PathOptions path;
  MethodOptions method;
  std::uint32_t width = 1280, height = 720;
  std::uint32_t aimed_rays = 16, edge_rays = 16;
};

// An object that a ray reached. It is a false cull if the culler said that it is hidden.
struct Sighting {
  Witness witness;
  std::uint32_t frame = 0;
  bool aimed = false;      // reached by a ray aimed at it, otherwise by a ray through a pixel
  bool confirmed = false;  // beyond what rounding of the rays explains
};

struct FrameCounts {
  std::uint32_t frame = 0;
  std::size_t culled = 0, kept = 0;
};

struct VerifyRun {
  Setting setting;
  Culler culler;
  std::vector<FrameCounts> frames;
  std::vector<Sighting> false_culls;  // confirmed ones
  std::size_t unconfirmed = 0;

  double overestimate(std::size_t exact) const {
    double kept = 0.0;
    for (const FrameCounts& frame : frames) {
      kept += static_cast<double>(frame.kept);
    }
    return exact > 0 ? kept / static_cast<double>(exact) : kept > 0.0 ? std::nan("") : 1.0;
  }
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
    seen_.clear();
    for (const Witness& witness :
         oracle_.visibleThroughPixels(view_, options_.width, options_.height, parallel_for_)) {
      seen_.emplace(witness.object, Sighting{witness, frame, false, false});
    }
    lookBesideSeen();
    aimAtUnseen();
    exact_of_frame.push_back(seen_.size());
    exact_total += seen_.size();
    judged_.clear();
    for (VerifyRun& run : runs) {
      judge(run);
    }
  }

  std::vector<std::size_t> exact_of_frame;
  std::size_t exact_total = 0;

 private:
  // Casts rays along the silhouettes of the objects that pixels showed, and through the gaps between them.
  void lookBesideSeen() {
    std::vector<ObjectId> objects;
    for (const auto& [object, sighting] : seen_) {
      objects.push_back(object);
    }
    for (const Witness& witness :
         oracle_.visibleBesideEdges(view_, objects, options_.edge_rays, parallel_for_)) {
      seen_.emplace(witness.object, Sighting{witness, frame_, true, false});
    }
  }

  // Aims rays at the objects that no ray has reached yet, whether they were culled or kept.
  void aimAtUnseen() {
    std::vector<ObjectId> targets;
    for (std::uint32_t o = 0; o < scene_.objects.size(); ++o) {
      if (!seen_.contains(ObjectId(o))) {
        targets.push_back(ObjectId(o));
      }
    }
    for (const Witness& witness :
         oracle_.visibleByAimedRays(view_, targets, options_.aimed_rays, parallel_for_)) {
      seen_.emplace(witness.object, Sighting{witness, frame_, true, false});
    }
  }

  void judge(VerifyRun& run) {
    const std::span<const ObjectId> visible = run.culler.visible();
    run.frames.push_back({frame_, scene_.objects.size() - visible.size(), visible.size()});
    for (const auto& [object, sighting] : seen_) {
      if (!std::binary_search(visible.begin(), visible.end(), object)) {
        const Sighting& judged = confirmed(sighting);
        run.unconfirmed += judged.confirmed ? 0 : 1;
        if (judged.confirmed) {
          run.false_culls.push_back(judged);
        }
      }
    }
  }

  // The sighting with a witness that exact arithmetic confirms, if one can be found. Done once for each frame
  // and object.
  const Sighting& confirmed(const Sighting& sighting) {
    const auto [entry, is_new] = judged_.emplace(sighting.witness.object, sighting);
    Sighting& judged = entry->second;
    if (is_new) {
      judged.confirmed = oracle_.confirm(view_, judged.witness);
      if (!judged.confirmed && !judged.aimed) {
        tryOtherPixels(judged);
      }
    }
    return judged;
  }

  void tryOtherPixels(Sighting& judged) {
    const std::vector<Witness> pixels =
        oracle_.pixelsShowing(judged.witness.object, view_, options_.width, options_.height, parallel_for_);
    const std::size_t step = pixels.size() / kMaxTries + 1;
    for (std::size_t i = 0; i < pixels.size() && !judged.confirmed; i += step) {
      if (oracle_.confirm(view_, pixels[i])) {
        judged.witness = pixels[i];
        judged.confirmed = true;
      }
    }
  }

  const VerifyOptions& options_;
  const Scene& scene_;
  const Walk& walk_;
  ParallelFor parallel_for_;
  ExactVisibility oracle_;
  View view_;
  std::uint32_t frame_ = 0;
  std::map<ObjectId, Sighting> seen_;    // objects that a ray reached in this frame
  std::map<ObjectId, Sighting> judged_;  // those of them that some run culled
};

Json runJson(const VerifyRun& run, const Verifier& verifier, const Scene& scene) {
  Json frames = Json::array(), witnesses = Json::array();
  for (std::size_t i = 0; i < run.frames.size(); ++i) {
    frames.push_back({{"frame", run.frames[i].frame},
                      {"culled", run.frames[i].culled},
                      {"kept", run.frames[i].kept},
                      {"exact", verifier.exact_of_frame[i]}});
  }
  for (const Sighting& wrong : run.false_culls) {
    const Vec3d point = wrong.witness.point + scene.origin;
    witnesses.push_back({{"object", wrong.witness.object.value},
                         {"name", scene.object_names[wrong.witness.object.value]},
                         {"frame", wrong.frame},
                         {"point", {point.x, point.y, point.z}},
                         {"by", wrong.aimed ? "aimed ray" : "pixel"}});
  }
  const double overestimate = run.overestimate(verifier.exact_total);
  return {{"method", methodName(run.setting)},
          {"options", optionsJson(run.setting)},
          {"false_culls", run.false_culls.size()},
          {"unconfirmed", run.unconfirmed},
          {"overestimate", std::isfinite(overestimate) ? Json(overestimate) : Json()},
          {"frames", frames},
          {"witnesses", witnesses}};
}

std::string toJson(const std::vector<VerifyRun>& runs, const Verifier& verifier, const Scene& scene) {
  if (runs.size() == 1) {
    return dump(runJson(runs.front(), verifier, scene));
  }
  std::vector<std::string> items;
  for (const VerifyRun& run : runs) {
    items.push_back(dump(runJson(run, verifier, scene)));
  }
  return dumpWithList({{"scene", sceneJson(scene)}}, "runs", items);
}

void printFalseCulls(const std::vector<VerifyRun>& runs, const Scene& scene) {
  std::size_t total = 0, listed = 0;
  for (const VerifyRun& run : runs) {
    total += run.false_culls.size();
    for (const Sighting& wrong : run.false_culls) {
      if (listed < kMaxListed) {
        const Vec3d point = wrong.witness.point + scene.origin;
        fmt::print("false cull: object {} '{}' in frame {}, seen at {:.6f} {:.6f} {:.6f} ({}); {} ({})\n",
                   wrong.witness.object.value, scene.object_names[wrong.witness.object.value], wrong.frame,
                   point.x, point.y, point.z, wrong.aimed ? "aimed ray" : "pixel", methodName(run.setting),
                   optionsText(run.setting));
        listed += 1;
      }
    }
  }
  if (total > listed) {
    fmt::print("... and {} more false culls; --json lists all\n", total - listed);
  }
}

void print(const std::vector<VerifyRun>& runs, const Verifier& verifier, const Scene& scene) {
  printFalseCulls(runs, scene);
  fmt::print("{} frames, {} objects, exactly visible {:.1f} a frame\n", verifier.exact_of_frame.size(),
             scene.objects.size(),
             static_cast<double>(verifier.exact_total) / static_cast<double>(verifier.exact_of_frame.size()));
  TextTable table{{"method", "options", "kept", "overestimate", "unconfirmed", "false culls"}, {}, 2};
  for (const VerifyRun& run : runs) {
    double kept = 0.0;
    for (const FrameCounts& frame : run.frames) {
      kept += static_cast<double>(frame.kept);
    }
    table.rows.push_back({methodName(run.setting), optionsText(run.setting),
                          fmt::format("{:.1f}", kept / static_cast<double>(run.frames.size())),
                          fmt::format("{:.3f}", run.overestimate(verifier.exact_total)),
                          std::to_string(run.unconfirmed), std::to_string(run.false_culls.size())});
  }
  fmt::print("{}", toText(table));
}

Result<ExitCode> verifyWalk(const VerifyOptions& options, const std::vector<Setting>& settings,
                            const SceneAndWalk& input) {
  const auto& [scene, walk, baked] = input;
  const Threads threads(options.common.threads);
  CullingData data(scene, threads.parallelFor(), walk, baked);
  std::vector<VerifyRun> runs;
  for (const Setting& setting : settings) {
    runs.push_back({setting, data.makeCuller(setting), {}, {}, 0});
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
    if (const Status ok = writeOutput(options.common.json, toJson(runs, verifier, scene)); !ok) {
      return ok.error();
    }
  }
  if (options.common.textOnStdout()) {
    print(runs, verifier, scene);
  }
  data.noteUnknownSets();
  const bool clean =
      std::all_of(runs.begin(), runs.end(), [](const auto& run) { return run.false_culls.empty(); });
  return clean ? kOk : kCheckFailed;
}

Result<ExitCode> runVerify(const VerifyOptions& options) {
  const Result<std::vector<Setting>> settings = settingsOf(options.method);
  if (!settings) {
    return settings.error();
  }
  const Result<SceneAndWalk> input = checkAndLoad(options.common, options.path, options.method.baked);
  if (!input) {
    return input.error();
  }
  return verifyWalk(options, *settings, *input);
}

}  // namespace

void addVerify(CLI::App& app, Command& chosen) {
  CLI::App* command = app.add_subcommand(
      "verify", "compares culling with exact visibility by ray casting; exit code 1 on a false cull");
  const auto options = std::make_shared<VerifyOptions>();
  addCommonOptions(*command, options->common);
  addPathOptions(*command, options->path);
  addMethodOptions(*command, options->method, true);
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
  command->footer(
      "A false cull counts when 113-bit arithmetic confirms its ray; 'unconfirmed' ones are rounding of the "
      "rays.\n"
      "overestimate is kept / exact objects over all frames; exact: reached by any ray.\n"
      "Examples:\n"
      "  sightline verify city.glb --path walk.json\n"
      "  sightline verify demo:building --variant FSE,FSC,FME,FMC --hierarchy kd,bvh --coherence on,off\n"
      "  sightline verify demo:city --method supporting-planes --joint on,off --occluders "
      "area-angle,database\n"
      "  sightline verify demo:boxes --method depth-pyramid --resolution 64x36,320x180 --focus 0,8 --frames "
      "0:400:50\n"
      "  sightline verify demo:ship --baked ship.sight --path cells --method visibility-octree,depth-pyramid "
      "--visible-sets on,off\n"
      "  sightline verify demo:city --frames 0:400:20 --width 3840 --height 2160 --aimed-rays 64 --json "
      "verify.json");
  command->callback([options, &chosen] { chosen = [options] { return runVerify(*options); }; });
}

}  // namespace sightline::tool
