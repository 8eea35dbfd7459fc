#pragma once

// The options of `bake` and the library's settings that they stand for.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sightline/base/result.h"
#include "sightline/comparison/viewpoint_database.h"
#include "sightline/pvs/bake/bake.h"
#include "tools/sightline/bake/viewer_options.h"
#include "tools/sightline/command_line/json_output.h"
#include "tools/sightline/command_line/options.h"
#include "tools/sightline/input/crack_note.h"

namespace sightline::tool {

struct BakeOptions {
  CommonOptions common;
  std::string output, witnesses;
  std::string update;        // the baked file of the scene before a change; empty: none
  bool answers = false;      // whether the answers are kept for a later update
  BakeSettings settings{};   // complete except for what depends on the scene or the threads:
  double crack_width = 0.0;  // metres
  std::string occlusion = "convex";
  std::string doors;  // see doorsOf; empty: none
  ViewerOptions viewers;
  std::optional<std::uint32_t> sample_mib{};  // none: chosen by the scene
  std::string databases;                      // names, separated by commas
  std::string viewpoint_path;                 // a camera path; empty: none
  ViewpointDatabaseSettings viewpoints{};
  bool resume = false, restart = false;
  bool force = false;  // overwrites a file even if it is not a baked one

  std::string partsFile() const { return output + ".parts"; }
  // The file of answers that is written, and the one that is read; empty: none.
  std::string answersFile() const { return answers || !update.empty() ? output + ".answers" : ""; }
  std::string answersBefore() const { return update.empty() ? "" : update + ".answers"; }
};
void addBakeOptions(CLI::App& command, BakeOptions& options);

// The databases that the options ask for: names of kBakedDatabases, in their order, each once.
Result<std::vector<std::string>> databaseNames(const BakeOptions& options);

// Errors that do not depend on the scene.
Status checkOptions(const BakeOptions& options);

// The settings for a scene, without its doors. Precondition: checkOptions() succeeded.
BakeSettings bakeSettings(const BakeOptions& options, const Scene& scene, const ViewerSpace& viewers);

// The text of BakeRecord::settings: everything that the parts depend on, the scene's origin (so that queries
// can use world space), and facts about the occluders. It holds neither the threads nor the limit of their
// memory.
Json settingsJson(const Bake& bake, const ViewerSpace& viewers, const Vec3d& origin, const CrackNote& cracks);

}  // namespace sightline::tool
