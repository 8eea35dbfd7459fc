#include "tools/sightline/bake/bake_options.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <limits>

#include "src/io/point_json.h"
#include "tools/sightline/bake/bake_databases.h"
#include "tools/sightline/command_line/parse_text.h"

namespace sightline::tool {
namespace {

constexpr double kMax = 1e6;       // largest distance in metres, largest factor
constexpr double kMinNear = 1e-6;  // metres
constexpr std::uint32_t kMaxMib = 1u << 20;
constexpr std::uint64_t kMinBudget = 100, kBudgetShare = 50;

// How far the bake divides cells, and how large the file may be.
void addSizeOptions(CLI::App& command, BakeOptions& options) {
  BakeSettings& settings = options.settings;
  command
      .add_option(
          "--triangle-budget", settings.triangle_budget,
          fmt::format("a cell from which so few triangles may be seen is not divided (default: a {}th "
                      "of the scene's, at least {})",
                      kBudgetShare, kMinBudget))
      ->check(CLI::Range(std::uint64_t{1}, std::numeric_limits<std::uint64_t>::max() / 2));
  command
      .add_option("--byte-budget", settings.byte_budget,
                  "the file has at most so many bytes, without its settings and occluder databases: of the "
                  "cells that were baked, those are joined that gain viewers least (default: any number)")
      ->check(CLI::Range(std::uint64_t{1}, std::numeric_limits<std::uint64_t>::max() / 2));
  command
      .add_option(
          "--depth", settings.max_depth,
          "of the octree: a cell is halved so often at most (default: chosen by the scene; at least 6, or 3 "
          "and fewer cells where surfaces hide as well)")
      ->check(CLI::Range(0u, kMaxOctreeDepth));
}

// What hides objects.
void addOcclusionOptions(CLI::App& command, BakeOptions& options) {
  BakeSettings& settings = options.settings;
  command
      .add_option(
          "--occlusion", options.occlusion,
          "convex: each convex occluder hides by itself, as in the paper; fused: surfaces of any number of "
          "triangles hide together as well, for smaller sets in a much longer time")
      ->check(isOneOf({"fused", "convex"}, false))
      ->capture_default_str();
  command
      .add_option(
          "--divisions", settings.divisions,
          "what is undecided after the narrowings is halved up to so many times, across the widest of "
          "the cell, the object's box and, with --narrowings, the window between them; each half is "
          "tested")
      ->check(CLI::Range(0u, 16u))
      ->capture_default_str();
  command
      .add_option(
          "--narrowings", settings.narrowings,
          "where surfaces do not hide an object from a whole cell for sure, parts of the cell, of the "
          "object's box and of a window between them that no line of sight can pass are cut off, up to so "
          "many times")
      ->check(CLI::Range(0u, 8u))
      ->capture_default_str();
  command
      .add_option("--object-boxes", settings.object_boxes,
                  "with surfaces, an object is hidden if each of so many boxes around its triangles is")
      ->check(CLI::Range(1u, kMaxObjectBoxes))
      ->capture_default_str();
  command
      .add_option(
          "--doors", options.doors,
          "objects that hide only while they are closed, by number or by name, where * stands for any text "
          "(several: a,b,c); of a+b, such as two that lead into one room, is stored what they hide together")
      ->check(isNotEmpty());
}

// Which occluders are looked for, and where cells are divided and joined.
void addSearchOptions(CLI::App& command, BakeOptions& options) {
  BakeSettings& settings = options.settings;
  addDecimalOption(
      command, "--search-distance", settings.search_distance, 0.0, kMax,
      fmt::format("occluders are looked for within so many metres at first; 0: an eighth of the scene's "
                  "diagonal, or all of it with more than {} objects",
                  BakeSettings::kManyObjects));
  addDecimalOption(
      command, "--occluder-size", settings.occluder_size, 0.0, kMax,
      "an occluder is of use to a cell when its area is so many times that of the cell's smallest face, or "
      "its volume so many times the cell's");
  addDecimalOption(command, "--similarity", settings.similarity, 0.0, 1.0,
                   "a cell is divided where some point of it sees less than the cell by this part");
  addDecimalOption(command, "--min-gain", settings.min_gain, 0.0, 1.0,
                   "occluders are looked for twice as far as long as that hides this part of the triangles");
  addDecimalOption(command, "--merge-tolerance", settings.merge_tolerance, 0.0, kMax,
                   "eight cells become one that sees at most this part more than each");
  command
      .add_option(
          "--sample-memory", options.sample_mib,
          fmt::format(
              "MiB for what each occluder hides from each corner of a cell, kept for its neighbours as in "
              "the paper, of each process; 0: none, which takes less memory, and less time where objects "
              "are many (default: 1024; 0 with more than {} objects)",
              BakeSettings::kManyObjects))
      ->check(CLI::Range(0u, kMaxMib));
}

// Which occluder databases are stored as well.
void addDatabaseOptions(CLI::App& command, BakeOptions& options) {
  command
      .add_option("--databases", options.databases, "occluder databases to store as well (several: a,b,c)")
      ->check(isOneOf({kBakedDatabases.begin(), kBakedDatabases.end()}, true));
  command
      .add_option(
          "--viewpoint-path", options.viewpoint_path,
          "minimum-sets, first-hit, projected-size: grid points lie near this camera path, a JSON file "
          "or the name of a walk of the scene (default: all over the scene)")
      ->type_name(kFileType);
  ViewpointDatabaseSettings& viewpoints = options.viewpoints;
  addDecimalOption(command, "--viewpoint-spacing", viewpoints.spacing, 0.0, kMax,
                   "the same: metres between grid points; 0: chosen");
  addDecimalOption(command, "--set-gain", viewpoints.weights.gain, 0.0, kMax,
                   "minimum-sets: weight of what a set hides");
  addDecimalOption(command, "--set-count", viewpoints.weights.count, 0.0, kMax,
                   "minimum-sets: weight of the number of occluders");
  addDecimalOption(command, "--set-area", viewpoints.weights.area, 0.0, kMax,
                   "minimum-sets: weight of the pixels of occluders");
  command.add_flag("--set-rest", viewpoints.first_hit_after_sets,
                   "minimum-sets: where they end, lists go on by first hit");
}

// What a bake takes over from an earlier one, and what of one it writes over.
void addUpdateOptions(CLI::App& command, BakeOptions& options) {
  command.add_flag("--answers", options.answers,
                   "also write F.sight.answers, from which --update goes on after a change of the scene");
  command
      .add_option(
          "--update", options.update,
          "the baked file of the scene before a change, written with --answers or --update: what does "
          "not depend on the change is taken over from it; implies --answers")
      ->type_name(kFileType);
  CLI::Option* resume = command.add_flag(
      "--resume", options.resume,
      "go on with an unfinished bake of the same scene and settings; says what of it is damaged");
  command.add_flag("--restart", options.restart, "throw away what an unfinished bake left")->excludes(resume);
  command.add_flag("--force", options.force, "write over F.sight also where it is not a baked file");
}

}  // namespace

// The order is that of --help.
void addBakeOptions(CLI::App& command, BakeOptions& options) {
  addCommonOptions(command, options.common);
  command.add_option("-o,--output", options.output, "the baked file to write, F.sight")
      ->required()
      ->type_name(kFileType);
  addSizeOptions(command, options);
  command
      .add_option("--witnesses", options.witnesses,
                  "also write what hides each object that is not in a set, for `sightline check`")
      ->type_name(kFileType);
  addDecimalOption(
      command, "--near-distance", options.settings.near_distance, kMinNear, kMax,
      "the farthest from the eye that the viewers' near plane clips away, metres: near * sqrt(1 + "
      "tan(fovy / 2)^2 * (1 + aspect^2))");
  addCrackWidthOption(command, options.crack_width);
  addOcclusionOptions(command, options);
  addViewerOptions(command, options.viewers);
  addSearchOptions(command, options);
  addDatabaseOptions(command, options);
  addUpdateOptions(command, options);
}

Result<std::vector<std::string>> databaseNames(const BakeOptions& options) {
  std::vector<std::string> given;
  if (!options.databases.empty()) {
    given = splitAt(options.databases, ',');
  }
  std::vector<std::string> names;
  for (const std::string_view name : kBakedDatabases) {
    const auto end = std::remove(given.begin(), given.end(), name);
    if (end != given.end()) {
      names.emplace_back(name);
      given.erase(end, given.end());
    }
  }
  if (!given.empty()) {
    return Error{
        fmt::format("--databases: there is no '{}'; choose from: {}", given.front(), listBakedDatabases())};
  }
  return names;
}

Status checkOptions(const BakeOptions& options) {
  if (const auto names = databaseNames(options); !names) {
    return names.error();
  }
  if (!options.update.empty() && !options.witnesses.empty()) {
    return Error{"--update: what is taken over has no witnesses; leave out --update or --witnesses"};
  }
  return checkViewerOptions(options.viewers);
}

BakeSettings bakeSettings(const BakeOptions& options, const Scene& scene, const ViewerSpace& viewers) {
  BakeSettings settings = options.settings;
  settings.occlusion = options.occlusion == "fused" ? BakeOcclusion::kFused : BakeOcclusion::kConvex;
  if (settings.triangle_budget == 0) {
    settings.triangle_budget = std::max(scene.triangleCount() / kBudgetShare, kMinBudget);
  }
  settings.viewers = viewers.boxes;
  settings.witnesses = !options.witnesses.empty();
  settings.answers = !options.answersFile().empty();
  if (options.sample_mib || scene.objects.size() <= BakeSettings::kManyObjects) {
    settings.sample_bytes = (std::size_t{options.sample_mib.value_or(1024)} << 20) / options.common.threads;
  }
  return settings;
}

Json settingsJson(const Bake& bake, const ViewerSpace& viewers, const Vec3d& origin,
                  const CrackNote& cracks) {
  const BakeSettings& settings = bake.settings();
  const OccluderCounts& occluders = bake.occluders();
  Json json = {{"triangle_budget", settings.triangle_budget},
               {"depth", settings.max_depth},
               {"base_depth", bake.baseDepth()},
               {"near_distance", settings.near_distance},
               {"region", viewers.regionJson(origin)},
               {"viewers", viewers.facts},
               {"occlusion", settings.occlusion == BakeOcclusion::kFused ? "fused" : "convex"},
               {"divisions", settings.divisions},
               {"narrowings", settings.narrowings},
               {"object_boxes", settings.object_boxes},
               {"search_distance", settings.search_distance},
               {"occluder_size", settings.occluder_size},
               {"similarity", settings.similarity},
               {"min_gain", settings.min_gain},
               {"merge_tolerance", settings.merge_tolerance},
               {"occluders",
                {{"all", occluders.all},
                 {"inner", occluders.inner},
                 {"of_use", occluders.of_use},
                 {"largest_area", occluders.largest_area}}},
               {"origin", io::pointJson(origin)}};
  if (settings.byte_budget > 0) {
    json["byte_budget"] = settings.byte_budget;
  }
  if (!settings.doors.empty()) {
    Json doors = Json::array();
    for (const std::vector<ObjectId>& group : settings.doors) {
      Json numbers = Json::array();
      for (const ObjectId door : group) {
        numbers.push_back(door.value);
      }
      doors.push_back(numbers);
    }
    json["doors"] = doors;
  }
  addCracks(json, cracks);
  return json;
}

}  // namespace sightline::tool
