// sightline check: whether what a baked file calls hidden is hidden, by what the bake recorded and by rays.

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <string_view>

#include "sightline/io/file.h"
#include "src/io/point_json.h"
#include "tools/sightline/command_line/json_output.h"
#include "tools/sightline/command_line/options.h"
#include "tools/sightline/command_line/output_files.h"
#include "tools/sightline/commands.h"
#include "tools/sightline/cull/claim_checker.h"
#include "tools/sightline/input/doors.h"
#include "tools/sightline/input/load.h"

namespace sightline::tool {
namespace {

constexpr std::size_t kMaxListed = 20;  // on the terminal; JSON has all
constexpr std::array<std::string_view, kCheckRows> kRowNames{"convex",  "surfaces",    "boxes",   "narrowed",
                                                             "divided", "cells below", "no eyes", "without"};

struct CheckOptions {
  CommonOptions common;
  std::string file, witnesses, closed;
  double crack_width = 0.0;
  std::uint32_t divisions = 2, rays = 16, seed = 1;
};

Result<Witnesses> loadWitnesses(const std::string& file, const SightFile& baked) {
  if (file.empty()) {
    return Witnesses{};
  }
  const Result<std::string> text = readFile(file);
  if (!text) {
    return text.error();
  }
  Result<Witnesses> witnesses = readWitnesses(std::as_bytes(std::span(*text)), file);
  const OctreeView octree = baked.octree();
  if (witnesses && (witnesses->scene != baked.scene() || witnesses->root_min != octree.min ||
                    witnesses->root_max != octree.max)) {
    return Error{file + ": is of another bake; give the witnesses that were written with the baked file"};
  }
  return witnesses;
}

Json rowJson(const CheckRow& row) {
  return {{"claims", row.claims},
          {"proved", row.proved},
          {"survived", row.survived},
          {"contradicted", row.contradicted}};
}

std::string toJson(const CheckReport& report, const Scene& scene, const CrackClosing& closing,
                   const CheckOptions& options) {
  Json kinds = Json::object();
  for (std::size_t i = 0; i < kCheckRows; ++i) {
    kinds[std::string(kRowNames[i])] = rowJson(report.rows[i]);
  }
  Json contradicted = Json::array();
  for (const ContradictedClaim& one : report.contradicted) {
    const Vec3d eye = one.eye + scene.origin, point = one.point + scene.origin;
    contradicted.push_back({{"cell", one.leaf},
                            {"object", one.object.value},
                            {"eye", io::pointJson(eye)},
                            {"point", io::pointJson(point)}});
  }
  Json json = rowJson(report.sum());
  json["scene"] = sceneJson(scene, closing);
  json["seed"] = options.seed;
  json["rays"] = options.rays;
  json["divisions"] = options.divisions;
  json["inherited"] = report.inherited;
  json["kinds"] = kinds;
  json["contradictions"] = contradicted;
  return dump(json);
}

void print(const CheckReport& report, const Scene& scene) {
  for (std::size_t i = 0; i < std::min(report.contradicted.size(), kMaxListed); ++i) {
    const ContradictedClaim& one = report.contradicted[i];
    const Vec3d eye = one.eye + scene.origin, point = one.point + scene.origin;
    const std::uint32_t object = one.object.value;
    fmt::print(
        "contradicted: object {} '{}' is not in the set of cell {}, but from {:.9f} {:.9f} {:.9f} "
        "it is seen at {:.9f} {:.9f} {:.9f}\n",
        object, scene.object_names[object], one.leaf, eye.x, eye.y, eye.z, point.x, point.y, point.z);
  }
  if (report.contradicted.size() > kMaxListed) {
    fmt::print("... and {} more; --json lists all\n", report.contradicted.size() - kMaxListed);
  }
  fmt::print("{:<12} {:>10} {:>10} {:>14} {:>12}\n", "witness", "claims", "proved", "only survived",
             "contradicted");
  for (std::size_t i = 0; i < kCheckRows; ++i) {
    const CheckRow& row = report.rows[i];
    if (row.claims > 0) {
      fmt::print("{:<12} {:>10} {:>10} {:>14} {:>12}\n", kRowNames[i], row.claims, row.proved, row.survived,
                 row.contradicted);
    }
  }
  const CheckRow sum = report.sum();
  fmt::print(
      "{} claims that an object is hidden from a cell: {} proved, {} only survived rays, {} contradicted\n",
      sum.claims, sum.proved, sum.survived, sum.contradicted);
  if (report.inherited > 0) {
    fmt::print("{} of them rest on the claim of a cell around theirs\n", report.inherited);
  }
}

Result<ExitCode> runCheck(const CheckOptions& options) {
  if (const Status ok = checkFiles({.scenes = {options.common.scene},
                                    .inputs = {{"FILE", options.file}, {"--witnesses", options.witnesses}},
                                    .outputs = {{"--json", options.common.json}}});
      !ok) {
    return ok.error();
  }
  Result<Scene> scene = loadScene(options.common.scene);
  if (!scene) {
    return scene.error();
  }
  const CrackClosing closing = closeCracksOf(*scene, options.crack_width);
  const Result<std::optional<SightFile>> baked = loadBaked(options.file, *scene);
  if (!baked) {
    return baked.error();
  }
  const Result<std::vector<ObjectId>> closed = closeDoors(options.closed, options.file, *baked, *scene);
  if (!closed) {
    return closed.error();
  }
  const Result<Witnesses> witnesses = loadWitnesses(options.witnesses, **baked);
  if (!witnesses) {
    return witnesses.error();
  }
  const Result<CheckReport> report = checkClaims(**baked, *scene, witnesses->all, options.witnesses,
                                                 {.divisions = options.divisions,
                                                  .rays = options.rays,
                                                  .seed = options.seed,
                                                  .threads = options.common.threads,
                                                  .closed = *closed});
  if (!report) {
    return report.error();
  }
  if (const Status ok = writeOutput(
          options.common.json, options.common.json.empty() ? "" : toJson(*report, *scene, closing, options));
      !ok) {
    return ok.error();
  }
  if (options.common.textOnStdout()) {
    print(*report, *scene);
  }
  return report->contradicted.empty() ? kOk : kCheckFailed;
}

}  // namespace

void addCheck(CLI::App& app, Command& chosen) {
  CLI::App* command =
      app.add_subcommand("check", "whether what a baked file calls hidden from its cells is hidden");
  const auto options = std::make_shared<CheckOptions>();
  command->add_option("FILE", options->file, "what `sightline bake` wrote, F.sight")
      ->required()
      ->type_name(kFileType)
      ->check(isNotEmpty());
  addCommonOptions(*command, options->common);
  command
      ->add_option("--witnesses", options->witnesses,
                   "what `sightline bake --witnesses` wrote with it (default: proofs are found without)")
      ->type_name(kFileType);
  addClosedOption(*command, options->closed);
  addCrackWidthOption(*command, options->crack_width);
  command
      ->add_option("--divisions", options->divisions,
                   "how often a cell or an object is halved that is not proved to be hidden as a whole; each "
                   "half has to be")
      ->check(CLI::Range(0u, 16u))
      ->capture_default_str();
  command
      ->add_option("--rays", options->rays,
                   "random lines of sight that try to contradict each claim that is not proved, at most")
      ->check(CLI::Range(0u, 1000000u))
      ->capture_default_str();
  command->add_option("--seed", options->seed, "seed of the lines")
      ->check(CLI::Range(0u, 4294967295u))
      ->capture_default_str();
  command->footer(
      "Every pair of a cell and an object that is not in its set is a claim. It is proved by the scene's "
      "triangles alone: one closed convex body or one surface hides the object's box, or such hide parts of "
      "it from parts of the cell. Proofs share no code with the bake. What is not proved is tried by lines "
      "of sight, which prove nothing. Of doors, what is "
      "checked holds while exactly those of --closed are closed; what they hide has no witnesses. Exit code "
      "1: a claim is contradicted; 2: a witness is false, or a file is damaged or of another scene.\n"
      "Examples:\n"
      "  sightline bake city.glb -o city.sight --witnesses city.witnesses\n"
      "  sightline check city.sight city.glb --witnesses city.witnesses --threads 8");
  command->callback([options, &chosen] { chosen = [options] { return runCheck(*options); }; });
}

}  // namespace sightline::tool
